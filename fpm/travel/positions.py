"""Positions of a travel, at which values are taken, and interpolation between them.

Values are known at increasing positions; where they bend or jump, a position stands twice, and what
is between bends is interpolated by cubics through the four positions around (or fewer). Positions
are added half-way between others until the interpolant meets every tested value."""

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from itertools import pairwise

import numpy as np

SMALLEST_DISTANCE = 1e-7
"""Distance of positions, as a fraction of the travel, between which values jump, or bend, for
good."""

MAX_POSITIONS = 1500
"""Largest number of positions."""

ROUNDING_LIMIT = 20.0
"""Largest error of the interpolant, over what is allowed, that counts as rounding of values."""

NODES = 4


def bends_after(positions: np.ndarray) -> np.ndarray:
    """Return the indices at which stretches between bends (kinks or jumps of sampled values) begin,
    and at last p. positions (p,): increasing, a bend's twice in a row, as end and as beginning."""
    return np.concatenate([[0], np.flatnonzero(np.diff(positions) == 0) + 1, [len(positions)]])


def interpolate(positions: np.ndarray, values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return values (m, ...) at points (m,), interpolated by cubics from values (p, ...) at
    increasing positions (p,), not across bends (kinks, jumps), whose positions stand twice."""
    points = np.atleast_1d(points)
    ends = bends_after(positions)
    index = np.clip(np.searchsorted(positions, points, side="right") - 1, 0, len(positions) - 2)
    index = np.where(positions[index] == positions[index + 1], np.maximum(index - 1, 0), index)
    stretch = np.searchsorted(ends, index, side="right") - 1
    first, last = ends[stretch], ends[stretch + 1]
    count = np.minimum(last - first, NODES)
    start = np.clip(index - 1, first, last - count)
    result = np.zeros((len(points), *values.shape[1:]))
    for size in np.unique(count):
        rows = np.flatnonzero(count == size)
        nodes = positions[start[rows, None] + np.arange(size)]
        for k in range(size):
            rest = np.delete(nodes, k, axis=1)
            weight = np.prod((points[rows, None] - rest) / (nodes[:, k, None] - rest), axis=1)
            nodal = values[start[rows] + k]
            result[rows] += weight.reshape(-1, *[1] * (nodal.ndim - 1)) * nodal
    return result


def slopes(positions: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the derivatives (p,) of values (p,) by the increasing positions (p,), by cubic splines
    between bends (kinks or jumps), whose positions stand twice in a row."""
    from scipy.interpolate import CubicSpline

    ends = bends_after(positions)
    rows = [slice(*pair) for pair in pairwise(ends)]
    pieces = [CubicSpline(positions[r], values[r])(positions[r], 1) for r in rows]
    return np.concatenate(pieces)


class SampledTravel:
    """Values (k,) measured at positions of a travel (a joint coordinate moved slowly from one value
    to another), fractions of it from 0 to 1, to which `add`, `add_bend` and `refine` add further.
    measure(position, state): returns (values, new state), started from `state`, the one returned at
    the nearest sampled position not above, None if none is; states are the caller's."""

    def __init__(self, measure: Callable):
        self._measure = measure
        self.positions: list[float] = []
        self.values: list[np.ndarray] = []
        self._states: list = []
        self._bends: set[float] = set()

    def add(self, position: float) -> np.ndarray:
        """Return the values (k,) at a position (0 to 1), measured and stored unless known."""
        k = bisect_left(self.positions, position)
        if k < len(self.positions) and self.positions[k] == position:
            return self.values[k]
        values, state = self.look(position)
        self.positions.insert(k, position)
        self.values.insert(k, values)
        self._states.insert(k, state)
        return values

    def look(self, position: float) -> tuple[np.ndarray, object]:
        """Measure the values (k,) at a position, without storing them, from the state of the
        nearest sampled position not above. Returns them and the new state."""
        k = bisect_right(self.positions, position) - 1
        return self._measure(position, self._states[k] if k >= 0 else None)

    def add_bend(self, position: float) -> None:
        """Sample a position (0 to 1) of a kink or jump; nothing is interpolated across it."""
        self.add(position)
        self._bends.add(position)

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the sampled positions (p,), fractions of the travel from 0 to 1, increasing, kinks
        or jumps between the ends twice, and the k values measured at each (p, k)."""
        inner = [
            p in self._bends and 0 < i < len(self.positions) - 1
            for i, p in enumerate(self.positions)
        ]
        index = np.repeat(np.arange(len(self.positions)), 1 + np.array(inner))
        return np.array(self.positions)[index], np.array(self.values)[index]

    def refine(self, measure_error: Callable[[np.ndarray, np.ndarray, float], float]) -> bool:
        """Sample further positions, half-way between others, until interpolated values are
        accurate; False where more than 1500 would be needed. Two positions within 1e-7 between
        which they still are not are marked as a kink or jump. measure_error(interpolated, measured,
        distance): error over the allowed one. Accurate: up to 1, or up to ROUNDING_LIMIT if halving
        does not help."""
        pairs = [(*ends, np.inf) for ends in pairwise(self.positions)]
        while pairs:
            lower, upper, previous_error = pairs.pop()
            middle = 0.5 * (lower + upper)
            expected = interpolate(*self.arrays(), np.array([middle]))[0]
            error = measure_error(expected, self.add(middle), upper - lower)
            if error <= 1.0 or ROUNDING_LIMIT >= error > 0.7 * previous_error:
                continue
            if upper - lower <= SMALLEST_DISTANCE:
                self._bends |= {lower, upper}
            elif len(self.positions) >= MAX_POSITIONS:
                return False
            else:
                pairs += [(lower, middle, error), (middle, upper, error)]
        return True
