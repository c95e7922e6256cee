"""Positions of a travel: where values are taken, and what lies between.

Values are known at increasing places; where they bend or jump, a place stands twice, and what is
between bends is interpolated by cubics through the four places around (fewer where there are not as
many). Places are added half-way between others until the interpolant meets every tested value.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from itertools import pairwise

import numpy as np

NARROWEST = 1e-7
"""Distance (of the travel) of places between which values jump, or bend, for good."""

MOST = 1500
"""Most places."""

UNSTEADY = 20.0
"""By how much the interpolant may miss where the rounding of values is all that there is."""

NODES = 4


def bends_after(places: np.ndarray) -> np.ndarray:
    """The first index of each stretch between bends, and the number of all places."""
    return np.concatenate([[0], np.flatnonzero(np.diff(places) == 0) + 1, [len(places)]])


def between(places: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (m, ...) at (m,), interpolated from those (p, ...) at places (p,)."""
    at = np.atleast_1d(at)
    ends = bends_after(places)
    index = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    index = np.where(places[index] == places[index + 1], np.maximum(index - 1, 0), index)
    stretch = np.searchsorted(ends, index, side="right") - 1
    first, last = ends[stretch], ends[stretch + 1]
    count = np.minimum(last - first, NODES)
    start = np.clip(index - 1, first, last - count)
    out = np.zeros((len(at), *values.shape[1:]))
    for size in np.unique(count):
        rows = np.flatnonzero(count == size)
        nodes = places[start[rows, None] + np.arange(size)]
        for k in range(size):
            others = np.delete(nodes, k, axis=1)
            weight = np.prod((at[rows, None] - others) / (nodes[:, k, None] - others), axis=1)
            found = values[start[rows] + k]
            out[rows] += weight.reshape(-1, *[1] * (found.ndim - 1)) * found
    return out


def slopes(places: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes (p,) of values (p,) at the places, by splines between bends."""
    from scipy.interpolate import CubicSpline

    ends = bends_after(places)
    found = [CubicSpline(places[a:b], values[a:b])(places[a:b], 1) for a, b in pairwise(ends)]
    return np.concatenate(found)


class Places:
    """Places (of a travel, 0 to 1) with values (k,) that `measure(place, left)` takes, from the
    state `left` at the nearest place before, and with the state there."""

    def __init__(self, measure: Callable):
        self._measure = measure
        self.at: list[float] = []
        self.values: list[np.ndarray] = []
        self._states: list = []
        self._bends: set[float] = set()

    def add(self, place: float) -> np.ndarray:
        """Take the values at a place, unless they are known, and keep them."""
        k = bisect_left(self.at, place)
        if k < len(self.at) and self.at[k] == place:
            return self.values[k]
        values, state = self.look(place)
        self.at.insert(k, place)
        self.values.insert(k, values)
        self._states.insert(k, state)
        return values

    def look(self, place: float) -> tuple[np.ndarray, object]:
        """The values at a place, and the state there."""
        k = bisect_right(self.at, place) - 1
        return self._measure(place, self._states[k] if k >= 0 else None)

    def bend(self, place: float) -> None:
        """That values bend at a place."""
        self.add(place)
        self._bends.add(place)

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Places (p,), those of bends twice, and values (p, k)."""
        inner = [p in self._bends and 0 < i < len(self.at) - 1 for i, p in enumerate(self.at)]
        twice = np.repeat(np.arange(len(self.at)), 1 + np.array(inner))
        return np.array(self.at)[twice], np.array(self.values)[twice]

    def refine(self, missed: Callable[[np.ndarray, np.ndarray, float], float]) -> bool:
        """Add places until the interpolant half-way between any two misses the values there by no
        more than 1, as missed(expected, values, distance) measures it, or by a little, UNSTEADY,
        that does not fall with the distance; False where that takes more than MOST."""
        pairs = [(*ends, np.inf) for ends in pairwise(self.at)]
        while pairs:
            left, right, before = pairs.pop()
            middle = 0.5 * (left + right)
            expected = between(*self.arrays(), np.array([middle]))[0]
            by = missed(expected, self.add(middle), right - left)
            if by <= 1.0 or UNSTEADY >= by > 0.7 * before:
                continue
            if right - left <= NARROWEST:
                self._bends |= {left, right}
            elif len(self.at) >= MOST:
                return False
            else:
                pairs += [(left, middle, by), (middle, right, by)]
        return True
