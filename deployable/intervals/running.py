"""Running bounds: the least and the largest values of a stream of runs, and which runs had them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Running:
    """Least and largest values (...) of runs, and the number of the run that has each.

    Of equal values the one of the run with the least number counts, so that the result does not
    depend on the order in which runs come, nor on how they were grouped.
    """

    low: np.ndarray
    high: np.ndarray
    low_run: np.ndarray
    high_run: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray, runs: np.ndarray) -> Running:
        """Those of values (R, ...), finite, of runs with numbers (R) that increase."""
        low, high = values.argmin(axis=0)[None], values.argmax(axis=0)[None]
        at = np.asarray(runs)
        return cls(
            np.take_along_axis(values, low, axis=0)[0].astype(float),
            np.take_along_axis(values, high, axis=0)[0].astype(float),
            at[low[0]],
            at[high[0]],
        )

    def merged(self, other: Running | None) -> Running:
        """Those of both streams."""
        if other is None:
            return self
        lower = _comes_first(other.low, self.low, other.low_run, self.low_run)
        higher = _comes_first(-other.high, -self.high, other.high_run, self.high_run)
        return Running(
            np.where(lower, other.low, self.low),
            np.where(higher, other.high, self.high),
            np.where(lower, other.low_run, self.low_run),
            np.where(higher, other.high_run, self.high_run),
        )


def _comes_first(one: np.ndarray, other: np.ndarray, run: np.ndarray, rival: np.ndarray):
    """Where `one` is less than `other`, or as large and of an earlier run."""
    return (one < other) | ((one == other) & (run < rival))
