"""The designs of experiments that configs ask for, and how many runs they have."""

from __future__ import annotations

from typing import Any

import numpy as np

from deployable import intervals
from deployable.campaign.config.sections import ADAPTIVE, DesignChoice, Experiment, Solver


def make_design(choice: DesignChoice, box: Any) -> Any:
    """The `intervals.Design` of a choice in an `intervals.Box`.

    Raises `intervals.IntervalError`.
    """
    if choice.method == ADAPTIVE:
        points = np.array(choice.existing, dtype=float).reshape(-1, box.dimension)
        none = np.zeros((0, box.dimension), dtype=int)
        return intervals.Design(points, none, ADAPTIVE, (0,) * box.dimension)
    options = {name: getattr(choice, name) for name in intervals.METHODS[choice.method].options}
    most = choice.samples if choice.method == "scan" else intervals.designs.MAX_RUNS
    return intervals.make_design(choice.method, box, choice.order, max_runs=most, **options)


MOST_STEPS = 10**9
"""Steps of a run: of the smallest scene, a day."""


def steps_problems(solver: Solver, step: float) -> list[str]:
    """Whether a run has more steps (of `step` s) than anybody waits for, as a sentence."""
    if solver.duration / step <= MOST_STEPS:
        return []
    which = "duration" if solver.step == "auto" else "step"
    return [
        f"solver.{which}: {solver.duration / step:.3g} steps of {step:.3g} s; allowed: at most "
        f"{MOST_STEPS:.0e} steps, a duration of {MOST_STEPS * step:.3g} s"
    ]


def count_runs(experiment: Experiment) -> int:
    """Number of runs of the campaign, at most; those in two roles are counted twice."""
    design = experiment.design
    if experiment.is_sought:
        return experiment.accuracy.runs
    if design.method == "scan":  # its points take a while to make, and their number is known
        return design.samples + 1
    return make_design(design, experiment.box).runs + 1 + experiment.held_out
