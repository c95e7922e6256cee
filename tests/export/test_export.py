"""`python -m deployable export`: which run it is, and what is written where."""

import csv
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray
import yaml
from stored_runs import load_run
from swing import CONFIG

from deployable.campaign.cli import main
from deployable.campaign.errors import CampaignError
from deployable.campaign.export import FORMATS, choose, export
from deployable.campaign.program_data import list_structures


def read(path):
    """Headings and numbers (n, k) of a CSV file, text as NaN."""
    with open(path, newline="") as file:
        head, *rows = list(csv.reader(file))
    return head, np.array([[float(cell) for cell in row] for row in rows])


def length(scene):
    """Of the diagonal of the box around a scene's particles: that of a pendulum."""
    return np.linalg.norm(np.ptp(scene.position, axis=0))


# The bar of "mjcf" bends, and "mp4" needs ffmpeg.
@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind not in ("mjcf", "mp4")])
def test_every_kind_is_written_beside_the_results(results, capsys, kind):
    assert main(["export", str(results), "--to", kind, "--frames", "3"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told and told[0].startswith(str(results / "exports"))
    for line in told:
        assert (results / "exports" / line.rsplit("/", 1)[1]).stat().st_size > 100


def test_all_kinds_are_told():
    page = (Path(__file__).parents[2] / "docs/export.md").read_text(encoding="utf-8")
    assert re.search(r"--to (\S+)", page).group(1).split("|") == list(FORMATS)


def test_any_run_of_a_campaign_is_its_trajectory(results):
    with xarray.open_dataset(results / "samples.nc") as samples:
        run = str(samples["run_id"].values[2])
    motion = choose(str(results), run[:10]).motion(5)
    assert motion.attrs["run_id"] == run
    kept = load_run(results / "trajectories", run)["position"].sel(time=motion["time"].values)
    assert np.array_equal(kept.values, motion["point_position"].sel(point=kept["point"]).values)


def test_tables_are_the_files_numbers_to_the_last_digit(results, tmp_path):
    export(choose(str(results)), "csv", tmp_path)
    head, numbers = read(tmp_path / "bounds.csv")
    assert head == ["time (s)", *(f"x_{k} (m)" for k in ("lower", "upper", "nominal", "error"))]
    with xarray.open_dataset(results / "bounds.nc") as bounds:
        expected = [bounds["time"], *(bounds[k].values[0] for k in ("lower", "upper", "nominal"))]
        assert np.array_equal(numbers[:, :4].T, np.stack(expected))
        head, numbers = read(tmp_path / "nominal.csv")
        assert head[:2] == ["time (s)", "x (m)"]
        assert "x of T (m)" in head and "velocity z of T (m s-1)" in head
        assert "kinetic energy (J)" in head
        assert np.array_equal(numbers[:, 1], bounds["nominal"].values[0])
        assert np.array_equal(numbers[:, head.index("x of T (m)")], numbers[:, 1])
    rows = (tmp_path / "runs.csv").read_text().splitlines()
    assert rows[0] == "run,role,L (m),last (m),passes (s)" and len(rows) == 1 + 4
    assert rows[1].split(",")[1:3] == ["nominal", "1.0"]


def test_quantities_are_a_table_with_empty_cells_where_there_is_no_number(results, tmp_path):
    export(choose(str(results)), "csv", tmp_path)
    with open(tmp_path / "quantities.csv", newline="") as file:
        last, passes = csv.DictReader(file)
    with xarray.open_dataset(results / "quantities.nc") as told:
        for row in (last, passes):
            there = told.sel(quantity=row["quantity"])
            assert row["units"] == there["quantity_units"].item()
            for key in ("lower", "nominal", "upper", "error", "happens"):
                value = there[key].item()
                assert row[key] == ("" if np.isnan(value) else repr(value))
            assert row["L (m) at the upper end"] == repr(there["argmax"].values[0].item())
    with open(tmp_path / "runs.csv", newline="") as file:
        cells = [row["passes (s)"] for row in csv.DictReader(file)]
    with xarray.open_dataset(results / "samples.nc") as samples:
        numbers = samples["quantities"].sel(quantity="passes").values
    assert cells == ["" if np.isnan(number) else repr(number.item()) for number in numbers]
    assert "" in cells and any(cells)


def test_results_are_exported_from_any_folder_with_the_structure_beside_the_config(
    tmp_path, monkeypatch
):
    folder = tmp_path / "results/swing"
    for place in ("config", "elsewhere"):
        (tmp_path / place).mkdir()
    shutil.copy(list_structures()["pendulum"], tmp_path / "config/bar.yaml")
    raw = {**CONFIG, "scene": {"file": "bar.yaml", "parameters": CONFIG["scene"]["parameters"]}}
    (tmp_path / "config/swing.yaml").write_text(yaml.safe_dump(raw), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert main(["run", "config/swing.yaml", "--no-figures"]) == 0
    for place in (tmp_path, tmp_path / "elsewhere", folder):
        monkeypatch.chdir(place)
        assert main(["export", os.path.relpath(folder), "--to", "csv"]) == 0
        (folder / "exports/nominal.csv").unlink()


def test_a_configs_nominal_run_is_that_of_its_campaign(results, tmp_path):
    path = tmp_path / "swing.yaml"
    path.write_text(yaml.safe_dump(CONFIG), encoding="utf-8")
    of_config, from_results = choose(str(path)), choose(str(results))
    assert of_config.step == from_results.step
    one, other = (chosen.motion(5) for chosen in (of_config, from_results))
    assert np.array_equal(one["position"].values, other["position"].values)
    longer = choose(str(path), settings={"L": "1.02"}, duration=0.4)
    assert (longer.duration, longer.instants) == (0.4, 201)
    assert length(longer.scene) == pytest.approx(1.02)


def test_a_finer_mesh_of_a_config_has_a_step_that_is_stable(tmp_path):
    path = tmp_path / "swing.yaml"
    path.write_text(yaml.safe_dump(CONFIG))
    coarse, fine = (choose(str(path), settings={"elements": n}) for n in ("3", "6"))
    assert fine.step < 0.6 * coarse.step
    assert fine.outcome().failure is None


def test_a_structure_moves_without_a_campaign(tmp_path):
    chosen = choose("pendulum", settings={"elements": "3", "E": "1e8", "L": "0.8"}, duration=0.02)
    assert length(chosen.scene) == pytest.approx(0.8)
    (path,) = export(chosen, "glb", tmp_path, frames=3)
    assert path == tmp_path / "pendulum.glb"


def test_what_cannot_be_exported_is_refused_with_what_is_allowed(results, tmp_path, capsys):
    for arguments, words in (
        ([str(results), "--run", "zz"], "there is no run 'zz'; allowed: nominal, or an id of"),
        ([str(results), "--run", ""], "there is no run ''"),
        (
            [str(results), "--set", "L=2"],
            "has finished runs, whose parameters and duration cannot be set",
        ),
        ([str(tmp_path)], "no samples.nc"),
        (["pendulum", "--run", "abc"], "needs the folder of a campaign's results"),
        (["pendulum", "--set", "L=-1"], "L = -1 is not allowed"),
        (["pendulum", "--set", "M=1"], "pendulum has no parameter M; expected one of L"),
        (["pendulum", "--set", "L=["], "this is not YAML"),
        (["pendulum", "--frames", "0"], "--frames 0; allowed: 1 or more"),
        (["absent.yaml"], "absent.yaml"),
        (["sarrus"], "bennett, boom"),
    ):
        assert main(["export", *arguments, "--to", "csv"]) == 1, arguments
        told = capsys.readouterr().err
        assert words in told and "Traceback" not in told


def test_a_run_that_fails_says_so():
    from dataclasses import replace

    chosen = choose("pendulum", settings={"elements": "3", "E": "1e8"}, duration=0.2)
    with pytest.raises(CampaignError, match="the run fails: unstable"):
        replace(chosen, step=40 * chosen.step, instants=3).motion(3)
