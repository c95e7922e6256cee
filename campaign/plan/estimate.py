"""What a campaign will take, before it runs: runs, time, disk."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

from campaign.config.design import count_runs
from campaign.config.sections import Campaign, Experiment
from campaign.folder import Folder
from campaign.plan.make import choose_step
from campaign.plan.plan import TimeStep
from campaign.runs.extremes import LARGE, MOST
from campaign.runs.progress import duration_text

ELEMENT_STEP = 10e-9
"""Seconds of a core for a step of an element in one of eight runs side by side: what the Bennett
linkage takes with its hinges (docs/benchmark.md has 7.9 ns without writing)."""

LANES = 8
"""Runs that are integrated side by side; fewer take as long."""

STARTING = 4.0
"""Seconds to start, take bounds, draw and write the page."""

_OTHER_CURVES = 10  # of a trajectory, beside points and hinges: time, gaps, energies
_BOUNDS_CURVES = 12  # of a response in bounds, surrogate and sensitivities, compressed
_SHARE_CURVES = 4  # of a response in the file of a share of a scan
_EVENTS_BYTES = 40  # of a run's impacts, compressed: some ten


@dataclass(frozen=True)
class Estimate:
    """runs: at most; seconds on all cores of this machine, compilation apart; bytes on disk.

    is_budget: they are what may be spent, mostly far more than what will be.
    """

    runs: int
    seconds: float
    bytes: float
    is_budget: bool = False

    def __str__(self) -> str:
        about = "at most" if self.is_budget else "about"
        return (
            f"at most {self.runs} runs, {about} {duration_text(_rounded(self.seconds))} on "
            f"{cores()} cores, {size_text(self.bytes)} on disk"
        )


def estimate(campaign: Campaign) -> Estimate:
    """What a campaign takes; time is right to a factor of two or so on a recent core."""
    experiment, solver = campaign.experiment, campaign.experiment.solver
    runs = count_runs(experiment)
    whole = math.ceil(runs / LANES) * LANES
    seconds = whole * run_seconds(experiment, choose_step(experiment)) / cores() + STARTING
    if experiment.is_sought:  # meshes and steps become finer
        seconds = 60 * experiment.accuracy.minutes / cores() + STARTING
    curves = _BOUNDS_CURVES * len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        curves += _SHARE_CURVES * min(MOST, math.ceil(runs / LARGE)) * len(experiment.responses)
    size = runs * bytes_of_run(campaign) + 8 * solver.instants * curves
    return Estimate(runs, seconds, float(size), experiment.is_sought)


def bytes_of_run(campaign: Campaign) -> float:
    """Bytes that a run takes on disk, about, in its own file and in samples.nc."""
    experiment = campaign.experiment
    instants, responses = experiment.solver.instants, len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        numbers = 2 * len(experiment.quantities) + 2 * len(experiment.intervals)
        return 8.0 * numbers + 2 * _EVENTS_BYTES
    if campaign.jobs.keep == "responses":
        return 8.0 * instants * responses
    scene = experiment.build(dict(zip(experiment.box.names, experiment.nominal, strict=True)))
    curves = 6 * len(scene.points) + len(scene.hinges) + _OTHER_CURVES
    return 8.0 * instants * (curves + responses + len(experiment.asked))


def found(campaign: Campaign, folder: Folder) -> str:
    """Which of a campaign's runs are there, and why others must be made again; nothing where none
    is there, and for `order: auto`, whose runs are not known beforehand."""
    from campaign.plan.make import make_plan
    from campaign.runs.store import open_store
    from fpm.asked import words

    keep = campaign.jobs.keep
    if campaign.is_adaptive or not folder.runs(keep).is_dir():
        return ""
    plan = make_plan(campaign.experiment)
    store = open_store(keep, folder.runs(keep), campaign.experiment)
    groups = store.groups(plan.unique_runs(), campaign.jobs.group)
    missing = sum(len(store.missing(group)) for group in groups)
    total, lacking = sum(map(len, groups)), len(store.lacking)
    if missing - lacking == total:
        return ""
    text = f"{total - missing} of them are there"
    if lacking:
        what = words(sorted(set().union(*store.lacking.values())))
        seconds = _rounded(estimate(campaign).seconds * missing / total)
        text += (
            f"; {lacking} more were recorded without {what} and are simulated again, all in all "
            f"about {duration_text(seconds)}"
        )
    return text


def run_seconds(experiment: Experiment, time: TimeStep) -> float:
    """Seconds of a core for a run, one of eight side by side."""
    scene = experiment.build(dict(zip(experiment.box.names, experiment.nominal, strict=True)))
    steps = time.steps_per_instant * (experiment.solver.instants - 1)
    return steps * max(len(scene.elements), 1) * ELEMENT_STEP


def cores() -> int:
    """Cores of this machine."""
    return os.cpu_count() or 1


def size_text(size: float) -> str:
    """A number of bytes as people write it: `5.5 MB`."""
    for unit in ("kB", "MB"):
        size /= 1000
        if size < 1000:
            return f"{size:.2g} {unit}" if size < 10 else f"{size:.0f} {unit}"
    return f"{size / 1000:.3g} GB"


def _rounded(seconds: float) -> float:
    """To two digits."""
    power = 10.0 ** (math.floor(math.log10(max(seconds, 1.0))) - 1)
    return max(1.0, round(seconds / power) * power)
