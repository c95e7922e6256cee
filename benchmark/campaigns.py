"""Where the wall time of a campaign goes, from Snakemake's own record of its jobs.

    python -m benchmark.campaigns [--samples 1000] [--cores 2]

runs a campaign twice in a folder of its own, the first time only to compile and to warm the disk.
"""

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

import fpm
from benchmark.clock import best
from benchmark.processes import ROOT, environment
from benchmark.rows import Row, at_most, table, told
from benchmark.scenes import linkages, runner

COPIED = ("Snakefile", "workflow", "profiles", "config")


def copy_workflow(folder: Path) -> None:
    """The workflow in a folder of its own, so that no results of this checkout are touched."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name)
        elif source.exists():
            shutil.copy(source, folder / name)


def scan(folder: Path, samples: int) -> Path:
    """The config of a plain scan of `samples` runs with one netCDF file each."""
    config = yaml.safe_load((folder / "config/paper.yaml").read_text())
    config["campaign"] = "timed"
    config["design"] = {"method": "scan", "samples": samples}
    config.pop("published", None)
    path = folder / "config/timed.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


def snakemake(folder: Path, config: Path, cores: int, *more: str) -> float:
    """Wall seconds of one call."""
    command = [sys.executable, "-m", "snakemake", f"-c{cores}", "--configfile", str(config), *more]
    start = time.perf_counter()
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"snakemake failed:\n{done.stdout[-1000:]}\n{done.stderr[-3000:]}")
    return time.perf_counter() - start


def jobs(folder: Path) -> list[tuple[str, float, float]]:
    """Rule, start and end (s since the epoch) of the jobs that Snakemake remembers, in order."""
    found = set()
    for path in (folder / ".snakemake/metadata").rglob("*"):
        if path.is_file():
            record = json.loads(path.read_text())
            if record.get("rule") and record.get("endtime"):
                found.add((record["rule"], record["starttime"], record["endtime"]))
    return sorted(found, key=lambda job: job[1])


def busy(intervals: list[tuple[float, float]]) -> float:
    """Length (s) of the union of intervals."""
    total, reached = 0.0, float("-inf")
    for start, end in sorted(intervals):
        total += max(0.0, end - max(start, reached))
        reached = max(reached, end)
    return total


def timed(config_name: str, samples: int | None, cores: int) -> tuple[float, list[Row]]:
    """Wall seconds of a warm campaign, and rows that say where they went."""
    group = f"Wall time of a warm campaign on {cores} cores: {config_name}"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy_workflow(folder)
        config = scan(folder, samples) if samples else folder / "config/paper.yaml"
        snakemake(folder, folder / "config/small.yaml", cores)
        shutil.rmtree(folder / "results")
        shutil.rmtree(folder / ".snakemake")
        dry = snakemake(folder, config, cores, "--dry-run")
        started, before = time.time(), cpu_of_children()
        wall = snakemake(folder, config, cores)
        cpu = cpu_of_children() - before
        done = jobs(folder)
        manifests = [json.loads(p.read_text()) for p in folder.glob("results/*/batches/*.json")]
        runs = sum(len(manifest["runs"]) for manifest in manifests)
    first = done[0][1] - started if done else wall
    during = busy([(start, end) for _, start, end in done])
    inside = sum(manifest["seconds"][0] for manifest in manifests) / cores
    arithmetic = sum(manifest["seconds_integrating"][0] for manifest in manifests) / cores
    arithmetic_cpu = sum(manifest["seconds_integrating"][1] for manifest in manifests)
    rows = [
        told(group, "all", wall, "s", f"{runs} runs in {len(manifests)} batches"),
        told(group, "cpu time of all processes", cpu, "s", f"integrating: {arithmetic_cpu:.3g} s"),
        told(group, "a dry run: interpreter, imports, plan of the jobs", dry, "s"),
        told(group, "until the first job starts", first, "s"),
        told(group, "between jobs and at the end", wall - first - during, "s"),
    ]
    for rule in dict.fromkeys(rule for rule, _, _ in done):
        spans = [(start, end) for r, start, end in done if r == rule]
        rows.append(told(group, f"rule {rule}", busy(spans), "s"))
    shared = f"sum over the batches, shared by {cores} cores"
    rows.append(told(group, "batches inside their processes", inside, "s", shared))
    note = f"{shared}: {100 * arithmetic / wall:.0f} % of all"
    rows.append(told(group, "integrating", arithmetic, "s", note))
    alone = arithmetic_seconds(runs) / cores
    note = "the same for a process that has the machine to itself"
    rows.append(told(group, "integrating, undisturbed", alone, "s", note))
    return wall, rows


def cpu_of_children() -> float:
    """Cpu seconds (user and system) of all processes that this one has started and that ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def arithmetic_seconds(runs: int) -> float:
    """Cpu seconds that integrating `runs` samples of the paper's scene for 1 s takes."""
    scenes = linkages(32)
    step = 0.9 * fpm.stable_step(scenes[0]).step
    steps = round(0.05 / step)
    seconds = best({"run": runner(scenes, steps, step)}, 3)["run"]
    return seconds / 0.05 * runs / 32


def paper(cores: int = 2) -> list[Row]:
    """The paper's campaign, warm."""
    wall, rows = timed("the paper's", None, cores)
    note = rows[0].note
    return [at_most(rows[0].group, "all", wall, 15.0, "s", note), *rows[1:]]


def many(samples: int = 1000, cores: int = 2) -> list[Row]:
    """A scan of many samples, with the share of its wall time that is not arithmetic."""
    wall, rows = timed(f"a scan of {samples} samples", samples, cores)
    integrating = next(row.value for row in rows if row.name == "integrating")
    rest = 100 * (1 - integrating / wall)
    return [*rows, at_most(rows[0].group, "everything but integrating", rest, 20.0, "% of all")]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=1000, help="0: the paper's campaign")
    parser.add_argument("--cores", type=int, default=2)
    options = parser.parse_args()
    fpm.warm_up()
    print(table(many(options.samples, options.cores) if options.samples else paper(options.cores)))
