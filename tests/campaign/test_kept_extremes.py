"""`keep: extremes`: the bounds of a scan without the curves of its runs."""

from __future__ import annotations

import copy
import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from harm import harm_file

from deployable import campaign
from deployable.campaign.config.sections import Jobs
from deployable.campaign.errors import ConfigError
from deployable.campaign.plan.jobs import batch_count
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.results.quantity_results import MAX_FIT_RUNS, fitted_rows
from deployable.campaign.runs import batch, extremes
from deployable.campaign.runs.batch import run_batch
from deployable.campaign.runs.store import open_store
from deployable.campaign.samples import kept_extremes, samples

SAMPLES = 22


def silent(text: str) -> None:
    """Tell nobody."""


@pytest.fixture
def scan(raw) -> dict:
    """A scan that keeps extremes only."""
    raw["intervals"]["E"] = {"relative": 0.05}
    raw["design"] = {"method": "sobol", "samples": SAMPLES}
    raw["quantities"] = {"most": {"largest": "vBz"}}
    raw["jobs"] = {"keep": "extremes", "group": 4}
    return raw


def sample(plan, folder, group=4, batches=1, keep="extremes"):
    """Simulate and gather; the samples, and how many runs were simulated."""
    jobs, simulated = Jobs(512, group, keep), 0
    for number in range(batches):
        manifest = folder / f"{number}.json"
        run_batch(plan, number, batches, jobs, folder / keep, manifest, silent)
        simulated += json.loads(manifest.read_text())["simulated"]
    gather = kept_extremes.gather if keep == "extremes" else samples.gather
    gather(plan, jobs, folder / keep, folder / "samples.nc")
    with xr.open_dataset(folder / "samples.nc") as found:
        return found.load(), simulated


@pytest.mark.parametrize("keep", ["trajectories", "extremes"])
def test_a_new_expression_of_quantities_makes_no_run_again(scan, tmp_path, keep):
    scan["jobs"]["keep"], scan["design"]["samples"] = keep, 6
    scan["quantities"] |= {"least": {"smallest": "vBz"}}
    for name, text, runs in (
        ("spread", "most - least", 7),
        ("ratio", "2*spread/most", 0),
    ):
        scan["quantities"][name] = text
        plan = make_plan(campaign.check_config(scan).experiment)
        table, simulated = sample(plan, tmp_path, keep=keep)
        assert simulated == runs
    values = table["quantities"].to_series().unstack()
    np.testing.assert_array_equal(values["spread"], values["most"] - values["least"])
    np.testing.assert_array_equal(values["ratio"], 2 * values["spread"] / values["most"])
    assert table["quantity_units"].values.tolist() == ["m s-1", "m s-1", "m s-1", "1"]


@pytest.mark.slow
def test_bounds_of_the_scan_and_answers_are_those_of_all_curves_bit_for_bit(scan, tmp_path):
    found = campaign.run(scan, tmp_path, figures=False, notify=silent)
    folder = tmp_path / "test"
    whole = copy.deepcopy(scan) | {"campaign": "whole"}
    whole["jobs"]["keep"] = "trajectories"
    expected = campaign.run(whole, tmp_path, figures=False, notify=silent)
    for side in ("lower", "upper"):  # of further runs to single precision
        np.testing.assert_allclose(found[side], expected[side], rtol=1e-7, atol=0.0)
    assert not (folder / "trajectories").exists()
    with (
        xr.open_dataset(folder / "design_bounds.nc") as one,
        xr.open_dataset(tmp_path / "whole/design_bounds.nc") as other,
    ):
        for name in (*other.data_vars, "time", "response"):
            np.testing.assert_array_equal(one[name], other[name])
    with (
        xr.open_dataset(folder / "quantities.nc") as one,
        xr.open_dataset(tmp_path / "whole/quantities.nc") as other,
    ):
        np.testing.assert_array_equal(one["simulated_upper"], other["simulated_upper"])
        assert one.attrs["runs"] == other.attrs["runs"]
    with xr.open_dataset(folder / "samples.nc") as found:
        assert "values" not in found
        np.testing.assert_array_equal(found["nominal"], expected["nominal"])
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["design"]["runs"] == SAMPLES + 1
    assert summary["scan"]["drawn_runs"] == SAMPLES - 4
    told = (folder / "summary.md").read_text()
    assert "so this is no guarantee. The last quarter of the runs widened the bounds by" in told


@pytest.mark.slow
@pytest.mark.parametrize(("group", "batches"), [(1, 1), (5, 3)])
def test_neither_groups_nor_jobs_change_a_bit(scan, tmp_path, group, batches):
    plan = make_plan(campaign.check_config(scan).experiment)
    expected, _ = sample(plan, tmp_path / "one")
    found, simulated = sample(plan, tmp_path / "other", group, batches)
    assert simulated == SAMPLES + 1
    xr.testing.assert_identical(found, expected)


@pytest.mark.slow
def test_a_kill_costs_one_group(scan, tmp_path, monkeypatch):
    plan = make_plan(campaign.check_config(scan).experiment)
    expected, _ = sample(plan, tmp_path / "whole")
    simulate, calls = batch.simulate, []

    def killed(*arguments):
        calls.append(arguments)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return simulate(*arguments)

    monkeypatch.setattr(batch, "simulate", killed)
    monkeypatch.setattr(extremes, "PAUSE", 0.0)
    with pytest.raises(KeyboardInterrupt):
        sample(plan, tmp_path)
    # Shares have six, six, six and five runs: the fourth call ended the second share.
    files = sorted((tmp_path / "extremes").glob("*.nc"))
    assert [int(path.stem.split(".")[1]) for path in files] == [6, 6]
    found, simulated = sample(plan, tmp_path)
    assert simulated == SAMPLES + 1 - 12
    xr.testing.assert_identical(found, expected)


def test_half_a_share_goes_on_where_it_was(scan, tmp_path, monkeypatch):
    plan = make_plan(campaign.check_config(scan).experiment)
    store = open_store("extremes", tmp_path, plan.experiment)
    share = store.groups(plan.unique_runs, 4)[1]
    monkeypatch.setattr(extremes, "PAUSE", 0.0)
    made = batch.Simulation(plan, 2)
    store.write(share, made.results(share[[0, 3]]))
    assert [run.id for run in store.missing(share)] == [share[i].id for i in (1, 2, 4, 5)]
    store.write(share, made.results(store.missing(share)))
    (path,) = tmp_path.glob("*.nc")
    assert path.name.endswith(".6.nc")
    assert not len(store.missing(share))
    other = open_store("extremes", tmp_path / "other", plan.experiment)
    other.write(share, made.results(share))
    one, whole = store.read(share), other.read(share)
    for key in ("low", "high", "low_run", "high_run"):
        np.testing.assert_array_equal(getattr(one.bounds, key), getattr(whole.bounds, key))
    np.testing.assert_array_equal(one.first, whole.first)
    np.testing.assert_array_equal(one.numbers, whole.numbers)


@pytest.mark.parametrize("harm", ["lost", "flipped"])
def test_shares_that_were_lost_or_damaged_are_told_and_made_again(scan, tmp_path, harm):
    scan["design"]["samples"] = 9
    plan = make_plan(campaign.check_config(scan).experiment)
    expected, _ = sample(plan, tmp_path)
    path, other = sorted((tmp_path / "extremes").glob("*.nc"))[:2]
    harm_file(path, other, harm)
    said = []
    jobs = Jobs(512, 4, "extremes")
    kept_extremes.gather(plan, jobs, tmp_path / "extremes", tmp_path / "samples.nc", said.append)
    assert any("made again" in text for text in said)
    assert harm == "lost" or path.name in said[0]
    with xr.open_dataset(tmp_path / "samples.nc") as found:
        xr.testing.assert_identical(found.load(), expected)


def test_impacts_are_those_of_the_runs(scan, tmp_path):
    scan["solver"] = {"duration": 0.4, "instants": 11}
    scan["design"]["samples"] = 5
    plan = make_plan(campaign.check_config(scan).experiment)
    found, _ = sample(plan, tmp_path)
    whole, _ = sample(plan, tmp_path, keep="responses")
    assert found["contact"].values.tolist() == whole["contact"].values.tolist()
    for row in range(6):
        there = np.isfinite(whole["event_time"].values[row])
        assert there.any()
        count = int(there.sum())
        for name in ("event_time", "event_contact", "event_closing"):
            expected = whole[name].values[row, :count].astype(found[name].dtype)
            np.testing.assert_array_equal(found[name].values[row, :count], expected)
        assert np.isnan(found["event_time"].values[row, count:]).all()
    assert float(found["overlap"]) == whole["overlap"].values.max()


def test_a_million_runs_are_refused_where_the_disk_has_no_room(scan, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=1e9))
    scan["design"]["samples"] = 10**7
    campaign.check_config(scan)
    scan["jobs"]["keep"] = "responses"
    with pytest.raises(ConfigError, match=r"take about 1\.44 GB, and the disk has 1 GB") as refused:
        campaign.check_config(scan)
    assert "allowed: at most 6944444, or jobs.keep extremes" in str(refused.value)


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
    campaign = SimpleNamespace(jobs=Jobs("auto", 32, "extremes"))
    assert batch_count(campaign, runs) == jobs
