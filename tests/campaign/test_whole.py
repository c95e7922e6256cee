"""A campaign in one call: its files, what it returns, and what it does not do twice."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from deployable import campaign
from deployable.campaign.errors import ConfigError
from deployable.campaign.folder import Folder
from deployable.campaign.stages.workflow import Workflow

ROOT = Path(__file__).parents[2]


def run(raw, results, **options) -> Folder:
    """The folder of a campaign that was run."""
    options = {"figures": False, "notify": lambda text: None, **options}
    campaign.run(raw, results, **options)
    return Folder(results / raw["campaign"])


def simulated(folder: Folder) -> int:
    """Number of runs that the last call had to simulate."""
    return sum(json.loads(path.read_text())["simulated"] for path in folder.path.glob("batches/*"))


@pytest.mark.slow
def test_a_campaign_returns_its_bounds_and_leaves_all_files(raw, tmp_path):
    said = []
    raw["intervals"]["E"] = {"relative": 0.05}
    raw["design"]["order"] = 1
    bounds = campaign.run(raw, tmp_path, notify=said.append)
    assert bounds.sizes["response"] == 2
    assert (bounds["lower"] <= bounds["upper"]).all()
    folder = Folder(tmp_path / "test")
    assert bounds.attrs.pop("display")  # units of its figures, which no file has
    with xr.open_dataset(folder.bounds) as written:
        assert written.load().identical(bounds)
    promised = Workflow(campaign.check_config(raw)).results()
    assert len(promised) == 13
    for name in promised:
        assert (tmp_path / Path(name).relative_to("results")).stat().st_size > 500
    assert "test: 7 of 7 runs done" in said
    assert "(`BD`) differs by up to" in said[-2] and "## " not in said[-2]
    assert said[-1] == f"Open {folder.report}" and sum("Open " in text for text in said) == 1


def test_the_returned_bounds_do_not_hold_their_file(finished, raw):
    first = campaign.run(raw, finished.path.parent, figures=False, notify=lambda text: None)
    again = campaign.run(raw, finished.path.parent, figures=False, notify=lambda text: None)
    xr.testing.assert_identical(first, again)
    assert simulated(finished) == 0


@pytest.mark.slow
def test_runs_that_exist_are_used_by_another_design(raw, tmp_path):
    raw["intervals"]["E"] = {"relative": 0.05}
    raw |= {"design": {"method": "tensor_lobatto", "order": 1}, "held_out": 0}
    assert simulated(run(raw, tmp_path)) == 5
    raw["design"]["order"] = 2
    # A 3 x 3 grid with its middle as the nominal run: the 4 corners and the middle are there.
    assert simulated(run(raw, tmp_path)) == 4


def scan(raw, samples, **more):
    """A plain scan that keeps responses only."""
    jobs = {"keep": "responses", "group": 8}
    design = {"method": "sobol", "samples": samples}
    return {**raw, "campaign": "scan", "design": design, "jobs": jobs, **more}


def test_a_scan_keeps_responses_only(raw, tmp_path):
    raw = scan(raw, 20)
    folder = run(raw, tmp_path)
    assert not folder.runs("trajectories").exists()
    assert (
        "results/scan/figures/campaign/moments.png"
        in Workflow(campaign.check_config(raw)).results()
    )
    with xr.open_dataset(folder.samples) as samples, xr.open_dataset(folder.bounds) as bounds:
        assert samples.sizes["run"] == 21
        values = samples["values"].values
        np.testing.assert_array_equal(bounds["lower"].values, values.min(axis=0))
        np.testing.assert_array_equal(bounds["upper"].values, values.max(axis=0))
    with xr.open_dataset(folder.surrogate) as surrogate:
        assert surrogate.sizes["term"] == 0, "no polynomial goes through a scan"
    with xr.open_dataset(folder.sensitivities) as sensitivities:
        assert not sensitivities.data_vars


def test_a_spline_goes_through_the_runs_of_a_scan(raw, tmp_path):
    folder = run(scan(raw, 4, bounds={"model": "spline"}), tmp_path)
    told = "The bounds of curves come from a fit to the runs."
    assert told in (folder / "summary.md").read_text()
    with xr.open_dataset(folder.samples) as samples, xr.open_dataset(folder.bounds) as bounds:
        assert bounds.attrs["design_runs"] == samples.sizes["run"] == 5
        values = samples["values"].sel(response="vBz").values
        slack = 1e-6 * np.abs(values).max()  # the samples have single precision
        assert (bounds["lower"].sel(response="vBz").values <= values.min(axis=0) + slack).all()
        assert (bounds["upper"].sel(response="vBz").values >= values.max(axis=0) - slack).all()


def test_what_cannot_be_run_is_refused_before_anything_is_written(raw, tmp_path):
    raw["intervals"] = {"q": {"relative": 0.1}}
    with pytest.raises(ConfigError, match="no such parameter"):
        campaign.run(raw, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_importing_is_cheap():
    # scipy itself is light, and loads its modules where they are used.
    heavy = {"numba", "xarray", "matplotlib", "netCDF4"}
    heavy |= {f"scipy.{name}" for name in ("linalg", "optimize", "sparse", "spatial", "stats")}
    code = (
        "import sys, deployable.campaign.cli, deployable.campaign.stages.workflow; "
        f"sys.exit(repr({heavy} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.stderr.strip() == "set()"
