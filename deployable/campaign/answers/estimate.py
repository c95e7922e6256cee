"""What a campaign will take, before it runs: runs, time and disk."""

import math
import os
from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import numpy as np

import fpm
from deployable.campaign.answers.limits import list_limits
from deployable.campaign.config.sections import (
    CHECK_POINTS,
    Campaign,
    bytes_of_run,
    count_first_runs,
    count_runs,
    design_points,
    widen_intervals,
)
from deployable.campaign.plan.jobs import LANES, run_seconds
from deployable.campaign.plan.plan import choose_step, make_plan, read_plan
from deployable.campaign.runs.results import groups_of
from deployable.campaign.runs.store import open_store
from deployable.campaign.text.numbers import duration_text, size_text
from fpm.elements import Contact
from fpm.reading.variables import VARIABLES, words
from fpm.scenes import timestep

START = 1.5
STAGES = {"plan": 0.2, "rounds": 1.6, "bounds": 0.8, "answers": 0.4, "figures": 1.0, "page": 1.5}
"""Seconds to start, with the config, and of each stage, whatever is asked for."""

FIT, SUBDIVISION, SPLINE, DRAWING = 1e-4, 5e-4, 3e-5, 1.0
"""Seconds to bound a polynomial at an instant of a response: over up to two intervals, and over
more; to bound a spline there, for each run; and to draw a response."""

QUANTITY, RANGE, LIMIT, CHOICE = 0.6, 0.3, 2.2, 1.2
"""Seconds to bound a quantity; to draw it, or show it on the page; to find what of the box keeps a
limit; to find the best choice of one parameter, for each goal and limit."""

TRAVEL = 0.1
"""Seconds for the travel of a margin."""

MOTIONS, ROUNDS = 3, 2
"""Batches of runs that the page makes again; rounds of an `accuracy` that is met soon."""

WRITE, STRESS = 5e-3, 2e-5
"""Seconds for a run's scene and file, and to read the stress of a bar at an instant."""

TEST_RUNS, TEST = 120, 26.0
"""Runs for a test with measured curves (up to four times as many to refute), seconds to search."""

ITERATIONS, SURFACE = 6, 8
"""Rounds of further runs where quantities jump or cease within the box, as where contacts close or
something is to be chosen, and runs in each about such a surface; else there is one round."""

_BOUNDS_CURVES = 22  # of a response in both bounds, surrogate and sensitivities, compressed

Passes = list[tuple[int, float]]
"""Numbers of runs, and the cost of one over a planned one's, that wait for each other."""


@dataclass(frozen=True)
class Estimate:
    """What one call of `run` takes; `str()` is a sentence for users. runs: most planned runs;
    seconds: likely wall-clock time on all cores, `compile_time` of it for kernels; core_time (s) of
    all runs; bytes: on disk; answers: what adds further runs, in words; ceiling: of an `accuracy`
    the time of its whole budget, else None."""

    runs: int
    seconds: float
    core_time: float
    bytes: float
    compile_time: float = 0.0
    answers: str = ""
    ceiling: float | None = None

    def __str__(self) -> str:
        time = f"about {_duration(self.seconds)}"
        if self.ceiling is not None:
            time += f", at most {_duration(self.ceiling)},"
        extra_runs = f" and further ones for {self.answers}" if self.answers else ""
        first = _duration(self.compile_time)
        return (
            f"at most {self.runs} runs{extra_runs}, {time} on {os.cpu_count() or 1} cores"
            f"{f' ({first} of it to compile, once)' if self.compile_time else ''}, "
            f"{size_text(self.bytes)} on disk"
        )


def estimate(
    campaign: Campaign, stages: Collection[str] | None = None, missing: float = 1.0
) -> Estimate:
    """Estimate runs, time and disk of one call of `run` for a campaign, all its cases and its page.
    Time is accurate to a factor of two. stages: to be done, None for all; missing: fraction of the
    planned runs that are not stored."""
    if campaign.cases:
        parts = [estimate(case, stages, missing) for case in campaign.case_campaigns.values()]
        keys = ("runs", "seconds", "core_time", "bytes")
        totals = {key: sum(getattr(part, key) for part in parts) for key in keys}
        times = [part.compile_time for part in parts]
        totals["seconds"] += max(times) - sum(times)  # kernels are compiled once
        return replace(parts[0], **totals, compile_time=max(times))
    experiment = campaign.experiment
    runs, is_adaptive = count_runs(experiment), experiment.is_adaptive
    further_runs = _further_passes(campaign)
    seconds_by_stage = _stage_seconds(campaign)
    passes: dict[str, Any] = {"page": [(MOTIONS * LANES, 1.0)]}
    if is_adaptive:
        # Each round has twice the runs of the one before and a check of mesh and step; after the
        # first half of them the mesh is finer.
        sizes = [min(count_first_runs(experiment) * 2**i, runs) for i in range(ROUNDS)]
        factors = [4.0 if i > ROUNDS / 2 else 1.0 for i in range(ROUNDS)]
        passes["rounds"] = [
            entry for size, factor in zip(sizes, factors, strict=True)
            for entry in ((size, factor), (LANES, 2.0 * factor), (LANES, 4.0 * factor))
        ]  # fmt: skip
        passes["answers"] = further_runs.get("the choice", [])
        left_out = {"plan", "simulate", "bounds"}
    else:
        passes["simulate"] = [(math.ceil(missing * runs), 1.0)]
        passes["answers"] = list(chain.from_iterable(further_runs.values()))
        left_out = {"rounds"}
    names = [name for name in (*STAGES, "simulate") if name not in left_out]
    names = [name for name in names if stages is None or name in stages]
    kinds = fpm.list_kinds_to_compile(experiment.nominal_scene, experiment.record)
    compile_time = timestep.compile_seconds(kinds if {*names} - {"plan", "figures"} else [])
    wall, core = _pass_seconds(campaign, [x for name in names for x in passes.get(name, [])])
    overhead = START + compile_time + sum(seconds_by_stage.get(name, 0.0) for name in names)
    seconds, ceiling = overhead + float(wall), None
    if "rounds" in names:
        ceiling = overhead + 60 * experiment.accuracy.max_core_minutes / (os.cpu_count() or 1)
        seconds = min(seconds, ceiling)
    curves = experiment.solver.instants * len(experiment.responses)
    size = runs * bytes_of_run(campaign) + 8 * _BOUNDS_CURVES * curves
    answers = "" if is_adaptive else " and ".join(further_runs)
    return Estimate(runs, seconds, float(core), float(size), compile_time, answers, ceiling)


def _pass_seconds(campaign: Campaign, passes: Passes) -> np.ndarray:
    """Wall-clock and core time (s) of passes. A batch of eight runs is one core's; travels of
    margins and files are made one after another."""
    experiment, times = campaign.experiment, np.zeros(2)
    batch = LANES * timestep.machine() * run_seconds(experiment, choose_step(experiment))
    bars = VARIABLES["stress"].labels(experiment.nominal_scene)[1:]  # beside all together
    labels = [label for variable, label in experiment.record if variable == "stress"]
    count = sum(len(bars) if label not in bars else 1 for label in labels)
    margins = sum(response.kind == "margin" for response in experiment.response_list)
    read_time = TRAVEL * margins + STRESS * experiment.solver.instants * count
    for count, factor in passes:
        batches = math.ceil(count / LANES)
        rows = -(-batches // (os.cpu_count() or 1))
        times += batch * factor * np.array([rows, batches])
        times += count * (read_time + np.array([WRITE, 0.0]))
    return times


def _stage_seconds(campaign: Campaign) -> dict[str, float]:
    """Wall-clock time (s) of each stage beside its runs."""
    experiment, choose = campaign.experiment, campaign.choose
    responses, quantities = len(experiment.responses), len(experiment.quantities)
    limits = len(list_limits(campaign.requirements, list(experiment.quantities)))
    searches = min(ITERATIONS, campaign.verify.max_iterations) / 2 + 1
    goals = len(choose.goals)
    curves = responses * experiment.solver.instants
    fit = (FIT if experiment.box.free.sum() <= 2 else SUBDIVISION) * curves
    if experiment.is_adaptive or campaign.bounds.model != "polynomial":
        runs = count_first_runs(experiment) if experiment.is_adaptive else count_runs(experiment)
        fit = SPLINE * curves * runs
    times = dict(STAGES)
    times["rounds"] += ROUNDS * fit
    times["bounds"] += fit
    times["answers"] += QUANTITY * quantities + LIMIT * limits + TEST * len(campaign.measured)
    times["answers"] += CHOICE * len(choose.parameters) * searches * (goals + limits)
    times["figures"] += DRAWING * responses + RANGE * quantities
    times["page"] += RANGE * (responses + quantities)
    return times


def _further_passes(campaign: Campaign) -> dict[str, Passes]:
    """Return the rounds of further runs by their purpose."""
    experiment, verify = campaign.experiment, campaign.verify
    bounds = 2 * len(experiment.quantities)
    iterations = min(ITERATIONS, verify.max_iterations)
    passes: dict[str, Passes] = {}
    has_surface = campaign.choose.parameters or Contact.find(experiment.nominal_scene)
    if bounds and has_surface:
        passes["quantities"] = [(bounds + SURFACE, 1.0)] * iterations
    elif bounds:
        passes["quantities"] = [(bounds, 1.0)] * min(1, iterations)
    if campaign.measured:
        passes["measured curves"] = [(TEST_RUNS, 1.0)] * len(campaign.measured)
    if campaign.choose.parameters:
        points = design_points(widen_intervals(experiment, campaign.choose), campaign.choose)
        passes["the choice"] = [(len(points), 1.0), *[(LANES, 1.0)] * iterations]
    if verify.discretization:
        # Half the step, and a mesh of twice as many elements with half the step; for their orders
        # at fewer places a quarter of the step, and half as many elements with half the step.
        repetitions = [(CHECK_POINTS, 1), *([(bounds, bounds // 2)] if bounds else [])]
        passes["errors of step and mesh"] = [
            (count, factor)
            for larger, smaller in repetitions
            for count, factor in ((larger, 2.0), (smaller, 4.0), (larger, 4.0), (smaller, 1.0))
        ]
    return passes


def describe_work(workflow: Any, figures: bool = True) -> str:
    """Text for users on what one call of `run` takes for a `Workflow` of one campaign: all, or what
    is left. figures: whether it draws."""
    campaign, folder, notes, share = workflow.campaign, workflow.folder, "", 1.0
    if not campaign.experiment.is_adaptive and folder.runs(campaign.jobs.keep).is_dir():
        is_planned = "plan" not in workflow.list_stages(False, figures)
        plan = read_plan(folder.plan) if is_planned else make_plan(campaign.experiment)
        keep = campaign.jobs.keep
        store = open_store(keep, folder.runs(keep), campaign.experiment)
        groups = groups_of(plan.unique_runs, campaign.jobs.group)
        missing, total = (sum(map(len, x)) for x in (map(store.missing, groups), groups))
        share, lacks = missing / total, set().union(*store.absences.values())
        if lacks or missing < total:
            notes = f"; {total - missing} of them are there"
        if lacks:
            notes += f", others lack {words(sorted(lacks))}"
    is_incomplete = not campaign.experiment.is_adaptive and share > 0
    stages = workflow.list_stages(is_incomplete, figures)
    if folder.plan.exists() and {"plan", "rounds"} & {*stages}:
        notes += f"; what {folder.path} holds is of another config or version, and is replaced"
    if not stages:
        return f"{campaign.name}, nothing to be done: the results are in {folder.path}"
    return f"{campaign.name}, {estimate(campaign, stages, share)}{notes}"


def _duration(seconds: Any) -> str:
    """Write a time with two digits."""
    power = 10.0 ** (math.floor(math.log10(max(seconds, 1.0))) - 1)
    return duration_text(max(1.0, round(seconds / power) * power))
