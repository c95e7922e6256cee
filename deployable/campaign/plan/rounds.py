"""`order: auto`: rounds of runs until the error meets a tolerance or the budget is spent.

Each round has a plan (`rounds/<round>/nodes.json`) that knows the finished rounds. What comes next
is decided by `intervals.decide`; here results become its arguments and its decision a plan.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from deployable.campaign.config.design import make_design, start_of
from deployable.campaign.config.sections import DesignChoice, Experiment
from deployable.campaign.plan.make import make_plan
from deployable.campaign.plan.plan import Plan, Round, Rounds


def first_plan(experiment: Experiment) -> Plan:
    """The plan of round 0 of an experiment with `order: auto`."""
    return _plan(start_of(experiment), (), ())


def next_plan(
    experiment: Experiment, plan: Plan, samples_path: str | Path, bounds_path: str | Path
) -> Plan:
    """The plan after a finished round: a better design, or the same with the reason to stop."""
    from deployable import intervals
    from deployable.campaign.files import open_dataset

    asked, design, before = experiment.design, plan.experiment.design, plan.adaptive
    with open_dataset(samples_path) as samples, open_dataset(bounds_path) as bounds:
        made = make_design(design, experiment.box)
        error, tails = intervals.measure_round(samples, bounds, made)
    decision = intervals.decide(
        intervals.Progress(
            specification=intervals.Specification(design.method, design.order, design.parts),
            error=error,
            tails=tails,
            points=np.array(before.points),
            tolerance=asked.tolerance,
            budget=asked.budget,
            history=[r.error for r in before.rounds if r.parts == design.parts],
            free=experiment.box.free.tolist(),
        )
    )
    reason = _named(decision.reason, list(experiment.intervals))
    spent = len(before.points)
    done = Round(design.order, design.parts, spent, error, decision.action, reason)
    rounds = (*before.rounds, done)
    if decision.action == "stop":
        return replace(plan, adaptive=Rounds(rounds, before.points, decision.met))
    wanted = decision.specification
    settled = _settled(asked, wanted.order, wanted.parts, before.points)
    return _plan(replace(experiment, design=settled), rounds, before.points)


def _named(reason: str, names: list[str]) -> str:
    """The reason with parameters by name: `intervals.decide` knows directions by number only."""

    def name(match: re.Match) -> str:
        numbers = [int(number) for number in re.findall(r"\d+", match[1])]
        return ", ".join(names[number] for number in numbers)

    return re.sub(r"direction (\d+(?:, \d+)*)", name, reason)


def _plan(experiment: Experiment, rounds: tuple[Round, ...], spent: tuple[tuple, ...]) -> Plan:
    """The plan of a settled design; runs of earlier designs that it leaves out test it."""
    plan = make_plan(experiment, spent)
    points = dict.fromkeys([*spent, *(run.unit for run in plan.runs if run.role == "node")])
    return replace(plan, adaptive=Rounds(rounds, tuple(points)))


def _settled(
    asked: DesignChoice, order: Sequence[int], parts: Sequence, existing: tuple
) -> DesignChoice:
    """The design of one round in the place of `auto`."""
    parts = tuple((tuple(map(float, low)), tuple(map(float, high))) for low, high in parts)
    reused = existing if asked.method == "total_degree" and not parts else ()
    return replace(asked, order=tuple(map(int, order)), parts=parts, existing=reused)
