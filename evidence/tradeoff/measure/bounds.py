"""Bounds of one choice, and how far they are from a reference, phase by phase."""

import time
from dataclasses import dataclass

import numpy as np

from deployable import intervals
from evidence.tradeoff.measure.cases import Choice
from evidence.tradeoff.measure.runs import Runs


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


def phases_of(runs: Runs) -> dict[str, np.ndarray]:
    """Masks (T) of the time before the first closure, between it and the second, and after that.

    A phase ends where the first of all runs reaches the next closure. "all" is the whole time."""
    time = runs.time
    phases = {"all": np.ones(len(time), dtype=bool)}
    starts = [0.0]
    for j in range(2):
        closures = [float(times[j]) for times in runs.closures if len(times) > j]
        if closures:
            starts.append(min(closures))
    if len(starts) == 1:
        return phases
    ends = [*starts[1:], np.inf]
    for name, start, end in zip(("before", "between", "after"), starts, ends, strict=False):
        phases[name] = (time >= start) & (time < end)
    return phases


def distance(
    time: np.ndarray, band: Band, reference: Band, phases: dict[str, np.ndarray]
) -> list[dict[str, dict[str, float]]]:
    """Distance of the band from the reference: for each response, for each phase, the metrics."""
    return [
        {
            name: intervals.compare_bounds(
                time[mask],
                band.lower[i][mask],
                band.upper[i][mask],
                reference.lower[i][mask],
                reference.upper[i][mask],
            )
            for name, mask in phases.items()
        }
        for i in range(len(band.lower))
    ]


def runs_in_band(band: Band, runs: Runs) -> list[dict[str, float]]:
    """Coverage of all the level's runs and worst violation, for each response."""
    return [
        intervals.compare_runs(band.lower[i], band.upper[i], runs.values[:, i])
        for i in range(len(band.lower))
    ]


def judge_estimate(
    time: np.ndarray, band: Band, reference: Band, phases: dict[str, np.ndarray]
) -> list[dict[str, dict[str, float]]]:
    """The band's own error estimate against its true error.

    covered: share of the instants at which the estimate is at least the true error; ratio:
    estimate over truth, both integrated; worst: largest true error that the estimate leaves
    uncovered, as a share of the largest width."""
    truth = intervals.hausdorff(band.lower, band.upper, reference.lower, reference.upper)
    rows = []
    for i, true in enumerate(truth):
        width = float((reference.upper[i] - reference.lower[i]).max())
        # what is below a millionth of the width is nobody's concern
        short = np.maximum(true - band.error[i], 0.0)
        row = {}
        for name, mask in phases.items():
            total = float(np.trapezoid(true[mask], time[mask]))
            row[name] = {
                "covered": float((short[mask] <= 1e-6 * width).mean()),
                "ratio": float(np.trapezoid(band.error[i][mask], time[mask])) / max(total, 1e-300),
                "worst": float(short[mask].max() / width),
            }
        rows.append(row)
    return rows


def hull(runs: Runs, rows: slice | np.ndarray = slice(None)) -> Band:
    """Least and largest value of all the runs, or of some: a reference band."""
    values = runs.values[rows]
    return Band(values.min(axis=0), values.max(axis=0), np.zeros(values.shape[1:]))


def rms(values: np.ndarray, masks: dict[str, np.ndarray]) -> dict[str, float]:
    """Root of the mean square of values (R, T) in each phase."""
    return {name: float(np.sqrt((values[:, m] ** 2).mean())) for name, m in masks.items()}
