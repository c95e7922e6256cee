"""A campaign in the queue of a real Slurm: the same bits, and nothing lost to what befalls jobs."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import cluster
import pytest
import xarray as xr

from deployable import campaign

ROOT = Path(__file__).parents[2]
PLUGIN = "snakemake_executor_plugin_slurm"
REASON = cluster.missing() or (
    "" if importlib.util.find_spec(PLUGIN) else f"{PLUGIN} not installed"
)
pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(REASON), reason=REASON)]

CONFIG = """\
campaign: queued
scene: {name: bennett, parameters: {elements: 2}}
solver: {duration: 2.0, instants: 41, step: 1e-6}  # seconds for a run
intervals:
  a: {nominal: 0.035, relative: 0.01}
  E: {lower: 0.95e9, upper: 1.05e9}
design: {method: sobol, samples: 11}
responses:
  BD: {distance: [B, D]}
jobs: JOBS
"""
SAMPLES = "results/queued/samples.nc"


@pytest.fixture(scope="module", autouse=True)
def slurm():
    cluster.up()
    yield
    cluster.down()


class Queue:
    """A folder whose campaign goes through the queue."""

    def __init__(self, folder: Path, jobs: str):
        self.folder, self.config = folder, CONFIG
        (folder / "mine.yaml").write_text(self.config.replace("JOBS", jobs), encoding="utf-8")

    def start(self, *more: str) -> subprocess.Popen:
        command = [
            sys.executable, "-m", "snakemake", SAMPLES, "-s", ROOT / "Snakefile",
            "--configfile", "mine.yaml", "--profile", ROOT / "workflow/profiles/slurm",
            "--slurm-no-account", "--default-resources", "slurm_partition=test",
            "--slurm-status-command", "squeue", "--seconds-between-status-checks", "3",
            "--slurm-init-seconds-before-status-checks", "3", *more,
        ]  # fmt: skip
        with open(self.folder / "output.txt", "w") as output:
            return subprocess.Popen(
                command, cwd=self.folder, env={**os.environ, "PYTHONPATH": str(ROOT)},
                stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
            )  # fmt: skip

    def end(self, process: subprocess.Popen) -> str:
        """Wait for Snakemake, which must end well; what it said."""
        status = process.wait(900)
        told = (self.folder / "output.txt").read_text()
        assert status == 0, told
        return told

    def runs(self) -> dict[str, int]:
        """The runs that are there, with the moments at which they were written."""
        found = (self.folder / "results/queued/trajectories").glob("*.nc")
        return {path.stem: path.stat().st_mtime_ns for path in found}

    def is_as_computed_here(self) -> None:
        """Compare the samples, to the last bit, with those of one process without Snakemake."""
        there = self.folder / "here"
        text = self.config.replace("JOBS", "{group: 32}")
        (self.folder / "here.yaml").write_text(text, encoding="utf-8")
        campaign.run(self.folder / "here.yaml", there, figures=False, notify=lambda text: None)
        with (
            xr.open_dataset(self.folder / SAMPLES) as queued,
            xr.open_dataset(there / "queued/samples.nc") as here,
        ):
            xr.testing.assert_identical(queued, here)


def jobs() -> dict[str, dict[str, str]]:
    """What is running, by the number of the job."""
    told = cluster.told("squeue", "-h", "-t", "R", "-o", "%i %N %l %C %m %k")
    rows = [line.split(maxsplit=5) for line in told.splitlines()]
    names = ("node", "limit", "cores", "memory", "comment")
    return {row[0]: dict(zip(names, row[1:], strict=True)) for row in rows}


def state(job: str) -> str:
    """How a job stands, or has ended."""
    told = cluster.told("scontrol", "-o", "show", "job", job)
    return re.search(r"JobState=(\w+)", told)[1]


def until(holds, seconds: float = 400) -> None:
    deadline = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.3)


def test_a_cancelled_job_one_out_of_time_and_a_failing_node_lose_nothing(tmp_path):
    """And what is there is, to the bit, what one process gives."""
    queue = Queue(tmp_path, "{runs_per_job: 4, group: 1}")
    process = queue.start()
    try:
        until(lambda: len(jobs()) == 3 and len(queue.runs()) >= 3)
        before, running = queue.runs(), jobs()
        (cancelled, first), (late, _), (struck, third) = sorted(running.items())
        assert first["cores"] == "1"
        assert re.fullmatch(r"\d+M", first["memory"])

        cluster.told("scancel", "--signal=STOP", "--full", late)  # it hangs
        cluster.told("scontrol", "update", f"jobid={late}", "timelimit=1")
        cluster.told("scancel", cancelled)
        cluster.stop_node(third["node"])
        cluster.told("scontrol", "update", f"node={third['node']}", "state=down", "reason=test")
        until(lambda: state(cancelled) == "CANCELLED" and state(late) == "TIMEOUT")
        until(lambda: struck not in jobs())
        cluster.start_node(third["node"])
        queue.end(process)
    finally:
        process.kill()
    after = queue.runs()
    assert len(after) == 12
    assert {name: after[name] for name in before} == before  # what was there is as it was
    queue.is_as_computed_here()
