"""Large scans: their jobs, their room on the disk, and the runs that surrogates are fitted to."""

from __future__ import annotations

import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from deployable import campaign
from deployable.campaign.config.sections import Jobs
from deployable.campaign.errors import ConfigError
from deployable.campaign.plan.jobs import batch_count
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.results.quantity_results import MAX_FIT_RUNS, fitted_rows
from deployable.campaign.runs.batch import run_batch
from deployable.campaign.samples.samples import gather


@pytest.fixture
def scan(raw) -> dict:
    """A scan of two parameters."""
    raw["intervals"]["E"] = {"relative": 0.05}
    raw["design"] = {"method": "sobol", "samples": 6}
    return raw


@pytest.mark.parametrize("keep", ["trajectories", "responses"])
def test_a_new_expression_of_quantities_makes_no_run_again(scan, tmp_path, keep):
    jobs = Jobs(512, 4, keep)
    scan["quantities"] = {"most": {"largest": "vBz"}, "least": {"smallest": "vBz"}}
    for name, text, runs in (
        ("spread", "most - least", 7),
        ("ratio", "2*spread/most", 0),
    ):
        scan["quantities"][name] = text
        plan = make_plan(campaign.check_config(scan).experiment)
        manifest = tmp_path / "0.json"
        run_batch(plan, 0, 1, jobs, tmp_path / keep, manifest, lambda text: None)
        assert json.loads(manifest.read_text())["simulated"] == runs
    gather(plan, jobs, tmp_path / keep, tmp_path / "samples.nc")
    with xr.open_dataset(tmp_path / "samples.nc") as file:
        table = file.load()
    values = table["quantities"].to_series().unstack()
    np.testing.assert_array_equal(values["spread"], values["most"] - values["least"])
    np.testing.assert_array_equal(values["ratio"], 2 * values["spread"] / values["most"])
    assert table["quantity_units"].values.tolist() == ["m s-1", "m s-1", "m s-1", "1"]


def test_a_million_runs_are_refused_where_the_disk_has_no_room(scan, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=1e9))
    scan["design"]["samples"], scan["jobs"] = 10**7, {"keep": "responses"}
    with pytest.raises(ConfigError, match=r"take about 1\.44 GB, and the disk has 1 GB") as refused:
        campaign.check_config(scan)
    assert "allowed: at most 6944444" in str(refused.value)


def test_surrogates_of_large_scans_see_the_runs_that_decide():
    numbers = np.random.default_rng(0).random((MAX_FIT_RUNS + 5, 2))
    numbers[9000:9010, 1] = np.nan
    rows = fitted_rows(numbers)
    assert len(rows) < MAX_FIT_RUNS / 2
    for column in numbers.T:
        assert {np.nanargmin(column), np.nanargmax(column)} <= set(rows.tolist())
    assert 9000 in rows
    assert len(fitted_rows(numbers[:MAX_FIT_RUNS])) == MAX_FIT_RUNS


@pytest.mark.parametrize(
    ("cores", "runs", "jobs"),
    [(2, 7, 1), (2, 1001, 2), (2, 1100, 2), (2, 10**5, 24), (2, 10**6, 64), (6, 4096, 6),
     (6, 10**6, 60), (48, 10**6, 48), (96, 10**6, 96)],
)  # fmt: skip
def test_large_scans_have_tens_of_jobs_as_many_for_each_core(monkeypatch, cores, runs, jobs):
    monkeypatch.setattr("os.cpu_count", lambda: cores)
    campaign = SimpleNamespace(jobs=Jobs("auto", 32))
    assert batch_count(campaign, runs) == jobs
