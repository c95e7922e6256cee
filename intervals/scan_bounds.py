"""Bounds of a plain scan: the least and the largest sample, run by run in chunks.

A scan looks from the inside: its bounds grow with every sample and are never wider than the truth.
How much they grew from the first half of the samples to all of them is reported as the error. It is
of the order of what is still missing, neither a bound nor blind: the samples are not on a grid.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from .datasets import Bounds, bounds_to_dataset, read_samples
from .errors import ErrorEstimate
from .exceptions import IntervalError

if TYPE_CHECKING:
    import xarray as xr

_CHUNK = 1 << 23  # numbers in memory at a time


class RunningBounds:
    """Least and largest value of a stream of runs, and which run it was.

    `low`, `high` have the shape (...) of one run, `low_run`, `high_run` the index of the run.
    """

    def __init__(self) -> None:
        self.runs = 0
        self.low = self.high = self.low_run = self.high_run = None

    def update(self, values: np.ndarray) -> None:
        """Take in values (R, ...) of the next R runs."""
        values = np.asarray(values)
        if not len(values):
            return
        if not np.isfinite(values).all():
            raise IntervalError("samples", "not finite", "finite responses in every run")
        at_low, at_high = values.argmin(axis=0), values.argmax(axis=0)
        low, high = values.min(axis=0), values.max(axis=0)
        if self.low is None:
            self.low, self.high = low.astype(float), high.astype(float)
            self.low_run, self.high_run = at_low, at_high
        else:
            self.low_run = np.where(low < self.low, at_low + self.runs, self.low_run)
            self.high_run = np.where(high > self.high, at_high + self.runs, self.high_run)
            self.low, self.high = np.minimum(self.low, low), np.maximum(self.high, high)
        self.runs += len(values)


def stream_bounds(chunks: Iterable[np.ndarray]) -> RunningBounds:
    """Running bounds of an iterable of arrays (R, ...), one in memory at a time."""
    running = RunningBounds()
    for chunk in chunks:
        running.update(chunk)
    return running


def scan_bounds_dataset(
    samples: xr.Dataset, responses: Sequence[str] | None = None, attrs: dict | None = None
) -> xr.Dataset:
    """Bounds of all runs of a samples dataset, which may be open lazily and larger than memory."""
    data = read_samples(samples, responses, values=False)
    total = len(data.unit)
    step = max(_CHUNK // len(data.time), 1)
    half = (total + 1) // 2
    results, errors = [], []
    for i in data.rows:
        running = RunningBounds()
        first = None
        for part in ((0, half), (half, total)):
            for start in range(part[0], part[1], step):
                running.update(samples["values"][start : min(start + step, part[1]), i].values)
            if first is None:
                first = (running.low, running.high)
        results.append(running)
        errors.append(np.maximum(first[0] - running.low, running.high - first[1]))
    lower, upper = np.array([r.low for r in results]), np.array([r.high for r in results])
    at_low = np.array([data.unit[r.low_run] for r in results])
    at_high = np.array([data.unit[r.high_run] for r in results])
    centre = None
    if data.nominal is not None:
        centre = samples["values"][data.nominal, data.rows].values
    bounds = Bounds(lower, upper, lower, upper, at_low, at_high)
    growth = np.array(errors)
    error = ErrorEstimate(growth, growth, np.zeros_like(growth))
    attrs = {
        "design_runs": total,
        "bounds_kind": "least and largest sample",
        "error_kind": "growth of the bounds from the first half of the samples to all",
        **(attrs or {}),
    }
    return bounds_to_dataset(data, bounds, centre, error, np.arange(0), attrs)
