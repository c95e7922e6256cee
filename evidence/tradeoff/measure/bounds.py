"""Bounds of one choice, and how far they are from a reference."""

import time
from dataclasses import dataclass

import numpy as np

from deployable import intervals
from evidence.tradeoff.measure.cases import Choice, Level
from evidence.tradeoff.measure.runs import Runs, simulate

SEEK = 400
"""Runs of one round of those that widen a scan's bounds."""


@dataclass(frozen=True)
class Band:
    """Bounds (n, T) of the responses; error (n, T): what they say of themselves; cpu (s)."""

    lower: np.ndarray
    upper: np.ndarray
    error: np.ndarray
    cpu: float = 0.0


def take_bounds(choice: Choice, design: intervals.Design, tests: np.ndarray, runs: Runs) -> Band:
    """The bounds as a campaign would take them, from the runs of the design and at `tests`."""
    samples = runs.samples(np.concatenate([design.points, tests]))
    start = time.process_time()
    dataset = intervals.bounds_dataset(samples, design, model=choice.model)
    cpu = time.process_time() - start
    return Band(dataset["lower"].values, dataset["upper"].values, dataset["error"].values, cpu)


def distance(time: np.ndarray, band: Band, reference: Band) -> list[float]:
    """Hausdorff distance of the band from the reference, integrated over time, as a share of the
    integrated width, for each response."""
    true = intervals.hausdorff(band.lower, band.upper, reference.lower, reference.upper)
    width = reference.upper - reference.lower
    return (np.trapezoid(true, time) / np.trapezoid(width, time)).tolist()


def judge_estimate(time: np.ndarray, band: Band, reference: Band) -> list[dict[str, float]]:
    """The band's own error estimate against its true error, for each response.

    covered: share of the instants at which the estimate is at least the true error; ratio:
    estimate over truth, both integrated."""
    truth = intervals.hausdorff(band.lower, band.upper, reference.lower, reference.upper)
    rows = []
    for i, true in enumerate(truth):
        # What is below a millionth of the width is nobody's concern.
        floor = 1e-6 * float((reference.upper[i] - reference.lower[i]).max())
        total = max(float(np.trapezoid(true, time)), 1e-300)
        rows.append(
            {
                "covered": float((true <= band.error[i] + floor).mean()),
                "ratio": float(np.trapezoid(band.error[i], time)) / total,
            }
        )
    return rows


def hull(runs: Runs) -> Band:
    """Least and largest value of all the runs: a reference band."""
    values = runs.values
    return Band(values.min(axis=0), values.max(axis=0), np.zeros(values.shape[1:]))


def seek_runs(level: Level, runs: Runs) -> tuple[Runs, list[float]]:
    """The runs with those of the level's rounds, and by how much the last round widened them."""
    growth = [0.0] * runs.values.shape[1]
    for seed in range(level.rounds):
        options = {"candidates": 8192, "seed": seed + 1}
        points, _ = intervals.seek_points(runs.points, runs.values, SEEK, **options)
        if not len(points):
            break
        narrower, runs = runs, runs.with_runs(simulate(runs.case, level.elements, points))
        growth = distance(runs.time, hull(narrower), hull(runs))
    return runs, growth
