"""Wall time of the paper's campaign, and the cpu time of many short runs beside their time loop.

Each runs in a folder of its own; the first after a small one that compiles and warms the disk."""

import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import yaml

from evidence.benchmark.processes import ROOT, environment, import_seconds, python
from evidence.rows import Row, at_least, at_most, info

GROUP = "Wall time of the paper's campaign, warm, on 2 cores"
CAMPAIGN_FILES = ("Snakefile", "workflow", "profiles", "config")
MOST = 15.0  # s

MANY_GROUP = "Many short runs"
RUNS_NAME = "runs of the solar array (12 s, 1,201 instants), by `run` without figures"

MANY_RUNS = """
import json, sys, time
from pathlib import Path
from deployable import campaign
from fpm.kernels import compiled_loop

prepare, loop = compiled_loop.prepare_call, []

def timed(*arguments):
    call = prepare(*arguments)
    def run():
        start = time.thread_time()
        call()
        loop.append(time.thread_time() - start)
    return run

compiled_loop.prepare_call = timed
campaign.run(json.loads(sys.argv[1]), sys.argv[2], figures=False, notify=lambda text: None)
stage = sum(json.loads(x.read_text())["seconds"][1] for x in Path(sys.argv[2]).rglob("batches/*"))
size = sum(x.stat().st_size for x in Path(sys.argv[2]).rglob("trajectories/*.nc"))
print(json.dumps([time.process_time(), stage, sum(loop), size / 1e6]))
"""

DEPLOYS = """
import sys, time
from deployable import campaign

campaign.run(sys.argv[1], sys.argv[2], notify=lambda text: None)
print(time.process_time())
"""


def copy_workflow(folder: Path) -> None:
    """The workflow in a folder of its own, so that no results of this checkout are touched."""
    for name in CAMPAIGN_FILES:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / name)


def run_seconds(folder: Path, module: str, *arguments: str) -> float:
    """Wall seconds of a call of a module."""
    command = [sys.executable, "-m", module, *arguments]
    start = time.perf_counter()
    process = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True)
    if process.returncode:
        raise RuntimeError(f"{module} failed:\n{process.stdout[-1000:]}\n{process.stderr[-3000:]}")
    return time.perf_counter() - start


def paper(config: str = "config/paper.yaml", repeats: int = 3) -> list[Row]:
    """The campaign by Snakemake, by `run`, and by `run` again with nothing to do; best of some."""
    calls = {
        "snakemake -c2": ("snakemake", "-c2", "--configfile", config),
        "python -m deployable run": ("deployable", "run", config),
        "the same again, with nothing to do": ("deployable", "run", config),
    }
    seconds = dict.fromkeys(calls, float("inf"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_workflow(folder)
        run_seconds(folder, "snakemake", "-c2", "--configfile", "config/small.yaml")
        for _ in range(repeats):
            for call, arguments in calls.items():
                if "again" not in call:
                    shutil.rmtree(folder / "results", ignore_errors=True)
                seconds[call] = min(seconds[call], run_seconds(folder, *arguments))
    unit = import_seconds()
    rows = [info("a process that imports six libraries", unit, "s")]
    for call, value in seconds.items():
        rows.append(at_most(call, value, MOST, note=f"{value / unit:.1f} times as long", unit="s"))
    return rows


def many_runs(samples: int = 1024, repeats: int = 3) -> list[Row]:
    """Processor time of many runs of the solar array, of the stage that simulates them and of the
    time loop in it, and what they take on disk; the call of least processor time."""
    config = yaml.safe_load((ROOT / "config/deploys.yaml").read_text())
    names = ("campaign", "scene", "solver", "intervals", "responses")
    config = {name: config[name] for name in names}
    config["scene"]["file"] = str(ROOT / "config" / config["scene"]["file"])
    config |= {"design": {"method": "sobol", "samples": samples}, "held_out": 0}
    calls = []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            calls.append(json.loads(python("-c", MANY_RUNS, json.dumps(config), folder)))
    total, stage, loop, size = min(calls)
    spread = f"least of {repeats}; median {np.median(calls, axis=0)[0]:.1f} s"
    return [
        at_most(f"{samples:,} {RUNS_NAME}", total, 5.0, note=spread, unit="s"),
        at_most("their trajectories on disk", size, 250.0, unit="MB"),
        at_least("time loop in the stage that simulates", 100 * loop / stage, 45.0, unit="%"),
        info("time loop, of the whole", loop, "s"),
    ]


def deploys(repeats: int = 2) -> list[Row]:
    """Processor time of a campaign with a choice, with figures and page, once kernels are compiled:
    the least of some calls after the first."""
    seconds = []
    for _ in range(1 + repeats):
        with tempfile.TemporaryDirectory() as folder:
            config = str(ROOT / "config/deploys.yaml")
            seconds.append(float(python("-c", DEPLOYS, config, folder)))
    return [at_most("`deploys`, with compiled kernels", min(seconds[1:]), 9.0, unit="s")]
