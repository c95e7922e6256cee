"""A plain scan: the least and the largest sample, run by run in chunks.

A scan looks from the inside: its bounds grow with every sample and are never wider than the truth.
How much they grew from the first half of the samples to all of them is reported as the error. It is
of the order of what is still missing, neither a bound nor blind: the samples are not on a grid.
"""

from __future__ import annotations

import numpy as np

from ..designs import Design, SplitDesign
from ..errors import IntervalError
from ..estimates import ErrorEstimate
from ..ranges import Range, attained
from ..samples import Samples
from .model import Model

_CHUNK = 1 << 23  # numbers in memory at a time


class ScanModel(Model):
    """No model: the runs themselves, whatever the design; there may be more than memory holds."""

    kind = "least and largest sample"

    def __init__(self, samples: Samples, design: Design | SplitDesign | None = None) -> None:
        self.unit, total = samples.unit, len(samples.unit)
        step = max(_CHUNK // (len(samples.time) * len(samples.names)), 1)
        half = (total + 1) // 2
        extremes = _Extremes()
        for first, last in ((0, half), (half, total)):
            for start in range(first, last, step):
                extremes.update(samples.read(slice(start, min(start + step, last))))
            if first == 0:
                before = extremes.low, extremes.high
        self.extremes = extremes
        self.growth = np.maximum(before[0] - extremes.low, extremes.high - before[1])
        self.attributes = {
            "design_runs": total,
            "error_kind": "growth of the bounds from the first half of the samples to all",
        }

    def range(self) -> Range:
        found = self.extremes
        return attained(found.low, found.high, self.unit[found.low_run], self.unit[found.high_run])

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        return ErrorEstimate(self.growth, self.growth, np.zeros_like(self.growth))


class _Extremes:
    """Least and largest values (...) of a stream of runs, and which run they were."""

    def __init__(self) -> None:
        self.runs = 0
        self.low = self.high = self.low_run = self.high_run = None

    def update(self, values: np.ndarray) -> None:
        """Take in values (R, ...) of the next R runs, at least one."""
        if not np.isfinite(values).all():
            raise IntervalError("samples", "not finite", "finite responses in every run")
        at_low, at_high = values.argmin(axis=0), values.argmax(axis=0)
        low, high = values.min(axis=0).astype(float), values.max(axis=0).astype(float)
        if self.low is None:
            self.low, self.high, self.low_run, self.high_run = low, high, at_low, at_high
        else:
            self.low_run = np.where(low < self.low, at_low + self.runs, self.low_run)
            self.high_run = np.where(high > self.high, at_high + self.runs, self.high_run)
            self.low, self.high = np.minimum(self.low, low), np.maximum(self.high, high)
        self.runs += len(values)
