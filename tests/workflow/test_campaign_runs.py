"""Campaigns through Snakemake: complete, repeatable, and only what changed runs again."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
from stored_runs import curves_in

from deployable import campaign

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


SMALL = ("--configfile", "config/small.yaml")

OF_BOUNDS = {"bounds", "answers", "figures", "page"}
ALL_RULES = {"plan", "simulate", *OF_BOUNDS}


OVERVIEWS = ("campaign/moments.png", "campaign/moments.pdf")


def planned(output: str) -> set[str]:
    """Names of the rules in Snakemake's table of jobs, `all` left out."""
    table = output.split("Job stats:")[1].split("total")[0]
    return set(re.findall(r"^(\w+)\s+\d+$", table, flags=re.M)) - {"all"}


def test_a_campaign_leaves_its_results(small):
    results = small.folder / "results" / "small"
    for name in ("BD.png", "BD.pdf", "vBz.png", "vBz.pdf", *OVERVIEWS):
        assert (results / "figures" / name).stat().st_size > 5000
    summary = json.loads((results / "summary.json").read_text())
    assert [row["name"] for row in summary["responses"]] == ["BD", "vBz"]
    assert all(row["largest_difference"] > 0 for row in summary["responses"])
    assert len(curves_in(results / "trajectories")) == summary["design"]["runs"] == 7


def test_each_case_has_the_rules_of_a_campaign(workplace):
    dry = workplace.snakemake("--configfile", "config/wing.yaml", "--dry-run")
    assert dry.returncode == 0, dry.stdout
    names = ("in_orbit", "on_ground", "one_spring_out", "late_release")
    assert planned(dry.stdout) == {
        "cases",
        *(f"case_{name}_{rule}" for name in names for rule in OF_BOUNDS),
    }


def test_progress_is_visible(small):
    assert "small: 7 of 7 runs done" in small.output
    assert "(100%) done" in small.output
    started, answer = small.output.split("(100%) done")
    assert " differs by up to" in answer and " differs by up to" not in started
    assert answer.count("Open results/small/report.html") == 1 and "Open " not in started


def test_a_second_call_has_nothing_to_do(small):
    again = small.snakemake(*SMALL)
    assert again.returncode == 0
    assert "Nothing to be done" in again.stdout


@pytest.mark.parametrize("arguments", [["--unlock"], ["--report", "report.html"]])
def test_what_runs_no_job_needs_no_number_of_cores(small, arguments):
    command = [sys.executable, "-m", "snakemake", *SMALL, *arguments]
    done = subprocess.run(
        command, cwd=small.folder, env=small.environment(),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    if "--report" in arguments:
        report = (small.folder / "report.html").read_text(encoding="utf-8")
        for words in (
            "BD.png",
            "moments.png",
            "summary.md",
            "report.html",
            "The arrow marks the largest",
        ):
            assert words in report


def test_the_same_campaign_in_one_call_gives_the_same_files(small, tmp_path):
    results = small.folder / "results" / "small"
    config = small.folder / "config" / "small.yaml"
    campaign.run(config, tmp_path, notify=lambda text: None)
    for name in ("samples.nc", "surrogate.nc", "bounds.nc", "sensitivities.nc"):
        with (
            xr.open_dataset(results / name) as first,
            xr.open_dataset(tmp_path / "small" / name) as second,
        ):
            xr.testing.assert_identical(first, second)
    ends = [path.relative_to(results) for path in results.rglob("figures/**/*.*")]
    assert len(ends) == 10
    for name in ("plan.json", "summary.json", "summary.md", *ends):
        first, second = (
            without_moment((folder / name).read_bytes()) for folder in (results, tmp_path / "small")
        )
        # Seals tell the config as seen from their folder, and these are two.
        paths = [os.path.relpath(config, folder) for folder in (results.parent, tmp_path)]
        there, here = (f'"config": "{path}"'.encode() for path in paths)
        assert first.replace(there, here) == second, name


@pytest.mark.parametrize(
    ("override", "rules"),
    [
        (["published={BD: 0.1}"], {"answers", "figures", "page"}),
        (["bounds={model: spline}"], OF_BOUNDS),
        (["jobs={runs_per_job: 4}"], None),
    ],
)
def test_a_change_runs_only_what_depends_on_it(small, override, rules):
    planned_run = small.snakemake(*SMALL, "--dry-run", "--config", *override)
    assert planned_run.returncode == 0, planned_run.stdout
    if rules is None:
        assert "Nothing to be done" in planned_run.stdout
    else:
        assert planned(planned_run.stdout) == rules


def without_moment(content: bytes) -> bytes:
    """A result without the parts of its seal that differ from one time it is made to the next."""
    return re.sub(rb'"(made|digest)": "[^"]*"', b"", content)


def test_changed_code_makes_all_again_whatever_the_times_of_files(small, workplace):
    """That every source file counts, tests/fpm/test_digest.py holds."""
    for name in ("results", ".snakemake"):
        shutil.copytree(small.folder / name, workplace.folder / name)
    nothing = shutil.ignore_patterns("__pycache__")
    for room in ("deployable", "fpm"):
        shutil.copytree(ROOT / room, workplace.folder / room, ignore=nothing)
    kernel = workplace.folder / "fpm" / "elements" / "bars" / "beam_kernels.py"
    text = kernel.read_text()
    assert "slope = s * s + 2.0" in text
    kernel.write_text(text.replace("slope = s * s + 2.0", "slope = s * s + 2.1"))
    os.utime(kernel, (0, 0))
    assert planned(workplace.snakemake(*SMALL, "--dry-run").stdout) == ALL_RULES
    plan = ("results/small/plan.json", *SMALL)
    again = workplace.snakemake(*plan)
    assert again.returncode == 0, again.stdout
    assert "Nothing to be done" in workplace.snakemake(*plan, "--dry-run").stdout


def test_what_was_lost_or_damaged_is_told_and_made_again(small, workplace):
    for name in ("results", ".snakemake"):
        shutil.copytree(small.folder / name, workplace.folder / name)
    results = workplace.folder / "results" / "small"
    before = {path: without_moment(path.read_bytes()) for path in results.glob("*.*")}
    next((results / "trajectories").glob("*.nc")).unlink()
    samples = bytearray((results / "samples.nc").read_bytes())
    samples[len(samples) // 2] ^= 1
    (results / "samples.nc").write_bytes(samples)
    plan = (results / "plan.json").read_bytes()
    (results / "plan.json").write_bytes(plan[: len(plan) // 2])
    call = ("results/small/summary.md", *SMALL)
    done = workplace.snakemake(*call)
    assert done.returncode == 0, done.stdout
    for told in ("samples.nc cannot be used", "plan.json cannot be used", "made again"):
        assert told in done.stdout
    for name in ("plan.json", "summary.json", "summary.md"):
        assert without_moment((results / name).read_bytes()) == before[results / name]
    assert "Nothing to be done" in workplace.snakemake(*call).stdout


def test_results_from_elsewhere_are_not_taken_for_what_is_asked(small, workplace):
    shutil.copytree(small.folder / "results", workplace.folder / "results")  # not .snakemake
    same = workplace.snakemake(*SMALL, "--dry-run")
    assert "Nothing to be done" in same.stdout, same.stdout
    finer = ["--config", "scene={name: bennett, parameters: {elements: 3}}"]
    asked = workplace.snakemake(*SMALL, "--dry-run", *finer)
    assert planned(asked.stdout) == ALL_RULES


def test_a_campaign_that_was_stopped_goes_on(workplace):
    # Runs one by one, long enough to be stopped between two of them.
    override = ["--config", "jobs={group: 1, runs_per_job: 100}", "solver={duration: 2.0}"]
    with subprocess.Popen(
        workplace.command(*SMALL, *override),
        cwd=workplace.folder,
        env=workplace.environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        folder = workplace.folder / "results" / "small" / "trajectories"
        deadline = time.monotonic() + 400
        while len(list(folder.glob("*.nc"))) < 2 and time.monotonic() < deadline:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGKILL)
    before = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nc")}
    assert 2 <= len(before) < 7
    assert workplace.snakemake(*SMALL, *override, "--unlock").returncode == 0
    done = workplace.snakemake("results/small/samples.nc", *SMALL, *override)
    assert done.returncode == 0, done.stdout
    after = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nc")}
    assert len(after) == 7
    assert {name: after[name] for name in before} == before


def test_a_failing_batch_ends_with_a_message_and_keeps_the_others(workplace):
    override = ["--config", "intervals={E: {lower: 1.0e9, upper: 9.0e9}}", "solver={step: 6.0e-5}"]
    done = workplace.snakemake(*SMALL, *override)
    assert done.returncode != 0
    assert "unstable at t = " in done.stdout
    assert "all others were written" in done.stdout
    assert 0 < len(curves_in(workplace.folder / "results/small/trajectories")) < 7
    assert not (workplace.folder / "results" / "small" / "bounds.nc").exists()


def test_an_accuracy_is_met_alike_in_the_workflow_and_in_one_call(workplace):
    """Whatever threads their environments ask for: linear algebra rounds by their number, and
    Snakemake asks for as many as a rule has."""
    path = str(workplace.folder / "config" / "aim.yaml")
    done = workplace.snakemake("results/aim/summary.json", "--configfile", path)
    assert done.returncode == 0, done.stdout
    results, again = workplace.folder / "results" / "aim", workplace.folder / "again" / "aim"
    assert json.loads((results / "summary.json").read_text())["accuracy"]["met"]
    command = [sys.executable, "-m", "deployable", "run", path, "--no-figures"]
    command += ["--results", str(again.parent)]
    environment = {**workplace.environment(), "OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    subprocess.run(
        [*command, "--results", str(again.parent)],
        check=True,
        env=environment,
        cwd=workplace.folder,
    )
    for name in ("samples.nc", "bounds.nc", "quantities.nc"):
        with xr.open_dataset(results / name) as first, xr.open_dataset(again / name) as second:
            xr.testing.assert_identical(first, second)
    for name in ("plan.json", "summary.json", "rounds/1/plan.json"):
        first, second = ((folder / name).read_bytes() for folder in (results, again))
        assert without_moment(first) == without_moment(second), name
