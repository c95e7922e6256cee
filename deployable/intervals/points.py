"""Points of the box: its corners, those of held-out runs, and which of them are the same."""

from __future__ import annotations

import itertools

import numpy as np

from .errors import IntervalError, check_integer


def keys(points: np.ndarray, digits: int = 12) -> list[tuple[float, ...]]:
    """What points (N, k) are known by: their coordinates without rounding errors, without -0."""
    return [tuple(point) for point in np.round(points, digits) + 0.0]


def corner_points(free: np.ndarray) -> np.ndarray:
    """Corners (2^f, k), opposite ones next to each other, so that the first few are spread out."""
    free = np.asarray(free, dtype=bool)
    dimension = int(free.sum())
    if dimension == 0:
        return np.zeros((1, len(free)))
    half = [(-1.0, *rest) for rest in itertools.product((-1.0, 1.0), repeat=dimension - 1)]
    signs = np.array([s for corner in half for s in (corner, tuple(-c for c in corner))])
    points = np.zeros((len(signs), len(free)))
    points[:, free] = signs
    return points


def held_out_points(free: np.ndarray, count: int, avoid: np.ndarray | None = None) -> np.ndarray:
    """Points (count, k) for the runs that test a surrogate and do not enter it.

    Corners come first, for at most half of the points, because a surrogate is worst at the edges;
    then an R-sequence (Roberts 2018: additive recurrence with the generalised golden ratio), whose
    first points are those of any longer sequence. Points that are in `avoid` (R, k) are skipped:
    a node tells nothing about the error.
    """
    free = np.asarray(free, dtype=bool)
    count = check_integer("held_out", count, 0, 100_000)
    dimension = int(free.sum())
    if dimension == 0 or count == 0:
        return np.zeros((0, len(free)))
    taken = set() if avoid is None else set(keys(avoid))
    chosen = [p for p in corner_points(free) if tuple(p + 0.0) not in taken][: (count + 1) // 2]
    ratio = 2.0
    for _ in range(60):  # fixed point of x^(d+1) = x + 1
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    i = 0
    while len(chosen) < count:
        i += 1
        point = np.zeros(len(free))
        point[free] = 2 * np.mod(0.5 + i * steps, 1.0) - 1
        if keys(point[None])[0] not in taken:
            chosen.append(point)
    return np.array(chosen)


def match_points(points: np.ndarray, unit: np.ndarray, tolerance: float = 1e-8) -> np.ndarray:
    """Index (N) of the run at each design point; runs are known by their coordinates, not place."""
    found = np.full(len(points), -1)
    for i, point in enumerate(points):
        distance = np.abs(unit - point).max(axis=1) if len(unit) else np.array([np.inf])
        at = int(distance.argmin())
        if distance[at] <= tolerance:
            found[i] = at
    missing = np.flatnonzero(found < 0)
    if len(missing):
        first = np.round(points[missing[0]], 6).tolist()
        raise IntervalError(
            "samples",
            f"no run at {len(missing)} of {len(points)} design points, the first at unit {first}",
            "a run at every point of the design",
        )
    return found


def other_runs(unit: np.ndarray, points: np.ndarray, tolerance: float = 1e-8) -> np.ndarray:
    """Indices of the runs that are at none of the design's points."""
    far = np.ones(len(unit), dtype=bool)
    for point in points:
        far &= np.abs(unit - point).max(axis=1) > tolerance
    return np.flatnonzero(far)
