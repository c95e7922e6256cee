"""From samples to bounds, summary and figures, on a campaign that was really run."""

from __future__ import annotations

import json
import shutil
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest
import xarray as xr
from numpy.polynomial import chebyshev

from deployable import campaign
from deployable.campaign.config import sections
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.report import make_motions
from deployable.campaign.results import figures
from deployable.campaign.results.templates import summary_text
from deployable.campaign.stages import figures as draw
from deployable.campaign.stages import page
from deployable.campaign.stages.answers import summarise
from deployable.campaign.text.numbers import pretty
from evidence.attack.victim import silent
from fpm.files.seals import unseal

ROOT = Path(__file__).parents[2]
SUMMARY_SCHEMA = ROOT / "deployable/campaign/results/summary.schema.json"
DRAWN = ("BD", "vBz", "moments", "responses")
NETCDF = ("samples", "surrogate", "bounds", "sensitivities")


def beside(finished: Folder, path: Path) -> Folder:
    """Another folder with the same campaign, so that its results can be made anew."""
    return Folder(shutil.copytree(finished.path, path, dirs_exist_ok=True))


def test_the_bounds_are_the_exact_range_of_the_surrogate_and_of_all_runs(finished):
    with (
        xr.open_dataset(finished.bounds) as bounds,
        xr.open_dataset(finished.samples) as samples,
        xr.open_dataset(finished.surrogate) as surrogate,
    ):
        unit = np.linspace(-1, 1, 4001)
        degrees = surrogate["multi_index"].values[:, 0]
        for name in ("BD", "vBz"):
            coefficients = np.zeros((3, surrogate.sizes["time"]))
            coefficients[degrees] = surrogate["coefficient"].sel(response=name).values
            dense = chebyshev.chebval(unit, coefficients)
            dense = np.concatenate([dense, samples["values"].sel(response=name).values.T], axis=1)
            lower, upper = (bounds[key].sel(response=name).values for key in ("lower", "upper"))
            scale = np.abs(dense).max()
            assert (lower <= dense.min(axis=1) + 1e-14 * scale).all()
            assert (upper >= dense.max(axis=1) - 1e-14 * scale).all()
            np.testing.assert_allclose(lower, dense.min(axis=1), atol=1e-7 * scale)
            np.testing.assert_allclose(upper, dense.max(axis=1), atol=1e-7 * scale)


def test_the_summary_has_the_largest_difference_and_its_time(finished, tmp_path):
    folder = beside(finished, tmp_path)
    text = summarise(folder, {"BD": 0.063})
    summary = json.loads((tmp_path / "summary.json").read_text())
    with xr.open_dataset(finished.bounds) as bounds:
        width = bounds["upper"].sel(response="BD") - bounds["lower"].sel(response="BD")
        row = summary["responses"][0]
        assert row["largest_difference"] == float(width.max())
        assert row["time_of_largest_difference"] == float(width["time"][int(width.values.argmax())])
        assert row["ratio_to_published"] == pytest.approx(float(width.max()) / 0.063)
    assert summary["responses"][1]["published"] is None
    assert summary["design"]["runs"] == 5
    assert text == unseal(tmp_path / "summary.md").decode() == summary_text(summary)
    assert "error estimate there" in text
    for words in (
        "0.063 m",
        "m/s",
        "`tensor_roots` of order 2",
        "They estimate how far the simulated curves can go; they do not prove it.",
    ):
        assert words in text


@pytest.mark.slow
def test_figures_are_drawn_in_two_forms_and_are_the_same_again(finished, tmp_path):
    found = []
    for place in ("first", "second"):
        folder = beside(finished, tmp_path / place)
        draw.work(folder, silent)
        page.work(folder, silent, frames=11)
        found.append({path.name: unseal(path) for path in folder.figures.rglob("*.*")})
    first, second = found
    kinds = {"png": b"\x89PNG", "pdf": b"%PDF"}
    assert set(first) == {f"{n}.{k}" for n in DRAWN for k in kinds}
    for name, content in first.items():
        assert content == second[name]
        assert content.startswith(kinds[name.split(".")[1]])
        assert len(content) > 5000
        assert b"/Type3" not in content


def test_any_structure_is_drawn_from_its_motion(finished, tmp_path, monkeypatch):
    folder = beside(finished, tmp_path / "test")
    save = partial(figures.save, kinds=("svg",))  # in which panels can be counted
    monkeypatch.setattr(page, "save", save)
    page.work(folder, silent, frames=11)
    drawn = ElementTree.fromstring((folder.overviews / "moments.svg").read_text())
    panels = [each for each in drawn.iter() if each.get("id", "").startswith("axes_")]
    assert len(panels) == 5


def test_runs_of_a_structure_that_has_changed_since_do_not_move(finished, tmp_path, monkeypatch):
    folder = beside(finished, tmp_path / "test")
    monkeypatch.setattr(sections, "program_digest", lambda: "another")
    with pytest.raises(CampaignError, match="have changed since"):
        make_motions(folder.path)
    assert not folder.motions.exists()


ODD = ("v", "v_inner", "v_inner_lower", "time", "values", "a", "parameter_a", "lower", "response",
       "run", "position", "nominal", "box_lower", "moments", "campaign")  # fmt: skip


@pytest.mark.slow
def test_responses_of_any_name_have_bounds_of_their_own(raw, tmp_path):
    kinds = [{"distance": ["B", "D"]}, {"velocity": "B", "component": "z"}, {"opening": "A"},
             {"energy": "kinetic"}, {"position": "C", "component": "x"}]  # fmt: skip
    found = {}
    for names in (ODD, [f"r{i}" for i in range(len(ODD))]):
        raw["responses"] = {name: kinds[i % 5] for i, name in enumerate(names)}
        folder = Folder(tmp_path / names[0] / "test")
        campaign.run(raw, tmp_path / names[0], figures=False, notify=lambda text: None)
        for file in NETCDF:
            with xr.open_dataset(getattr(folder, file)) as data:
                assert data["response"].values.tolist() == list(names)
                plain = data.load().drop_vars("response").drop_attrs()
            found.setdefault(file, []).append(plain)
        with xr.open_dataset(folder.bounds) as bounds, xr.open_dataset(folder.samples) as runs:
            nodes = runs["values"].where(runs["role"] == "node", drop=True)
            slack = 1e-12 * abs(nodes).max()
            assert (bounds["lower"] <= nodes.min("run") + slack).all()
            assert (bounds["upper"] >= nodes.max("run") - slack).all()
            assert (bounds["lower"] == bounds["lower"][2]).all("time").sum() == 3  # of one kind
    for odd, plain in found.values():
        xr.testing.assert_identical(odd, plain)


def test_the_summary_is_as_its_schema_says(finished):
    schema = json.loads(SUMMARY_SCHEMA.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    found = json.loads((finished / "summary.json").read_text(encoding="utf-8"))
    jsonschema.validate(found, schema)
    described = schema["properties"]
    assert set(found) <= set(described), "describe new keys in summary.schema.json"
    for row in found["responses"]:
        assert set(row) <= set(described["responses"]["items"]["properties"])
    del found["responses"][0]["units"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(found, schema)


@pytest.mark.parametrize(
    ("units", "text"),
    [
        ("m", "m"),
        ("m s-1", "m/s"),
        ("kg m2 s-2", "kg m²/s²"),
        ("s-1", "1/s"),
        ("1", "1"),
        ("m0.5", "m^0.5"),
    ],
)
def test_units_are_written_as_people_do(units, text):
    assert pretty(units) == text


def test_a_published_difference_of_zero_has_no_ratio(finished):
    facts = json.loads((finished / "summary.json").read_text(encoding="utf-8"))
    facts["responses"][0] |= {"published": 0.0, "ratio_to_published": None}
    assert "| 0 m |  |\n" in summary_text(facts)
