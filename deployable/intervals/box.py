"""The box of interval parameters, its map to the unit cube [-1, 1]^k, and points in it."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import IntervalError, check_integer

MAX_DIMENSION = 60
"""Most parameters of a box."""

MOST_FULL = 8
"""Most parameters of which all corners are taken, and for which grids can be made."""

FEW_PARAMETERS = 5
"""Most parameters of which runs that vary one or two at a time tell enough of the whole box."""

_MOST_CORNERS = 256  # of a box of more parameters

ROUNDING = 1e-12
"""Share of a size below which a difference is rounding: thousands of steps leave some 1e-13."""


@dataclass(frozen=True)
class Box:
    """Box of k interval parameters: all combinations of values within their bounds. A parameter
    whose interval has zero width keeps its one value; its normalized coordinate is 0 everywhere.

    Attributes
    ----------
    names: names of the k parameters, each once.
    lower, upper: bounds (k) in the units of the parameters, lower <= upper."""

    names: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray

    def __init__(self, names: Sequence[str], lower: Any, upper: Any):
        names = (names,) if isinstance(names, str) else tuple(names)
        lower, upper = (np.array(side, dtype=float, ndmin=1) for side in (lower, upper))
        if not 1 <= len(names) <= MAX_DIMENSION:
            raise IntervalError("intervals", names, f"1 to {MAX_DIMENSION} names")
        if len(set(names)) != len(names):
            raise IntervalError("intervals", names, "names that differ from each other")
        if lower.shape != (len(names),) or upper.shape != (len(names),):
            shapes = (lower.shape, upper.shape)
            raise IntervalError("lower, upper", shapes, f"one number for each of {list(names)}")
        for name, low, high in zip(names, lower, upper, strict=True):
            if not (np.isfinite(low) and np.isfinite(high)):
                raise IntervalError(f"interval {name}", (low, high), "finite numbers")
            if low > high:
                raise IntervalError(f"interval {name}", (low, high), "lower <= upper")
        for side in (lower, upper):
            side.setflags(write=False)
        for key, value in (("names", names), ("lower", lower), ("upper", upper)):
            object.__setattr__(self, key, value)

    @property
    def dimension(self) -> int:
        """Number of parameters k, those of zero width included."""
        return len(self.names)

    @property
    def free(self) -> np.ndarray:
        """Mask (k) of the parameters whose interval has a width, True where lower < upper."""
        return self.upper > self.lower

    def constant_names(self, points: np.ndarray) -> list[str]:
        """Names of the parameters whose interval has a width that runs at normalized points (R, k)
        do not vary: what rests on these runs lacks their influence."""
        is_fixed = self.free & (np.ptp(points, axis=0) == 0)
        return [name for name, fixed in zip(self.names, is_fixed, strict=True) if fixed]

    def to_unit(self, values: np.ndarray) -> np.ndarray:
        """Normalize parameter values (..., k): coordinates (..., k) from -1 at `lower` to 1 at
        `upper`; 0 where the width is zero."""
        values = np.asarray(values, dtype=float)
        width = np.where(self.free, self.upper - self.lower, 1.0)
        points = ((values - self.lower) - (self.upper - values)) / width
        return np.where(self.free, points, 0.0)

    def from_unit(self, points: np.ndarray) -> np.ndarray:
        """Parameter values (..., k) of normalized coordinates `points` (..., k): -1 gives exactly
        `lower`, 1 exactly `upper`, and equal coordinates give equal values to the last bit, as runs
        are recognised by their values; beyond [-1, 1], by more than rounding, the map goes on."""
        points = np.asarray(points, dtype=float)
        values = self.lower * ((1.0 - points) / 2.0) + self.upper * ((1.0 + points) / 2.0)
        in_cube = (np.abs(points) <= 1.0 + ROUNDING) & self.free
        values = np.where(in_cube, np.clip(values, self.lower, self.upper), values)
        return np.where(self.free, values, self.lower)

    def corners(self) -> np.ndarray:
        """Corners of the box (2^f, k), normalized: -1 or 1 in f intervals with a width, else 0. Of
        more than eight such intervals the 2 f ends of each alone."""
        if self.free.sum() > MOST_FULL:
            return axis_points(self.free)
        choices = [(-1.0, 1.0) if free else (0.0,) for free in self.free]
        return np.array(list(itertools.product(*choices)))


def is_general(points: np.ndarray) -> np.ndarray:
    """Mask (N) of points (N, k) in [-1, 1]^k that tell of the whole box: all, or those that vary
    more than two at once, which grids do not have, with more than `FEW_PARAMETERS` directions."""
    is_wide = (np.ptp(points, axis=0) > 0).sum() > FEW_PARAMETERS
    return (points != 0).sum(axis=1) > (2 if is_wide else -1)


def keys(points: np.ndarray, digits: int = 12) -> list[tuple[float, ...]]:
    """Hashable keys of points (N, k), one tuple of k numbers each, to find equal points:
    coordinates rounded to `digits` decimals, without -0."""
    return [tuple(point) for point in np.round(points, digits) + 0.0]


def axis_points(free: np.ndarray) -> np.ndarray:
    """Ends (2 f, k) of the f directions with a width, each alone: the lower and then the upper end
    of one direction after the other, 0 in all others. free (k): mask of the directions."""
    axes = np.repeat(np.eye(len(free))[np.asarray(free, dtype=bool)], 2, axis=0)
    return axes * np.resize([-1.0, 1.0], len(axes))[:, None]


def corner_points(free: np.ndarray) -> np.ndarray:
    """Corners (2^f, k) of [-1, 1]^k, ordered so that opposite ones follow each other and the first
    few are spread out; beyond eight directions 256 of them at random. free (k): mask of the f
    directions with a width; in others points are 0."""
    free = np.asarray(free, dtype=bool)
    dimension = int(free.sum())
    if dimension == 0:
        return np.zeros((1, len(free)))
    half: Any
    if dimension > MOST_FULL:
        half = np.random.default_rng(0).choice([-1.0, 1.0], (_MOST_CORNERS // 2, dimension))
    else:
        half = [(-1.0, *rest) for rest in itertools.product((-1.0, 1.0), repeat=dimension - 1)]
    points = np.zeros((2 * len(half), len(free)))
    points[::2, free] = half
    points[1::2, free] = -np.array(half)
    return points


def held_out_points(free: np.ndarray, count: int, avoid: np.ndarray | None = None) -> np.ndarray:
    """Points (count, k) in [-1, 1]^k of validation runs, which test a surrogate and are not fitted;
    none where no direction has a width. free (k): mask of the directions with a width, 0 in the
    others; count: 0 to 100 000, else IntervalError; avoid (R, k): points to be skipped, None for
    none, as a fitted node says nothing of the error. Corners come first, for at most half of the
    points, because a surrogate is worst at the edges; then an R-sequence (Roberts 2018: additive
    recurrence with the generalised golden ratio), whose first points are those of any longer
    one."""
    free = np.asarray(free, dtype=bool)
    count = check_integer("held_out", count, 0, 100_000)
    dimension = int(free.sum())
    if dimension == 0 or count == 0:
        return np.zeros((0, len(free)))
    skip = set() if avoid is None else set(keys(avoid))
    picks = [p for p in corner_points(free) if tuple(p + 0.0) not in skip][: (count + 1) // 2]
    ratio = 2.0
    for _ in range(60):  # fixed point of x^(d+1) = x + 1
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    for i in itertools.count(1):
        if len(picks) >= count:
            break
        point = np.zeros(len(free))
        point[free] = 2 * np.mod(0.5 + i * steps, 1.0) - 1
        if keys(point[None])[0] not in skip:
            picks.append(point)
    return np.array(picks)


def _nearest(points: np.ndarray, runs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return for points (N, k) the index of the nearest of `runs` (R, k), and its distance
    (Chebyshev's); -1 and infinity without runs."""
    if not len(runs):
        return np.full(len(points), -1), np.full(len(points), np.inf)
    distances = (np.abs(runs - point).max(axis=1) for point in points)
    nearest = np.array([(d.argmin(), d.min()) for d in distances]).reshape(-1, 2)
    return nearest[:, 0].astype(int), nearest[:, 1]


TOLERANCE = 1e-8
"""Largest difference of a normalized coordinate between equal points."""


def match_points(points: np.ndarray, runs: np.ndarray) -> np.ndarray:
    """Find the run at each design point (N, k): returns indices (N) into the runs, or raises
    IntervalError if a point has none. runs (R, k): points of the runs, in any order. All
    coordinates are normalized, -1 to 1."""
    index, distance = _nearest(points, runs)
    missing = np.flatnonzero(distance > TOLERANCE)
    if len(missing):
        first = np.round(points[missing[0]], 6).tolist()
        raise IntervalError(
            "samples",
            f"no run at {len(missing)} of {len(points)} design points, such as {first} (-1 to 1)",
            "a run at every point of the design",
        )
    return index


def find_other_runs(runs: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Find the runs that are at none of the design's points, which may test a fit to that design:
    increasing indices into `runs` (R, k), normalized points; points (N, k): the design's."""
    return np.flatnonzero(_nearest(runs, points)[1] > TOLERANCE)
