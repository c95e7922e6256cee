"""Wall time of the paper's campaign, in a folder of its own, after a small one that compiles and
warms the disk."""

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from evidence.benchmark.processes import ROOT, environment, import_seconds
from evidence.rows import Row, at_most, info

GROUP = "Wall time of the paper's campaign, warm, on 2 cores"
CAMPAIGN_FILES = ("Snakefile", "workflow", "profiles", "config")
MOST = 15.0  # s


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
