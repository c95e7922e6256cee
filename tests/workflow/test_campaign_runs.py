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

import numpy as np
import pytest
import xarray as xr

SMALL = ("--configfile", "config/small.yaml")

ALL_RULES = {
    "nodes",
    "simulate",
    "gather",
    "bounds",
    "envelopes",
    "sensitivities",
    "linkage",
    "summary",
}


def planned(output: str) -> set[str]:
    """Names of the rules in Snakemake's table of jobs, `all` left out."""
    table = output.split("Job stats:")[1].split("total")[0]
    return set(re.findall(r"^(\w+)\s+\d+$", table, flags=re.M)) - {"all"}


def test_a_campaign_leaves_its_results(small):
    results = small.folder / "results" / "small"
    for name in ("BD.png", "BD.pdf", "vBz.png", "vBz.pdf", "linkage.png", "linkage.pdf"):
        assert (results / "figures" / name).stat().st_size > 5000
    summary = json.loads((results / "summary.json").read_text())
    assert [row["name"] for row in summary["responses"]] == ["BD", "vBz"]
    assert all(row["largest_difference"] > 0 for row in summary["responses"])
    assert len(list((results / "trajectories").glob("*.nc"))) == summary["design"]["runs"] == 7


def test_progress_is_visible(small):
    assert "small: 7 of 7 runs done" in small.output
    assert "(100%) done" in small.output


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
        for words in ("BD.png", "linkage.png", "summary.md", "The arrow marks the largest"):
            assert words in report


def test_the_same_campaign_gives_the_same_numbers(small, workplace):
    done = workplace.snakemake(*SMALL)
    assert done.returncode == 0, done.stdout
    for name in ("samples.nc", "surrogate.nc", "bounds.nc"):
        with (
            xr.open_dataset(small.folder / "results" / "small" / name) as first,
            xr.open_dataset(workplace.folder / "results" / "small" / name) as second,
        ):
            xr.testing.assert_identical(first, second)
    for name in ("nodes.json", "summary.json", "figures/BD.png", "figures/linkage.pdf"):
        first, second = (p.folder / "results" / "small" / name for p in (small, workplace))
        assert first.read_bytes() == second.read_bytes(), name


@pytest.mark.parametrize(
    ("override", "rules"),
    [
        ("error={shade_above: 0.2}", {"envelopes"}),
        ("figures={moments: 4}", {"linkage"}),
        ("published={BD: 0.1}", {"summary"}),
        ("bounds={align: stretch}", ALL_RULES - {"nodes", "simulate", "gather", "linkage"}),
        ("bounds={model: spline}", ALL_RULES - {"nodes", "simulate", "gather", "linkage"}),
        (
            "intervals={a: {nominal: 0.035, relative: 0.02}}",
            ALL_RULES,
        ),
        ("jobs={nodes_per_job: 4}", None),
    ],
)
def test_a_change_runs_only_what_depends_on_it(small, override, rules):
    planned_run = small.snakemake(*SMALL, "--dry-run", "--config", override)
    assert planned_run.returncode == 0, planned_run.stdout
    if rules is None:
        assert "Nothing to be done" in planned_run.stdout
    else:
        assert planned(planned_run.stdout) == rules


def test_runs_that_exist_are_used_by_another_design(workplace):
    config = (workplace.folder / "config" / "small.yaml").read_text()
    config = config.replace("method: tensor_roots, order: 1", "method: tensor_lobatto, order: 1")
    path = workplace.config("nested", config.replace("held_out: 2", "held_out: 0"))
    samples = "results/small/samples.nc"
    assert workplace.snakemake(samples, "--configfile", path).returncode == 0
    again = workplace.snakemake(samples, "--configfile", path, "--config", "design={order: 2}")
    assert again.returncode == 0, again.stdout
    manifests = (workplace.folder / "results" / "small" / "batches").glob("*.json")
    simulated = sum(json.loads(path.read_text())["simulated"] for path in manifests)
    # A 3 x 3 grid with its middle as the nominal run: the 4 corners and the middle are there.
    assert simulated == 4


def test_another_response_simulates_nothing_and_lost_runs_are_told(small, workplace):
    for name in ("results", ".snakemake"):
        shutil.copytree(small.folder / name, workplace.folder / name)
    results = workplace.folder / "results" / "small"
    call = ("results/small/samples.nc", *SMALL, "--config", "responses={psi: {opening: A}}")

    def simulated() -> int:
        manifests = (results / "batches").glob("*.json")
        return sum(json.loads(path.read_text())["simulated"] for path in manifests)

    assert simulated() == 7
    done = workplace.snakemake(*call)
    assert done.returncode == 0, done.stdout
    assert simulated() == 0
    with xr.open_dataset(results / "samples.nc") as samples:
        assert samples["response"].values.tolist() == ["BD", "vBz", "psi"]
        nominal = samples["role"].values.tolist().index("nominal")
        path = results / "trajectories" / f"{samples['run_id'].values[nominal]}.nc"
        with xr.open_dataset(path) as trajectory:
            opening = trajectory["opening"].sel(hinge="A").values
        np.testing.assert_array_equal(samples["values"].values[nominal, 2], opening)

    path.unlink()
    (results / "samples.nc").unlink()
    failed = workplace.snakemake(*call)
    assert failed.returncode != 0
    assert "1 runs are missing" in failed.stdout
    assert "`--forcerun simulate`" in failed.stdout
    done = workplace.snakemake(*call, "--forcerun", "simulate")
    assert done.returncode == 0, done.stdout
    assert simulated() == 1


def test_a_campaign_that_was_stopped_goes_on(workplace):
    # Runs one by one, long enough to be stopped between two of them.
    override = ["--config", "jobs={lanes: 1, nodes_per_job: 100}", "solver={duration: 2.0}"]
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


def test_an_automatic_order_is_found_in_rounds(workplace):
    override = ["--config", "design={method: tensor_lobatto, order: auto, budget: 20}"]
    done = workplace.snakemake(*SMALL, *override)
    assert done.returncode == 0, done.stdout
    results = workplace.folder / "results" / "small"
    summary = json.loads((results / "summary.json").read_text())
    rounds = summary["adaptive"]["rounds"]
    assert len(rounds) > 1
    assert rounds[-1]["runs"] <= 20
    assert rounds[-1]["action"] == "stop"
    assert rounds[-1]["reason"] in (results / "summary.md").read_text()
    assert (results / "figures" / "sensitivities.png").exists()
    assert "Nothing to be done" in workplace.snakemake(*SMALL, *override).stdout


def run_scan(workplace, samples, override):
    """Run config/scan.yaml with a few samples of a coarse, short run; the folder of its results."""
    path = workplace.config(
        "scan",
        (workplace.folder / "config" / "scan.yaml").read_text().replace("10000", str(samples)),
    )
    done = workplace.snakemake(
        "--configfile",
        path,
        "--config",
        "scene={parameters: {elements_per_link: 2}}",
        "solver={duration: 0.01, instants: 21}",
        override,
    )
    assert done.returncode == 0, done.stdout
    return workplace.folder / "results" / "scan"


def test_a_scan_keeps_responses_only(workplace):
    results = run_scan(workplace, 20, "jobs={lanes: 8}")
    assert not (results / "trajectories").exists()
    assert not (results / "figures" / "linkage.png").exists()
    with (
        xr.open_dataset(results / "samples.nc") as samples,
        xr.open_dataset(results / "bounds.nc") as bounds,
    ):
        assert samples.sizes["run"] == 21
        values = samples["values"].values
        np.testing.assert_array_equal(bounds["lower"].values, values.min(axis=0))
        np.testing.assert_array_equal(bounds["upper"].values, values.max(axis=0))


def test_a_spline_goes_through_the_runs_of_a_scan(workplace):
    results = run_scan(workplace, 4, "bounds={model: spline}")
    assert (
        "attained range of a spline through all runs, not enclosed"
        in (results / "summary.md").read_text()
    )
    with (
        xr.open_dataset(results / "samples.nc") as samples,
        xr.open_dataset(results / "bounds.nc") as bounds,
    ):
        assert bounds.attrs["design_runs"] == samples.sizes["run"] == 5
        values = samples["values"].sel(response="vBz").values
        slack = 1e-6 * np.abs(values).max()  # the samples have single precision
        assert (bounds["lower"].sel(response="vBz").values <= values.min(axis=0) + slack).all()
        assert (bounds["upper"].sel(response="vBz").values >= values.max(axis=0) - slack).all()


def test_a_failing_batch_ends_with_a_message_and_keeps_the_others(workplace):
    override = ["--config", "intervals={E: {lower: 1.0e9, upper: 9.0e9}}", "solver={step: 6.0e-5}"]
    done = workplace.snakemake(*SMALL, *override)
    assert done.returncode != 0
    assert "unstable at t = " in done.stdout
    assert "all others were written" in done.stdout
    assert 0 < len(list((workplace.folder / "results/small/trajectories").glob("*.nc"))) < 7
    assert not (workplace.folder / "results" / "small" / "bounds.nc").exists()
