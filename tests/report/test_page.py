"""The page: complete, honest, and independent of any network."""

import base64
import gzip
import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
import xarray
from stored_runs import load_run

from deployable.campaign.pictures.glb import glb_of
from deployable.campaign.report import from_results, write_page
from deployable.campaign.report.motions import MOST_MOVING, count_moving_runs, shown_runs
from deployable.campaign.report.pack import thin_curves
from deployable.campaign.report.page import render
from deployable.campaign.results.facts import grade
from deployable.campaign.results.templates import sentence
from deployable.campaign.text.numbers import number, spread, with_error


def text_of(data):
    """What a page says, of these data."""
    text = render(data).split("</style>")[1].replace("\N{NO-BREAK SPACE}", " ")
    return re.sub(r"<[^>]*>", "", text.split('<script type="application/gzip"')[0])


def altered(data, **changes):
    """The same data with other facts of the first response, and of all where names are known."""
    own = {key: changes.pop(key) for key in list(changes) if key not in data.facts}
    first, *others = data.facts["responses"]
    return replace(data, facts={**data.facts, "responses": [{**first, **own}, *others], **changes})


def embedded(path):
    """The data in a page."""
    text = path.read_text(encoding="utf-8")
    found = re.search(r'<script type="application/gzip" id="data">(.*?)</script>', text, re.S)
    raw = gzip.decompress(base64.b64decode(found.group(1)))
    size = 4 + int.from_bytes(raw[:4], "little")

    def unpacked(value):
        if isinstance(value, list):
            return [unpacked(each) for each in value]
        if isinstance(value, dict) and "at" in value:
            place = size + value["at"]
            return np.frombuffer(raw, f"<{value['kind']}", value["count"], place)
        if isinstance(value, dict):
            return {key: unpacked(each) for key, each in value.items()}
        return value

    return unpacked(json.loads(raw[4:size]))


def test_the_page_asks_nothing_of_a_network(page):
    text = page.read_text(encoding="utf-8")
    text = text.replace("http://www.w3.org/2000/svg", "")  # a name, not an address
    assert not re.search(r"https?:|//[\w-]+\.\w+/|@import|url\((?!#|\")", text)
    assert not re.search('src="(?!data:)', text) and '<link rel="stylesheet' not in text


def test_the_page_tells_the_answer_first(page, data):
    text = page.read_text(encoding="utf-8")
    body = text[text.index("<body>") :].replace("\N{NO-BREAK SPACE}", " ")
    answer = re.sub("`([^`]+)`", r"<code>\1</code>", sentence("headline", data.facts))
    places = [body.index(part) for part in (answer, 'id="motion"', 'id="parameters"')]
    assert places == sorted(places)
    assert "swing" in text and "data version" not in text
    assert str(data.provenance["Config digest"]) in body


def test_bounds_in_the_page_are_exact(page, data):
    found = embedded(page)
    with xarray.open_dataset(page.parent / "bounds.nc") as bounds:
        for i, response in enumerate(found["responses"]):
            for key in ("lower", "upper", "nominal", "error"):
                assert np.array_equal(response[key], bounds[key].values[i])
        assert np.array_equal(found["time"], bounds["time"].values)


def test_the_page_moves_the_files_that_export_writes(page, data):
    motion = embedded(page)["motion"]
    for moving, file in zip(data.moving.values(), motion["runs"], strict=True):
        assert file.tobytes() == glb_of(moving, small=True)
    worst = max(float(moving["stress"].max()) for moving in data.moving.values())
    assert motion["largestStress"] == worst > 0


def test_the_extreme_runs_move_beside_the_nominal_one(results, data):
    with (
        xarray.open_dataset(results / "samples.nc") as samples,
        xarray.open_dataset(results / "bounds.nc") as bounds,
    ):
        values = samples["values"].values
        widest = int((bounds["upper"] - bounds["lower"]).values[0].argmax())
    shown = shown_runs(results)
    assert [*data.moving] == [run.row for run in shown]
    assert shown[0].label == "nominal run"
    ids = {data.runs[i].id for i in data.moving}
    for extreme in (values[:, 0, widest].argmin(), values[:, 0, widest].argmax()):
        assert data.runs[extreme].id in ids


def test_motions_are_those_of_the_trajectory_files(results, data):
    for run, motion in data.moving.items():
        trajectory = load_run(results / "trajectories", data.runs[run].id)
        there = trajectory["position"].sel(time=motion["time"].values)
        shown = motion["point_position"].sel(point=there["point"])
        assert there.sizes["point"] and np.array_equal(there.values, shown.values)
        assert trajectory["time_step"] == motion.attrs["time_step"]


def test_as_many_runs_move_as_a_page_has_room_for():
    few, more, most = map(count_moving_runs, (30, 60, 10_000))
    assert few == MOST_MOVING > more > most == 7


def test_the_page_names_the_runs_that_do_not_move(results, tmp_path):
    shutil.copytree(results, tmp_path / "swing")
    *_, last = shown_runs(results)
    (tmp_path / "swing" / "motions" / f"{last.id}.nc").unlink()
    fewer = from_results(tmp_path / "swing")
    assert [(one.id, one.label) for one in fewer.omitted_runs] == [(last.id, last.label)]
    write_page(fewer, tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert f"{last.label} ({last.id})" in text.replace("\N{NO-BREAK SPACE}", " ")


def test_thinned_curves_keep_their_extremes():
    rng = np.random.default_rng(1)
    curves = [rng.normal(size=50_000) for _ in range(4)]
    keep = thin_curves(curves, most=2000)
    assert len(keep) <= 2000 + 2 * len(curves) + 2 and keep[0] == 0 and keep[-1] == 49_999
    for curve in curves:
        assert curve[keep].max() == curve.max() and curve[keep].min() == curve.min()


@pytest.mark.parametrize(
    ("share", "name"), [(0.01, "small"), (0.09, "small"), (0.11, "large"), (None, "unknown")]
)
def test_the_estimated_error_has_a_grade(data, share, name):
    assert grade(None if share is None else 2 * share, 2.0) == name
    error = None if share is None else share
    times = {"from": 0.1, "to": 0.2, "throughout": True}
    changes = {"grade": name, "largest_error": error, "times_of_large_error": times}
    text = text_of(altered(data, **changes))
    pattern = r"(Do not rely on the bounds of|no error estimate for) the x-position of the point T"
    warned = re.search(pattern, text) is not None
    assert warned == (name in ("large", "unknown"))


def test_the_headline_says_how_far_the_responses_go(data):
    first, second = data.facts["responses"]
    width, error = first["largest_difference"], first["error_at_largest_difference"]
    text = sentence("headline", data.facts)
    assert text.startswith("The x-position of the point `T` (`x`) differs by up to ")
    assert text.count(" differs by up to ") == 2 and with_error(width, error, "m") in text
    three = altered(data, responses=[first, second, first]).facts
    assert sentence("headline", three).endswith(" The table lists 1 more response.")
    given = sentence("given", data.facts)
    assert given.startswith("The campaign simulates 0.4 s of `pendulum`")
    assert "The uncertain parameters are `L` (length of the bar, ± 5 %) and " in given
    wide = {**data.parameters[0], "description": "", "upper": 2.0}
    text = sentence("given", data.facts | {"parameters": [wide]})
    assert "The uncertain parameter is `L` (0.95 to 2 m). " in text


def parameter(units, *ends):
    return {"units": units, **dict(zip(("lower", "nominal", "upper"), ends, strict=True))}


def test_numbers_as_people_write_them():
    assert number(0.0617852) == "0.0618"
    assert with_error(0.0617852, 0.0046, "m") == "0.062 ± 0.005 m"
    assert with_error(-46.2, 3.0, "m s-1") == "−46 ± 3 m/s"
    assert with_error(0.0617852, 1e-6, "m") == with_error(0.0617852, None, "m") == "0.0618 m"
    assert number(-2.5) == "−2.5"
    assert number(1.05e9) == "1.05 × 10⁹"
    assert number(1e9) == "10⁹"
    assert number(3e-7) == "3 × 10⁻⁷"
    assert spread(parameter("m", 0.03465, 0.035, 0.03535)) == "± 1 %"
    assert spread(parameter("m", 1.0, 1.0, 1.5)) == "1 to 1.5 m"
    assert spread(parameter("degree", 84.75, 85.0, 85.25)) == "± 0.25°"
    assert spread(parameter("rad", 0.0, 0.5, 1.0)) == "± 0.5 rad"
