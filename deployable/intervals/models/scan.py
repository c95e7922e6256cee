"""A plain scan: the least and the largest sample.

A scan looks from the inside: its bounds grow with every sample and are never wider than the truth.
How much they grew from the first half of the samples to all of them is reported as the error. It is
of the order of what is still missing, neither a bound nor blind: the samples are not on a grid. How
much they grew with the last quarter alone is told too, and which share of the box can be expected
to leave the bounds at one instant (`estimates.share_outside`).

Samples are read run by run in chunks; or the dataset has the running bounds of each quarter of its
runs in their place (`Samples.quarters`).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..designs import Design
from ..errors import IntervalError
from ..estimates import ErrorEstimate, share_outside
from ..ranges import Range, attained
from ..running import Running
from ..samples import Samples, quarter_ends
from .model import Model

_CHUNK = 1 << 23  # numbers in memory at a time


class ScanModel(Model):
    """No model: the runs themselves, whatever the design; there may be more than memory holds."""

    kind = "least and largest sample"

    def __init__(self, samples: Samples, design: Design | None = None) -> None:
        self.unit, found = samples.unit, None
        step = max(_CHUNK // (len(samples.time) * len(samples.names)), 1)
        grown = [found]
        for quarter in _quarters(samples, step):
            found = quarter.merged(found) if quarter else found
            grown.append(found)
        self.found = found
        self.growth = {"half": _growth(grown[2], found), "quarter": _growth(grown[3], found)}
        drawn = len(self.unit) - _chosen(samples)
        self.attributes = {
            "design_runs": len(self.unit),
            "error_kind": "growth of the bounds from the first half of the samples to all",
            "drawn_runs": drawn,
            "share_outside": share_outside(drawn),
            "share_outside_95": share_outside(drawn, 0.95),
        }

    def range(self) -> Range:
        found = self.found
        return attained(found.low, found.high, self.unit[found.low_run], self.unit[found.high_run])

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        growth = self.growth["half"]
        return ErrorEstimate(growth, growth, np.zeros_like(growth))

    def variables(self) -> dict:
        text = "growth of the bounds with the last quarter of the samples"
        return {
            "growth_quarter": (("response", "time"), self.growth["quarter"], {"long_name": text})
        }


def _quarters(samples: Samples, step: int):
    """The `Running` bounds of each quarter of the runs, None for one without runs."""
    if (kept := samples.quarters()) is not None:
        yield from kept
        return
    ends = quarter_ends(len(samples.unit))
    for first, last in pairwise(ends):
        found = None
        for start in range(first, last, step):
            stop = min(start + step, last)
            values = samples.read(slice(start, stop))
            if not np.isfinite(values).all():
                raise IntervalError("samples", "not finite", "finite responses in every run")
            found = Running.of(values, np.arange(start, stop)).merged(found)
        yield found


def _growth(before: Running | None, after: Running) -> np.ndarray:
    """By how much bounds grew, on the side where they grew more."""
    if before is None:
        return np.zeros_like(after.low)
    return np.maximum(before.low - after.low, after.high - before.high)


def _chosen(samples: Samples) -> int:
    """Runs that were not drawn: the nominal one, and corners of the box."""
    free = np.ptp(samples.unit, axis=0) > 0
    corners = (np.abs(samples.unit[:, free]) == 1.0).all(axis=1)
    if samples.nominal is not None:
        corners[samples.nominal] = True
    return int(corners.sum())
