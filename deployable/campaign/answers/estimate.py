"""What a campaign will take, before it runs: runs, time and disk."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace

import fpm
from deployable.campaign.answers.choice import design_points, widen_intervals
from deployable.campaign.answers.discretization import MAX_POINTS
from deployable.campaign.config.disk import bytes_of_run
from deployable.campaign.config.sections import Campaign, count_runs
from deployable.campaign.folder import Folder
from deployable.campaign.plan.jobs import LANES, run_seconds
from deployable.campaign.plan.plan import choose_step, make_plan
from deployable.campaign.runs.extremes import LARGE, MOST
from deployable.campaign.runs.store import open_store
from deployable.campaign.text.numbers import duration_text, size_text
from fpm.reading.variables import words
from fpm.scenes import effort

START, RESPONSE, QUANTITY = 4.0, 1.0, 0.6
"""Seconds to start and write the page, to bound and draw a response, and a quantity."""

REQUIREMENTS, CHOICE = 2.0, 7.0
"""Seconds to find what of the box meets requirements, and the best choice, by surrogate."""

MOTIONS = 3
"""Batches of runs that are made again for the page, on which they move."""

WRITE = 5e-3
"""Seconds for a run's scene and file."""

TEST_RUNS, TEST = 120, 20.0
"""Runs for a test with measured curves, and seconds to search what it leaves; refuting takes up to
four times as many."""

ITERATIONS = 2
"""Rounds of further runs that quantities take as a rule, where so many are allowed."""

_BOUNDS_CURVES = 12  # of a response in bounds, surrogate and sensitivities, compressed
_SHARE_CURVES = 4  # of a response in the file of a share of a scan


@dataclass(frozen=True)
class Estimate:
    """What one call of `run` for a campaign takes, estimated before; `str()` is a sentence for
    users. runs: largest possible number of planned runs, further ones at bounds and limit-state
    surfaces not counted; seconds: wall-clock time on all cores, `compile_time` (s) of it to compile
    kernels; core_time: core time (s) of all runs; bytes: on disk; is_budget: whether seconds are
    a limit set by the config, mostly far more than will be used; answers: what adds further runs,
    in words, such as "quantities"."""

    runs: int
    seconds: float
    core_time: float
    bytes: float
    compile_time: float = 0.0
    is_budget: bool = False
    answers: str = ""

    def __str__(self) -> str:
        bound = "at most" if self.is_budget else "about"
        further = f" and further ones for {self.answers}" if self.answers else ""
        first = f" ({duration_text(_round(self.compile_time))} of it to compile, once)"
        return (
            f"at most {self.runs} runs{further}, {bound} {duration_text(_round(self.seconds))} "
            f"on {count_cores()} cores{first if self.compile_time else ''}, "
            f"{size_text(self.bytes)} on disk"
        )


def estimate(campaign: Campaign) -> Estimate:
    """Estimate runs, time and disk of one call of `run` for a campaign, with its page. The time is
    accurate to a factor of 1.5, or of about two where simulating takes most of it
    (`fpm.scenes.effort`). With cases it is of all of them, one after another."""
    if campaign.cases:
        return _sum([estimate(case) for case in campaign.case_campaigns.values()])
    experiment, solver = campaign.experiment, campaign.experiment.solver
    runs = count_runs(experiment)
    batch = LANES * effort.machine() * run_seconds(experiment, choose_step(experiment))
    refinement = {} if experiment.is_adaptive else _refinement_passes(campaign)
    passes = [(runs, 1.0), *(p for iterations in refinement.values() for p in iterations)]
    batches = [(math.ceil(count / LANES), factor) for count, factor in passes if count]
    core_time = batch * sum(number * factor for number, factor in batches)
    # A batch is one core's; rounds wait for each other.
    run_time = batch * sum(math.ceil(number / count_cores()) * factor for number, factor in batches)
    write_time = WRITE * sum(count for count, _ in passes) / count_cores()
    scene = experiment.nominal_scene
    compile_time = 0.0 if fpm.is_compiled(scene) else effort.compile_seconds(scene)
    overhead = START + compile_time + MOTIONS * batch
    overhead += RESPONSE * len(experiment.responses) + QUANTITY * len(experiment.quantities)
    overhead += REQUIREMENTS * bool(campaign.requirements) + CHOICE * bool(
        campaign.choose.parameters
    )
    seconds = run_time + write_time + overhead + TEST * len(campaign.measured)
    if experiment.is_adaptive:  # meshes and steps become finer
        core_time = 60 * experiment.accuracy.max_core_minutes
        seconds = core_time / count_cores() + overhead
    curves = _BOUNDS_CURVES * len(experiment.responses)
    if campaign.jobs.keep == "extremes":
        curves += _SHARE_CURVES * min(MOST, math.ceil(runs / LARGE)) * len(experiment.responses)
    size = runs * bytes_of_run(campaign) + 8 * solver.instants * curves
    answers = " and ".join(refinement)
    return Estimate(
        runs, seconds, core_time, float(size), compile_time, experiment.is_adaptive, answers
    )


def _sum(parts: list[Estimate]) -> Estimate:
    """What campaigns take one after another; kernels are compiled once."""
    keys = ("runs", "seconds", "integrating", "bytes")
    totals = {key: sum(getattr(part, key) for part in parts) for key in keys}
    compile_time = max(part.compile_time for part in parts)
    totals["seconds"] += compile_time - sum(part.compile_time for part in parts)
    return replace(parts[0], **totals, compile_time=compile_time)


def _refinement_passes(campaign: Campaign) -> dict[str, list[tuple[int, float]]]:
    """By what takes further runs, for each round their number and time over a planned one's."""
    experiment, verify = campaign.experiment, campaign.verify
    bounds = 2 * len(experiment.quantities)
    iterations = min(ITERATIONS, verify.max_iterations)
    refinement: dict[str, list[tuple[int, float]]] = {}
    if bounds:
        refinement["quantities"] = [(bounds, 1.0)] * iterations
    if campaign.measured:
        refinement["measured curves"] = [(TEST_RUNS, 1.0)] * len(campaign.measured)
    if campaign.choose.parameters:
        points = design_points(widen_intervals(experiment, campaign.choose), campaign.choose)
        refinement["the choice"] = [(len(points), 1.0), *[(LANES, 1.0)] * iterations]
    if verify.discretization:
        # Half the step, and a mesh of twice as many elements with half the step; for their orders
        # at fewer places a quarter of the step, and half as many elements with half the step.
        repetitions = [(MAX_POINTS, 1), *([(bounds, bounds // 2)] if bounds else [])]
        refinement["errors of step and mesh"] = [
            (count, factor)
            for larger, smaller in repetitions
            for count, factor in ((larger, 2.0), (smaller, 4.0), (larger, 4.0), (smaller, 1.0))
        ]
    return refinement


def describe_stored_runs(campaign: Campaign, folder: Folder) -> str:
    """Return a text for users on how many runs of a campaign are stored in its folder of results,
    and why others must be made again; "" where none is stored, and with an `accuracy`."""
    keep = campaign.jobs.keep
    if campaign.experiment.is_adaptive or not folder.runs(keep).is_dir():
        return ""
    plan = make_plan(campaign.experiment)
    store = open_store(keep, folder.runs(keep), campaign.experiment)
    groups = store.groups(plan.unique_runs(), campaign.jobs.group)
    missing = sum(len(store.missing(group)) for group in groups)
    total, reruns = sum(map(len, groups)), len(store.absences)
    if missing - reruns == total:
        return ""
    text = f"{total - missing} of them are there"
    if reruns:
        names = words(sorted(set().union(*store.absences.values())))
        seconds = _round(estimate(campaign).seconds * missing / total)
        text += (
            f"; {reruns} more lack {names} as this version reads it and are simulated again, all "
            f"in all about {duration_text(seconds)}"
        )
    return text


def count_cores() -> int:
    """Return the number of processor cores of this machine, 1 if it is unknown."""
    return os.cpu_count() or 1


def _round(seconds: float) -> float:
    """To two digits."""
    power = 10.0 ** (math.floor(math.log10(max(seconds, 1.0))) - 1)
    return max(1.0, round(seconds / power) * power)
