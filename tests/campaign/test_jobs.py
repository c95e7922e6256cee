"""How large jobs are, what they ask for, processes of a job, and runs carried between jobs."""

from __future__ import annotations

import os
import signal
import tarfile
from functools import partial
from operator import mul

import pytest

from deployable.campaign.config.check import check_config
from deployable.campaign.errors import CampaignError
from deployable.campaign.plan import jobs
from deployable.campaign.plan.jobs import (
    CORES,
    batch_count,
    job_megabytes,
    job_minutes,
    runs_in_job,
)
from deployable.campaign.runs.batch import spread
from deployable.campaign.runs.store import pack, unpack

RAW = {
    "campaign": "sized",
    "scene": {"name": "bennett", "parameters": {"elements": 2}},
    "solver": {"duration": 0.1, "instants": 101, "step": 1e-4},
    "intervals": {"E": {"nominal": 1e9, "relative": 0.01}},
    "design": {"method": "sobol", "samples": 1000},
    "responses": {"BD": {"distance": ["B", "D"]}},
}


def sized(**asked):
    return check_config({**RAW, "jobs": asked})


def test_without_minutes_a_job_has_the_runs_that_the_config_says():
    assert batch_count(sized(runs_per_job=77), 1001) == 13


def test_a_job_elsewhere_finds_as_many_batches(monkeypatch):
    monkeypatch.setenv(CORES, "20")
    monkeypatch.setattr(os, "cpu_count", lambda: 64)
    assert batch_count(sized(), 512 * 40) == 20


def test_a_job_of_minutes_has_whole_groups_that_take_so_long(monkeypatch):
    monkeypatch.setattr("fpm.scenes.timestep.machine", lambda: 1.0)
    # The estimate: 1000 steps of 8 elements and 4 hinges, 0.5 ms, and 1.3 ms to pack a run.
    assert runs_in_job(sized(minutes=0.1, group=1)) == pytest.approx(6 / 1.8e-3, rel=0.1)
    monkeypatch.setattr(jobs, "seconds_of_run", lambda campaign: 2.0)
    asked = {"minutes": 30, "group": 8}
    assert runs_in_job(sized(**asked)) == 896  # 30 * 60 / 2 = 900, in groups of 8
    assert runs_in_job(sized(**asked, processes=4)) == 3600
    assert batch_count(sized(**asked), 1792) == 2
    assert batch_count(sized(**asked), 1793) == 3
    # Not less than a group for each process.
    assert runs_in_job(sized(minutes=0.001, group=8, processes=3)) == 24


def test_a_job_asks_for_more_the_more_it_has(monkeypatch):
    monkeypatch.setattr(jobs, "seconds_of_run", lambda campaign, time=None: 6.0)
    one, four = sized(), sized(processes=4)
    assert job_minutes(one, 1000) == 5 + 200
    assert job_minutes(four, 1000) == 5 + 50
    assert job_megabytes(four) > job_megabytes(one) > 500
    longer = check_config({**RAW, "solver": {**RAW["solver"], "instants": 10_001, "step": "auto"}})
    assert job_megabytes(longer) > job_megabytes(one) + 20


def test_memory_holds_what_is_recorded_and_what_is_asked():
    def megabytes(responses, instants):
        solver = {**RAW["solver"], "instants": instants}
        asked = {f"r{i}": {"distance": ["B", "D"]} for i in range(responses)}
        jobs = {"group": 100}
        return job_megabytes(check_config(
            {**RAW, "solver": solver, "responses": asked, "jobs": jobs}))  # fmt: skip

    few, many = megabytes(1, 1001), megabytes(201, 1001)
    # 200 responses of 1001 instants of 8 bytes, of 100 runs, three times.
    assert many - few == pytest.approx(200 * 1001 * 8 * 100 * 3 / 1e6, abs=1.5)
    assert megabytes(1, 2001) > few


@pytest.mark.parametrize("processes", [1, 3])
def test_processes_do_all_of_the_work(processes):
    work = [(number, 2) for number in range(20)]
    assert sorted(spread(mul, work, processes)) == list(range(0, 40, 2))


def _end(parent, number):
    if number == 3 and os.getpid() != parent:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_process_that_is_ended_from_outside_is_told():
    with pytest.raises(CampaignError, match=r"ended from outside.*finished runs are kept"):
        list(spread(partial(_end, os.getpid()), [(number,) for number in range(8)], 2))


def test_runs_are_carried_from_one_folder_to_another(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    for name in ("a.nc", "b.nc", "c.txt", ".d.part"):
        (here / name).write_text(f"of {name}")
    pack(here, tmp_path / "bundle.tar")
    there.mkdir()
    (there / "b.nc").write_text("another")
    unpack([tmp_path / "bundle.tar"], there)
    assert {p.name: p.read_text() for p in there.iterdir()} == {
        "a.nc": "of a.nc",
        "b.nc": "another",
    }


def test_a_bundle_leaves_its_folder_alone(tmp_path):
    (tmp_path / "run").write_text("evil")
    with tarfile.open(tmp_path / "bundle.tar", "w") as file:
        file.add(tmp_path / "run", "../../up.nc")
        file.add(tmp_path / "run", "no-run.py")
    unpack([tmp_path / "bundle.tar"], tmp_path / "a" / "b" / "c")
    assert [p.name for p in (tmp_path / "a").rglob("*.*")] == ["up.nc"]
    assert (tmp_path / "a" / "b" / "c" / "up.nc").exists()
    (tmp_path / "bundle.tar").write_text("nothing")
    with pytest.raises(CampaignError, match=r"bundle\.tar holds no runs"):
        unpack([tmp_path / "bundle.tar"], tmp_path)
