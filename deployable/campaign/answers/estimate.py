"""What a campaign will take, before it runs: runs, time and disk."""

import math
import os
import time
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
    Experiment,
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
from fpm.elements import Contact, Latch, Release
from fpm.reading.margins import read_label, travel_of
from fpm.reading.variables import VARIABLES, words
from fpm.scenes import timestep

Passes = list[tuple[int, float]]
"""Numbers of runs, and the cost of one over a planned one's."""

START, PLAN, BOUNDS, ANSWERS, FIGURES, PAGE = 1.5, 0.2, 0.8, 0.4, 1.0, 1.5
"""Seconds to start, with the config, and of each stage, whatever is asked for."""

FIT, SUBDIVISION, JUMP, SPLINE, DRAWING = 1e-4, 5e-4, 1.5e-3, 3e-5, 1.0
"""Seconds to bound a polynomial at an instant of a response: over up to two intervals; over more,
where the box is subdivided; where velocities jump, more often. Of a spline, for each run; and to
draw a response, by itself and as a panel."""

QUANTITY, RANGE = 0.6, 0.3
"""Seconds to bound a quantity, and to draw it or show it on the page."""

LIMIT, CHOICE = 2.2, 1.2
"""Seconds to find what of the box keeps a limit, and where it decides; to find the best choice of
one parameter by one goal, once, for each goal and limit whose worst case it takes."""

TRIALS = (1.0, 1.7, 3.9)
"""Choices that are tried of one, two, and three or more parameters, over those of one."""

MOTIONS = 3
"""Batches of runs that are made again for the page, on which they move."""

POSITIONS, COARSE_POSITIONS = 60, 5
"""Positions of a travel of margins, as a rule, and of one by which its time is measured."""

SHEETS = 2
"""Travels for the review sheet of a margin: the worst and the nominal one."""

FEW_ROUNDS, MANY_ROUNDS = 2, 5
"""Rounds of an `accuracy` that is met soon, and of one that takes many."""

WRITE = 5e-3
"""Seconds for a run's scene and file."""

TEST_RUNS, TEST = 120, 26.0
"""Runs for a test with measured curves, and seconds to search what it leaves; refuting takes up to
four times as many."""

ITERATIONS, SURFACE = 6, 8
"""Rounds of further runs where quantities jump or cease within the box, as where contacts close or
something is to be chosen, and runs in each about such a surface; else there is one round."""

STRESS = 2e-5
"""Seconds to read the stress of a bar at an instant of a run."""

_BOUNDS_CURVES = 22  # of a response in both bounds, surrogate and sensitivities, compressed


@dataclass(frozen=True)
class Estimate:
    """What one call of `run` takes; `str()` is a sentence for users. runs: most planned runs;
    seconds: likely wall-clock time on all cores, `compile_time` of it for kernels; core_time (s) of
    all runs; bytes: on disk; answers: what adds further runs, in words; longest: of an `accuracy`
    the largest likely wall-clock time, where `seconds` is the smallest, and ceiling: that of its
    whole budget; both None for others."""

    runs: int
    seconds: float
    core_time: float
    bytes: float
    compile_time: float = 0.0
    answers: str = ""
    longest: float | None = None
    ceiling: float | None = None

    def __str__(self) -> str:
        time = f"about {_duration(self.seconds)}"
        if self.longest is not None:
            time = f"likely {_duration(self.seconds)} to {_duration(self.longest)}, "
            time += f"at most {_duration(self.ceiling)},"
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
    Time is accurate to a factor of 1.5, or of two where simulating takes most
    (`fpm.scenes.timestep`). stages: to be done, None for all; missing: fraction of the planned runs
    that are not stored."""
    if campaign.cases:
        parts = [estimate(case, stages, missing) for case in campaign.case_campaigns.values()]
        keys = ("runs", "seconds", "core_time", "bytes")
        totals = {key: sum(getattr(part, key) for part in parts) for key in keys}
        times = [part.compile_time for part in parts]
        totals["seconds"] += max(times) - sum(times)  # kernels are compiled once
        return replace(parts[0], **totals, compile_time=max(times))
    experiment, solver = campaign.experiment, campaign.experiment.solver
    runs, responses = count_runs(experiment), len(experiment.responses)
    cost = _BatchCost(campaign)
    stage_times: dict[str, Any] = _stage_seconds(campaign, cost, math.ceil(missing * runs))
    stage_times = {
        name: times for name, times in stage_times.items() if stages is None or name in stages
    }
    scene = experiment.nominal_scene
    has_runs = not stage_times.keys() <= {"plan", "figures"}
    kinds = fpm.list_kinds_to_compile(scene, experiment.record) if has_runs else []
    compile_time = timestep.compile_seconds(kinds)
    seconds, core_time = np.sum([(START + compile_time, 0.0), *stage_times.values()], axis=0)
    longest = ceiling = None
    if "rounds" in stage_times:
        rest, budget = seconds - stage_times["rounds"][0], 60 * experiment.accuracy.max_core_minutes
        ceiling = rest + budget / (os.cpu_count() or 1)
        seconds = min(seconds, ceiling)
        longest = min(ceiling, rest + cost.sum_passes(_rounds(experiment, MANY_ROUNDS))[0])
        longest = max(seconds, longest)
    size = runs * bytes_of_run(campaign) + 8 * solver.instants * _BOUNDS_CURVES * responses
    answers = "" if experiment.is_adaptive else " and ".join(_refinement_passes(campaign))
    return Estimate(
        runs, float(seconds), float(core_time), float(size), compile_time, answers, longest, ceiling
    )


class _BatchCost:
    """What runs of a campaign cost, as seconds: `batch`, of a core for eight side by side; `sweep`,
    for the travels of a run's margins; `read_time`, for the stress of a run."""

    def __init__(self, campaign: Campaign):
        experiment = campaign.experiment
        self.batch = LANES * timestep.machine() * run_seconds(experiment, choose_step(experiment))
        self.sweep = _sweep_seconds(experiment)
        bars = VARIABLES["stress"].labels(experiment.nominal_scene)[1:]  # beside all together
        labels = [label for variable, label in experiment.record if variable == "stress"]
        count = sum(len(bars) if label not in bars else 1 for label in labels)
        self.read_time = STRESS * experiment.solver.instants * count

    def sum_passes(self, passes: Passes) -> np.ndarray:
        """Wall-clock and core time (s) of passes that wait for each other, each a number of runs
        and the cost of one over a planned one's. A batch is one core's; travels and files are made
        one after another."""
        times = np.zeros(2)
        for count, factor in passes:
            batches = math.ceil(count / LANES)
            rows = -(-batches // (os.cpu_count() or 1))
            times += self.batch * factor * np.array([rows, batches])
            times += (count + 1) * self.sweep  # one while kernels are loaded
            times += count * (self.read_time + np.array([WRITE, 0.0]))
        return times


def _stage_seconds(campaign: Campaign, cost: _BatchCost, missing: int) -> dict[str, np.ndarray]:
    """Wall-clock and core time (s) of each stage. missing: planned runs to be simulated."""
    experiment = campaign.experiment
    responses, quantities = len(experiment.responses), len(experiment.quantities)
    margins = sum(item.kind == "margin" for item in experiment.response_list)
    repeat_count, goals = min(MOTIONS * LANES, 2 * quantities), len(campaign.choose.goals)
    limits = len(list_limits(campaign.requirements, list(experiment.quantities)))
    refinement_passes = list(chain.from_iterable(_refinement_passes(campaign).values()))
    if experiment.is_adaptive:
        refinement_passes = _refinement_passes(campaign).get("the choice", [])
    searches = min(ITERATIONS, campaign.verify.max_iterations) / 2 + 1
    trials = TRIALS[min(len(campaign.choose.parameters), len(TRIALS)) - 1]
    answer_time = QUANTITY * quantities + LIMIT * limits
    answer_time += CHOICE * trials * searches * goals * (goals + limits)
    answer_time += TEST * len(campaign.measured) + SHEETS * margins * cost.sweep
    bounds = BOUNDS + _fit_seconds(campaign)
    motion = MOTIONS * cost.batch + repeat_count * (cost.sweep + cost.read_time)
    times = {
        "plan": (PLAN, 0.0),
        "simulate": cost.sum_passes([(missing, 1.0)]),
        "rounds": FEW_ROUNDS * np.array([bounds, 0.0])
        + cost.sum_passes(_rounds(experiment, FEW_ROUNDS)),
        "bounds": (bounds, 0.0),
        "answers": np.array([ANSWERS + answer_time, 0.0]) + cost.sum_passes(refinement_passes),
        "figures": (FIGURES + DRAWING * responses + RANGE * quantities, 0.0),
        "page": (PAGE + RANGE * (responses + quantities) + motion, 0.0),
    }
    left_out = {"plan", "simulate", "bounds"} if experiment.is_adaptive else {"rounds"}
    return {name: np.array(pair) for name, pair in times.items() if name not in left_out}


def _fit_seconds(campaign: Campaign) -> float:
    """Time (s) to bound all responses at all instants."""
    experiment = campaign.experiment
    scene, curve_values = experiment.nominal_scene, len(experiment.responses)
    curve_values *= experiment.solver.instants
    if experiment.is_adaptive or campaign.bounds.model != "polynomial":
        runs = count_first_runs(experiment) if experiment.is_adaptive else count_runs(experiment)
        return SPLINE * curve_values * runs
    if experiment.design.order is None or experiment.box.free.sum() <= 2:
        return FIT * curve_values
    jumps = any(element.is_exact for k in (Latch, Release) for element in k.find(scene))
    return (JUMP if jumps else SUBDIVISION) * curve_values


def _sweep_seconds(experiment: Experiment) -> float:
    """Time (s) of a run's travels, by some positions of each at the nominal values."""
    paths = {
        read_label(item.columns[0][1])[0]
        for item in experiment.response_list
        if item.kind == "margin"
    }
    if not paths:
        return 0.0
    times = []
    for _ in range(2):  # the first one takes longer
        start = time.thread_time()
        for path in paths:
            travel_of(experiment.nominal_scene, path, COARSE_POSITIONS)
        times.append(time.thread_time() - start)
    return min(times) * POSITIONS / COARSE_POSITIONS


def _rounds(experiment: Experiment, number: int) -> Passes:
    """Runs of an `accuracy` that ends after a number of rounds, each with twice the runs of the one
    before and a check of mesh and step; of all after the first half of them the mesh is finer."""
    first = count_first_runs(experiment)
    passes: Passes = []
    for i in range(number):
        factor = 4.0 if i > number / 2 else 1.0
        runs = min(first * 2**i, experiment.accuracy.max_runs)
        passes += [(runs, factor), (LANES, 2.0 * factor), (LANES, 4.0 * factor)]
    return passes


def _refinement_passes(campaign: Campaign) -> dict[str, Passes]:
    """Return the rounds of further runs by their purpose, each with their number and their time
    relative to a planned run."""
    experiment, verify = campaign.experiment, campaign.verify
    bounds = 2 * len(experiment.quantities)
    iterations = min(ITERATIONS, verify.max_iterations)
    refinement: dict[str, Passes] = {}
    has_surface = campaign.choose.parameters or Contact.find(experiment.nominal_scene)
    if bounds and has_surface:
        refinement["quantities"] = [(bounds + SURFACE, 1.0)] * iterations
    elif bounds:
        refinement["quantities"] = [(bounds, 1.0)] * min(1, iterations)
    if campaign.measured:
        refinement["measured curves"] = [(TEST_RUNS, 1.0)] * len(campaign.measured)
    if campaign.choose.parameters:
        points = design_points(widen_intervals(experiment, campaign.choose), campaign.choose)
        refinement["the choice"] = [(len(points), 1.0), *[(LANES, 1.0)] * iterations]
    if verify.discretization:
        # Half the step, and a mesh of twice as many elements with half the step; for their orders
        # at fewer places a quarter of the step, and half as many elements with half the step.
        repetitions = [(CHECK_POINTS, 1), *([(bounds, bounds // 2)] if bounds else [])]
        refinement["errors of step and mesh"] = [
            (count, factor)
            for larger, smaller in repetitions
            for count, factor in ((larger, 2.0), (smaller, 4.0), (larger, 4.0), (smaller, 1.0))
        ]
    return refinement


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
