"""Where the wall time of a campaign goes, from Snakemake's own record of its jobs.

Each is run in a folder of its own, after a small one that compiles and warms the disk."""

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path

import yaml

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.processes import ROOT, environment
from evidence.benchmark.scenes import linkages, runner
from evidence.rows import Row, at_most, info

PAPER = "Wall time of a warm campaign on 2 cores: the paper's"
SCAN = "Wall time of a warm campaign on 2 cores: a scan of 1,000 samples"
LARGE = "Wall time of a warm campaign on 2 cores: a scan of 10,000 samples"
CAMPAIGN_FILES = ("Snakefile", "workflow", "profiles", "config")
IDLE = {
    "plan": (), "batch": ("plan",), "other": ("plan",), "samples": ("batch", "other"),
    "bounds": ("samples",), "figures": ("bounds",), "summary": ("bounds",), "page": ("summary",),
}  # fmt: skip
"""Jobs that do nothing, and those that each waits for: as many as a small campaign has."""
END = """
import threading

onsuccess:
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer) and "snakemake." in thread.function.__module__:
            thread.cancel()
"""
"""How ours ends without waiting for a second (workflow/rules/campaign.smk)."""


def copy_workflow(folder: Path) -> None:
    """The workflow in a folder of its own, so that no results of this checkout are touched."""
    for name in CAMPAIGN_FILES:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name)
        elif source.exists():
            shutil.copy(source, folder / name)


def scan(folder: Path, samples: int, keep: str) -> Path:
    """The config of a plain scan of `samples` runs, and `jobs.keep`."""
    config = yaml.safe_load((folder / "config/paper.yaml").read_text())
    config["campaign"] = "timed"
    config["design"] = {"method": "sobol", "samples": samples}
    config["jobs"] = {"keep": keep}
    config.pop("published", None)
    path = folder / "config/timed.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


def snakemake(folder: Path, config: Path | None, cores: int, *options: str) -> float:
    """Wall seconds of one call."""
    config_options = ("--configfile", str(config)) if config else ()
    return run_seconds(folder, "snakemake", f"-c{cores}", *config_options, *options)


def run_seconds(folder: Path, module: str, *arguments: str) -> float:
    """Wall seconds of a call of a module."""
    command = [sys.executable, "-m", module, *arguments]
    start = time.perf_counter()
    process = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True)
    if process.returncode:
        raise RuntimeError(f"{module} failed:\n{process.stdout[-1000:]}\n{process.stderr[-3000:]}")
    return time.perf_counter() - start


@cache
def measure_snakemake(cores: int) -> Row:
    """What Snakemake takes itself of a campaign's wall time."""
    rules = [END, f"rule all:\n    input: {[*IDLE]}\n    localrule: True\n"]
    for rule, needs in IDLE.items():
        parts = (f"rule {rule}:", f"input: {[*needs]}", f"output: '{rule}'", "localrule: True")
        rules.append("\n    ".join([*parts, "shell: 'touch {output}'\n"]))
    with tempfile.TemporaryDirectory() as name:
        Path(name, "Snakefile").write_text("\n".join(rules))
        wall = min(snakemake(Path(name), None, cores, "--forceall") for _ in range(3))
    return info("Snakemake alone", wall, "s", f"{len(IDLE)} jobs that do nothing, best of 3")


def jobs(folder: Path) -> list[tuple[str, float, float]]:
    """Rule, start and end (s since the epoch) of the jobs that Snakemake remembers, in order."""
    records = set()
    for path in (folder / ".snakemake/metadata").rglob("*"):
        if path.is_file():
            record = json.loads(path.read_text())
            if record.get("rule") and record.get("endtime"):
                records.add((record["rule"], record["starttime"], record["endtime"]))
    return sorted(records, key=lambda job: job[1])


def union(intervals: list[tuple[float, float]]) -> float:
    """Length (s) of the union of intervals."""
    total, latest = 0.0, float("-inf")
    for start, end in sorted(intervals):
        total += max(0.0, end - max(start, latest))
        latest = max(latest, end)
    return total


def time_campaign(
    samples: int | None = None, keep: str = "trajectories", cores: int = 2
) -> tuple[list[Row], float]:
    """Rows of the paper's campaign, or of a scan, once what it needs is warm; wall seconds first.

    And the share of the cores' time that they integrate."""
    with warm(samples, keep, cores) as (folder, config):
        dry = snakemake(folder, config, cores, "--dry-run")
        origin, cpu_start = time.time(), cpu_of_children()
        wall = snakemake(folder, config, cores)
        cpu = cpu_of_children() - cpu_start
        spans = jobs(folder)
        manifests = manifests_in(folder)
    snakemake_row = measure_snakemake(cores)
    first = spans[0][1] - origin if spans else wall
    busy_seconds = union([(start, end) for _, start, end in spans])
    runs = sum(manifest["runs"] for manifest in manifests)
    batch_seconds = sum(manifest["seconds"][0] for manifest in manifests) / cores
    arithmetic = core_seconds(manifests) / cores
    note = f"sum over the batches, shared by {cores} cores"
    rows = [
        info("all", wall, "s", f"{runs} runs in {len(manifests)} batches"),
        info("cpu time of all processes", cpu, "s"),
        info("a dry run: interpreter, imports, plan of the jobs", dry, "s"),
        snakemake_row,
        info("until the first job starts", first, "s"),
        info("between jobs and at the end", wall - first - busy_seconds, "s"),
        *rules(spans),
        info("batches inside their processes", batch_seconds, "s", note),
        info("integrating", arithmetic, "s",
             f"cpu time, {note}: {100 * arithmetic / wall:.0f} % of all"),
        info("integrating, undisturbed", arithmetic_seconds(runs) / cores, "s",
             "the same for a process that has the machine to itself"),
    ]  # fmt: skip
    return rows, arithmetic / wall


def whole(samples: int, keep: str) -> tuple[list[Row], float]:
    """The same of a scan by `python -m deployable run`, which has all cores of the machine."""
    cores = os.cpu_count() or 1
    with warm(samples, keep, cores) as (folder, config):
        wall = run_seconds(folder, "deployable", "run", str(config))
        share = core_seconds(manifests_in(folder)) / cores / wall
    note = f"one process that computes, one that draws; {cores} cores"
    return [info("all", wall, "s", note)], share


@contextmanager
def warm(samples: int | None, keep: str, cores: int) -> Iterator[tuple[Path, Path]]:
    """A folder in which a small campaign has been run, and the config of the one to be measured."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_workflow(folder)
        config = scan(folder, samples, keep) if samples else folder / "config/paper.yaml"
        snakemake(folder, folder / "config/small.yaml", cores)
        shutil.rmtree(folder / "results")
        shutil.rmtree(folder / ".snakemake")
        yield folder, config


def manifests_in(folder: Path) -> list[dict]:
    """What the batches noted of themselves."""
    return [json.loads(p.read_text()) for p in folder.glob("results/*/batches/*.json")]


def core_seconds(manifests: list[dict]) -> float:
    """Cpu seconds, of all cores together."""
    return sum(manifest["seconds_integrating"][1] for manifest in manifests)


def rules(spans: list[tuple[str, float, float]]) -> list[Row]:
    """The time that each rule's jobs took together."""
    return [
        info(f"rule {rule}", union([(start, end) for r, start, end in spans if r == rule]), "s")
        for rule in dict.fromkeys(rule for rule, _, _ in spans)
    ]


def cpu_of_children() -> float:
    """Cpu seconds (user and system) of all processes that this one has started and that ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def arithmetic_seconds(runs: int) -> float:
    """Cpu seconds that integrating `runs` samples of the paper's scene for 1 s takes."""
    scenes = linkages(32)
    step = 0.9 * fpm.find_stable_step(scenes[0]).step
    steps = round(0.05 / step)
    seconds = best({"run": runner(scenes, steps, step)}, 3)["run"]
    return seconds / 0.05 * runs / 32


def paper() -> list[Row]:
    """The paper's campaign, warm."""
    (first, *rows), _ = time_campaign()
    return [at_most(first.name, first.value, 15.0, note=first.note, unit="s"), *rows]


def scans(samples: int, most: float, *stores: str) -> list[Row]:
    """A scan for each `jobs.keep` of `stores`, by Snakemake and by `run`, with the share (%) of its
    cores' time that is not arithmetic, which is to be at most `most`; one file for each run has no
    such aim."""
    all_rows = []
    for keep in stores:
        for suffix, measure in (("", time_campaign), (", run", whole)):
            rows, share = measure(samples, keep)
            rest, unit = 100 * (1 - share), "% of all"
            name = "everything but integrating"
            is_aim = keep != "trajectories"
            rows.append(at_most(name, rest, most, unit=unit) if is_aim else info(name, rest, unit))
            all_rows += [replace(row, name=f"{keep}{suffix}: {row.name}") for row in rows]
    return all_rows
