"""The best choice of nominal values, judged by the worst case about each, `choice.json`.

    parameters   [{name, units, lower, upper, value, decides}]: the range, the best choice, and
                 whether choices that differ in it differ in what decides by more than the error
    kept         whether the whole box about the choice keeps all requirements
    goals        [{end, quantity, units, sense, value, at, simulated}] of the choice; of a width
                 `at` is where the upper end is, `lower_at` where the lower, `simulated` the width
    limits       [{requirement, quantity, units, kind, level, margin, at, simulated}] of the choice
    tried        [{values, goals, kept}]: choices of a grid, for the trade-off
    runs         how many runs it took, over choices and intervals
    simulated    how many of them were simulated in the last call

The runs are those of a sparse grid over the choices and the box about each. Two goals trade off.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import SAME, Bench, number
from deployable.campaign.answers.limits import Asked, limits_of, told
from deployable.campaign.config.sections import Choose, Experiment, Interval, Jobs, Verify
from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import Plan, choose_step, read_plan
from deployable.campaign.plan.runs import Runs
from deployable.campaign.results.facts import ROUNDING
from deployable.campaign.runs.progress import Tell
from deployable.campaign.text.words import words_of

_HELD_OUT, _DOUBTS = 4, 4


def answer(
    folder: Folder,
    choose: Choose,
    requirements: Mapping[str, Mapping],
    verify: Verify,
    jobs: Jobs,
    tell: Tell,
    threads: int,
) -> None:
    """Write choice.json of a planned campaign."""
    asked = read_plan(folder.plan)
    experiment = widened(asked.experiment, choose)
    plan = Plan(experiment, asked.mechanics, choose_step(experiment), Runs.of([]))
    bench = Bench(plan, jobs, folder, tell, threads)
    points = design_points(experiment, choose)
    tell(f"{experiment.name}: {len(points)} runs over choices and intervals")
    bench.add(points)
    limits = limits_of(requirements, list(experiment.quantities))
    for turn in range(verify.max_iterations + 1):
        best, tried = _best(bench, asked.experiment, choose, limits)
        places = [*np.concatenate(best.goal_points), *best.worst, *doubted(best, tried, choose)]
        places = [at for at in places if bench.nearest(at)[1] > SAME]
        if turn == verify.max_iterations or not places:
            break
        bench.add(places)
    error = _error(bench, asked.experiment, choose, limits, best.is_allowed)
    found = {
        "parameters": _parameters(experiment, choose, best.values, deciding(tried, error)),
        "kept": best.is_allowed,
        "goals": list(map(partial(_goal, bench), choose.goals, best.goals, best.goal_points)),
        "limits": list(map(partial(_limit, bench), limits, best.slacks, best.worst)),
        "tried": [
            {
                "values": one.values.tolist(),
                "goals": [number(value) for value in one.goals],
                "kept": one.is_allowed,
            }
            for one in tried
        ],
        "runs": len(bench.unit),
        "simulated": bench.simulated,
    }
    write_result(folder.choice, json.dumps(found, indent=1, allow_nan=False) + "\n")


def doubted(best: Any, tried: Sequence[Any], choose: Choose) -> list[np.ndarray]:
    """Places (k) for which choices near the best one were turned down that would be better: where
    something is taken not to happen, or to happen."""
    sign = choose.goals[0][0]
    better = [
        one for one in tried if not one.is_allowed and sign * (one.goals[0] - best.goals[0]) < 0
    ]
    ends = np.array(list(choose.parameters.values()), dtype=float)
    widths = np.maximum(np.ptp(ends, axis=1), np.finfo(float).tiny)
    better.sort(key=lambda one: float(np.abs((one.values - best.values) / widths).max()))
    return [
        at
        for one in better[:_DOUBTS]
        for slack, at in zip(one.slacks, one.worst, strict=True)
        if slack == -np.inf
    ]


def widened(experiment: Experiment, choose: Choose) -> Experiment:
    """The experiment over all choices and the intervals about them."""
    intervals = dict(experiment.intervals)
    for name in choose.parameters:
        lower, upper = choose.ends(name, experiment)
        intervals[name] = Interval(lower, (lower + upper) / 2, upper)
    return replace(experiment, intervals=intervals)


def design_points(experiment: Experiment, choose: Choose) -> np.ndarray:
    """Unit points (N, k) of the runs: a sparse grid, and a few runs that test it."""
    from deployable.intervals import held_out_points, make_design

    order, box = experiment.design.order, experiment.box
    if isinstance(order, tuple):
        order = max(order)
    usual = max(order, 2) if isinstance(order, int) else 2
    orders = [choose.order if name in choose.parameters else usual for name in box.names]
    orders = [order if free else 0 for order, free in zip(orders, box.free, strict=True)]
    nodes = make_design("smolyak", box, orders).points
    return np.concatenate([nodes, held_out_points(box.free, _HELD_OUT, nodes)])


def _best(bench: Bench, experiment: Experiment, choose: Choose, asked: list[Asked]) -> Any:
    """The best choice, and those that were tried (`intervals.scalars.Choice`)."""
    from deployable.intervals.scalars import Goal, Limit, best_choice

    surrogates, box = [s.trend for s in bench.surrogates()], bench.experiment.box
    names = list(bench.experiment.quantities)
    goals = [Goal(surrogates[names.index(q)], end, sign) for sign, end, q in choose.goals]
    limits = [Limit(surrogates[one.quantity], one.kind, one.level) for one in asked]

    def part(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        ends = {name: (i.lower, i.upper) for name, i in bench.experiment.intervals.items()}
        for name, value in zip(choose.parameters, values, strict=True):
            ends[name] = choose.interval(name, float(value), experiment)
        lower, upper = box.to_unit(np.array([sorted(ends[name]) for name in box.names]).T)
        return np.clip(lower, -1.0, 1.0), np.clip(upper, -1.0, 1.0)

    return best_choice(goals, limits, list(choose.parameters.values()), part)


def _error(
    bench: Bench, experiment: Experiment, choose: Choose, limits: list[Asked], is_allowed: bool
) -> float:
    """By how much choices may differ and be alike: the error of what decides, and rounding. That is
    the first goal, or where no choice is allowed the limits."""
    names, surrogates = list(experiment.quantities), bench.surrogates()
    chosen = [names.index(choose.goals[0][2])] if is_allowed else [one.quantity for one in limits]
    errors = [surrogates[q].error for q in chosen]
    size = np.nanmax(np.abs(bench.numbers[:, chosen]), initial=0.0)
    return max([ROUNDING * size, *(error for error in errors if np.isfinite(error))])


def deciding(tried: Sequence[Any], error: float) -> list[bool]:
    """Of each chosen parameter, whether tried choices that differ in it alone differ by more than
    an error in what decides: the first goal where it is allowed, or if no choice is the slack."""
    allowed = [one.is_allowed for one in tried]
    worth = np.array([
        one.slack if not any(allowed) else one.goals[0] if one.is_allowed else np.inf
        for one in tried
    ])  # fmt: skip
    worth = np.nan_to_num(worth, nan=np.inf)
    values = np.array([one.values for one in tried])

    def differ(rows: np.ndarray) -> bool:
        low, high = worth[rows].min(), worth[rows].max()
        return bool(low != high and not high - low <= error)

    found = []
    for j in range(values.shape[1]):
        _, group = np.unique(np.delete(values, j, axis=1), axis=0, return_inverse=True)
        alone = [np.flatnonzero(group.ravel() == g) for g in range(group.max() + 1)]
        lines = [rows for rows in alone if len(rows) > 1]
        found.append(any(map(differ, lines or [np.arange(len(tried))])))
    return found


def _parameters(
    experiment: Experiment, choose: Choose, values: np.ndarray, decides: Sequence[bool]
) -> list[dict]:
    known = experiment.scene_type.parameters
    return [
        {"name": name, "units": known[name].unit, "lower": low, "upper": high, "value": float(v),
         "decides": own}
        for (name, (low, high)), v, own in zip(
            choose.parameters.items(), values, decides, strict=True)
    ]  # fmt: skip


def _goal(bench: Bench, goal: tuple[float, str, str], value: float, at: np.ndarray) -> dict:
    sign, end, name = goal
    q = list(bench.experiment.quantities).index(name)
    asked = bench.experiment.numbers[q]
    named = {"end": end, "quantity": name, "units": asked.unit, **words_of(asked)}
    named |= {"sense": "minimise" if sign > 0 else "maximise", "value": number(value)}
    *low, place = (bench.place(one, q) for one in at)
    if low:
        place["lower_at"] = low[0]["at"]
        both = place["simulated"], low[0]["simulated"]
        place["simulated"] = None if None in both else both[0] - both[1]
    return {**named, **place}


def _limit(bench: Bench, asked: Asked, slack: float, at: np.ndarray) -> dict:
    margin = {"margin": number(slack), "kept": bool(slack >= 0)}
    named = {"requirement": asked.requirement, **told(bench, asked)}
    return {**named, **margin, **bench.place(at, asked.quantity)}
