"""Batches: what is simulated, what is skipped, and what a failure leaves."""

from __future__ import annotations

import json
import time
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from harm import harm_file
from stored_runs import curves_in

import fpm
from deployable.campaign.config.check import check_config
from deployable.campaign.config.sections import Jobs, scene_type
from deployable.campaign.errors import CampaignError
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.results.facts import SOFT
from deployable.campaign.results.templates import sentence
from deployable.campaign.runs import batch as batches
from deployable.campaign.runs.batch import Simulation, run_batch
from deployable.campaign.samples.samples import gather
from fpm.files.seals import seal

KEEP = ["trajectories", "responses"]


def run_all(config, folder, keep):
    """Run all batches of a config; returns the plan and the numbers of runs simulated."""
    plan = make_plan(config.experiment)
    jobs = Jobs(512, 2, keep)
    counts = []
    for batch in range(2):
        manifest = folder / "batches" / f"{batch}.json"
        run_batch(plan, batch, 2, jobs, folder / keep, manifest, lambda text: None)
        counts.append(json.loads(manifest.read_text())["simulated"])
    return plan, counts


def test_runs_are_found_in_the_files_of_another_design(raw, tmp_path):
    """Whichever file has them; files that are none of the store are told of, and not used."""
    plan, _ = run_all(check_config(raw), tmp_path, "trajectories")
    raw["held_out"] += 3
    stray = tmp_path / "trajectories/0123456789abcdef.nc"
    stray.write_bytes(b"one run")
    seal(stray, {"name": "run 0123456789abcdef"})
    larger, said = make_plan(check_config(raw).experiment), []
    manifest, jobs = tmp_path / "0.json", Jobs(512, 4, "trajectories")
    run_batch(larger, 0, 1, jobs, tmp_path / "trajectories", manifest, said.append)
    new = len(larger.unique_runs) - len(plan.unique_runs)
    assert json.loads(manifest.read_text())["simulated"] == new > 0
    assert "cannot be used: it is run 0123456789abcdef; its runs are made again" in said[0]
    stray.unlink()
    assert len(curves_in(tmp_path / "trajectories")) == len(larger.unique_runs)


@pytest.mark.parametrize("keep", KEEP)
def test_every_run_is_simulated_once_and_a_campaign_that_was_killed_goes_on(config, tmp_path, keep):
    plan, counts = run_all(config, tmp_path, keep)
    assert sum(counts) == len(plan.unique_runs)
    _, again = run_all(config, tmp_path, keep)
    assert again == [0, 0]
    files = sorted((tmp_path / keep).glob("*.nc"))
    before = {path: path.stat().st_mtime_ns for path in files}
    files[0].unlink()  # not reached
    files[1].write_bytes(files[1].read_bytes()[:100])  # cut off by somebody else's means
    _, counts = run_all(config, tmp_path, keep)
    assert 2 <= sum(counts) <= 4
    for path in files[2:]:
        assert path.stat().st_mtime_ns == before[path]


@pytest.mark.parametrize("keep", KEEP)
def test_a_run_that_fails_does_not_harm_the_others(raw, tmp_path, keep):
    # One step serves all runs: between their limits it breaks the stiff ones only.
    soft = fpm.find_stable_step(scene_type("bennett").build(elements=2)).step
    raw["solver"] = {"step": 0.8 * soft, "duration": 0.02, "instants": 9}
    raw["intervals"] = {"E": {"lower": 1e9, "upper": 9e9}}
    plan = make_plan(check_config(raw).experiment)
    failed = 0
    for batch in range(2):
        manifest = tmp_path / f"{batch}.json"
        try:
            jobs = Jobs(512, 2, keep)
            run_batch(plan, batch, 2, jobs, tmp_path / keep, manifest, lambda text: None)
        except CampaignError as error:
            assert not manifest.exists()
            for word in ("run ", "E = ", "unstable at t = ", "solver.step"):
                assert word in str(error)
            failed += str(error).count("\n  run ")
    assert 0 < failed < len(plan.unique_runs)
    written = 0
    for path in (tmp_path / keep).glob("*.nc"):
        with xr.open_dataset(path) as data:
            written += data.sizes.get("run", 1)
    assert written == len(plan.unique_runs) - failed


def test_lots_come_in_order_and_one_group_is_made_while_another_is_taken(monkeypatch):
    begun = []

    def made(plan, part):
        begun.append(part[0] // 8)
        return list(part), [], np.zeros(2)

    monkeypatch.setattr(batches, "simulate", made)
    lots = [list(range(8 * k, 8 * k + 8)) for k in range(5)]
    lots.insert(2, [])
    taken = []
    for lot in Simulation(None, 8, 2).run_lots(lots):
        found = list(lot)
        time.sleep(0.05)  # time enough for what was started
        taken.append(found)
        if found:
            assert max(begun) <= found[0] // 8 + 1
    assert taken == lots


def test_structures_are_built_by_one_thread_at_a_time(config, monkeypatch):
    plan, inside = make_plan(config.experiment), Counter()
    real = type(plan.experiment.scene_type).build

    def build(self, **values):
        inside["now"] += 1
        inside["most"] = max(inside["most"], inside["now"])
        time.sleep(0.001)  # another thread has its turn
        scene = real(self, **values)
        inside["now"] -= 1
        return scene

    monkeypatch.setattr(type(plan.experiment.scene_type), "build", build)
    runs = plan.unique_runs
    found = Simulation(plan, 2, 2).run_lots([runs])
    assert sum(len(list(lot)) for lot in found) == len(runs) >= 4
    assert inside["most"] == 1


def values_in(folder, config) -> dict[str, np.ndarray]:
    """Values (n, t) of the responses by run, from trajectories."""
    responses = config.experiment.response_list
    runs = curves_in(folder).items()
    return {name: np.array([r.evaluate(curves) for r in responses]) for name, curves in runs}


@pytest.mark.parametrize("keep", KEEP)
def test_samples_hold_the_trajectories_responses(config, tmp_path, keep):
    plan, _ = run_all(config, tmp_path, keep)
    if keep != "trajectories":
        run_all(config, tmp_path, "trajectories")
    values = values_in(tmp_path / "trajectories", config)
    gather(plan, Jobs(512, 2, keep), tmp_path / keep, tmp_path / "samples.nc")
    with xr.open_dataset(tmp_path / "samples.nc") as samples:
        assert samples.sizes["run"] == len(plan.runs)
        for row, run in enumerate(plan.runs):
            assert samples["role"].values[row] == run.role
            assert samples["value"].values[row].tolist() == list(run.values)
            assert samples["parameter_a"].values[row] == run.values[0]
            wanted = values[run.id].astype(samples["values"].dtype)
            np.testing.assert_array_equal(samples["values"].values[row], wanted)
        assert "parameter_a" in samples["values"].coords
        assert samples["parameter_a"].attrs["units"] == "m"
        assert samples["response"].values.tolist() == ["BD", "vBz"]
        assert samples["response_units"].values.tolist() == ["m", "m s-1"]
        assert samples["values"].dtype == (np.float64 if keep == "trajectories" else np.float32)


@pytest.mark.parametrize(("keep", "again"), [("trajectories", 0), ("responses", 5)])
def test_only_a_response_of_what_no_other_reads_is_simulated_again(raw, tmp_path, keep, again):
    plan, _ = run_all(check_config(raw), tmp_path, keep)
    assert len(plan.unique_runs) == 5
    if keep == "trajectories":
        assert all({*run.points} == {*"BD"} for run in curves_in(tmp_path / keep).values())
    raw["responses"] = {
        "vBz": {"velocity": "D", "component": "z"},  # was B's
        "psi": {"opening": "A"},
        "T": {"energy": "kinetic"},
        "zB": {"position": "B", "component": "z"},
    }
    assert sum(run_all(check_config(raw), tmp_path, keep)[1]) == again
    raw["responses"]["AC"] = {"distance": ["A", "C"]}  # points that nothing has asked for
    config = check_config(raw)
    plan, counts = run_all(config, tmp_path, keep)
    assert sum(counts) == 5
    if keep == "trajectories":  # what the files had, too
        assert all({*run.points} == {*"ABCD"} for run in curves_in(tmp_path / keep).values())
    gather(plan, Jobs(512, 2, keep), tmp_path / keep, tmp_path / "samples.nc")
    run_all(check_config(raw), tmp_path / "fresh", "trajectories")
    values = values_in(tmp_path / "fresh/trajectories", config)
    with xr.open_dataset(tmp_path / "samples.nc") as samples:
        for row, run in enumerate(plan.runs):
            wanted = values[run.id].astype(samples["values"].dtype)
            np.testing.assert_array_equal(samples["values"].values[row], wanted)
        assert samples["response"].values.tolist() == list(raw["responses"])
        assert samples["response_long_name"].values[0] == "z-velocity of D"


@pytest.mark.parametrize(
    ("harm", "keep"),
    [("lost", "responses"), ("flipped", "responses"), ("swapped", "trajectories")],
)
def test_runs_that_were_lost_or_damaged_are_told_and_made_again(config, tmp_path, keep, harm):
    plan, _ = run_all(config, tmp_path, keep)
    jobs, whole, said = Jobs(512, 2, keep), tmp_path / "whole.nc", []
    gather(plan, jobs, tmp_path / keep, whole)
    path, other = sorted((tmp_path / keep).glob("*.nc"))[:2]
    harm_file(path, other, harm)
    gather(plan, jobs, tmp_path / keep, tmp_path / "samples.nc", said.append)
    assert any("made again" in text for text in said)
    assert harm == "lost" or path.name in said[0]
    with xr.open_dataset(whole) as first, xr.open_dataset(tmp_path / "samples.nc") as second:
        xr.testing.assert_identical(first, second)


def test_nothing_is_simulated_by_other_mechanics_than_was_planned(config, tmp_path):
    plan = replace(make_plan(config.experiment), mechanics="0123456789abcdef")
    with pytest.raises(CampaignError, match="has changed since the runs were planned"):
        run_batch(plan, 0, 1, config.jobs, tmp_path, tmp_path / "0.json", lambda text: None)
    assert not list(tmp_path.glob("*.nc"))


def test_events_are_gathered_in_their_rows(raw, tmp_path):
    raw["solver"] = {"duration": 0.4, "instants": 11}  # closes after about 0.33 s
    plan, _ = run_all(check_config(raw), tmp_path, "trajectories")
    jobs, curves = Jobs(512, 2, "trajectories"), curves_in(tmp_path / "trajectories")
    gather(plan, jobs, tmp_path / "trajectories", tmp_path / "samples.nc")
    with xr.open_dataset(tmp_path / "samples.nc") as samples:
        assert samples["contact"].values.tolist() == ["A", "B", "C", "D"]
        for row, run in enumerate(plan.runs):
            times = curves[run.id].events[:, 0]
            assert len(times) > 0
            found = samples["event_time"].values[row]
            np.testing.assert_array_equal(found[: len(times)], times)
            assert np.isnan(found[len(times) :]).all()


@pytest.mark.parametrize("keep", KEEP)
def test_faces_that_pass_through_each_other_are_told(raw, tmp_path, keep):
    raw["solver"] = {"duration": 0.4, "instants": 41}
    raw["scene"]["parameters"]["K_C"] = 5.0
    plan, _ = run_all(check_config(raw), tmp_path, keep)
    gather(plan, Jobs(512, 2, keep), tmp_path / keep, tmp_path / "samples.nc")
    if keep != "trajectories":
        run_all(check_config(raw), tmp_path, "trajectories")
    curves = curves_in(tmp_path / "trajectories")
    with xr.open_dataset(tmp_path / "samples.nc") as samples:
        for row, run in enumerate(plan.runs):
            least = min(opening.min() for opening in curves[run.id].openings.values())
            assert samples["overlap"].values[row] == -least > SOFT
        most = float(samples["overlap"].max())
    assert f"overlap by up to {most:.2g} rad" in sentence("soft", {"overlap": most, "closures": []})


def test_runs_with_too_many_events_to_keep_are_told(raw, tmp_path, monkeypatch):
    raw["solver"] = {"duration": 0.4, "instants": 11}
    monkeypatch.setattr(fpm.solver.pack, "MOST_ROOM", 1)
    monkeypatch.setattr(fpm.solver.pack, "MOST_EVENTS", 1)
    with pytest.raises(CampaignError, match="contact events, more than are kept"):
        run_all(check_config(raw), tmp_path, "trajectories")
