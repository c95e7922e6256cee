"""Least and largest value of a function over a part of the box, attained."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..models.spline.search import spread_points

_CANDIDATES = 1024
_CLIMBS = 3
_STEP = 1e-7  # of half a side, for slopes

Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Extremes:
    """Least and largest value, and their unit coordinates (k); NaN where there is no value."""

    low: float
    high: float
    argmin: np.ndarray
    argmax: np.ndarray

    @property
    def width(self) -> float:
        """Largest less least value."""
        return self.high - self.low


def extremes(
    function: Function,
    lower: np.ndarray,
    upper: np.ndarray,
    also: np.ndarray | None = None,
    climbs: int = _CLIMBS,
) -> Extremes:
    """The range that a function attains over the part [lower, upper] (k each) of the unit box.

    The arguments are those of `extreme`.
    """
    low, argmin = extreme(function, -1.0, lower, upper, also, climbs)
    high, argmax = extreme(function, 1.0, lower, upper, also, climbs)
    return Extremes(low, high, argmin, argmax)


def extreme(
    function: Function,
    sign: float,
    lower: np.ndarray,
    upper: np.ndarray,
    also: np.ndarray | None = None,
    climbs: int = _CLIMBS,
) -> tuple[float, np.ndarray]:
    """The largest (sign 1) or least (sign -1) value that a function attains over the part
    [lower, upper] (k each) of the unit box, and where (k); NaN if it has none there.

    The best of points spread over the part, its faces and corners, and of those of `also` (P, k)
    that lie in it; from the best `climbs` of them a quasi-Newton search goes on (L-BFGS-B), which
    takes a smooth function. `function` takes unit coordinates (P, k) and gives values (P), NaN
    where it has none.
    """
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    trial = np.clip(middle + half * _spread(tuple(half > 0)), lower, upper)
    if also is not None and len(also):
        inside = ((also >= lower - 1e-12) & (also <= upper + 1e-12)).all(axis=1)
        trial = np.concatenate([trial, np.clip(also[inside], lower, upper)])
    values = function(trial)
    there = np.isfinite(values)
    if not there.any():
        return np.nan, np.full(len(lower), np.nan)
    trial, values = trial[there], values[there]
    free = half > 0
    if free.sum() == 1:
        climbs = min(climbs, 1)  # on a line the points are close enough
    order = np.argsort(-sign * values, kind="stable")[: max(climbs, 1)]
    best, where = float(values[order[0]]), trial[order[0]].copy()
    if not free.any() or not climbs:
        return best, where
    # The search needs numbers everywhere; where there are none is worse than all that was tried.
    worst, scale = float((sign * values).min()), float(np.ptp(values)) or 1.0
    rows = np.flatnonzero(free)

    def loss(local: np.ndarray) -> tuple[float, np.ndarray]:
        """Minus the value and its slopes, all by one call; differences point into the part."""
        steps = np.where(local > 0, -_STEP, _STEP)
        points = np.repeat(middle[None], len(rows) + 1, axis=0)
        points[:, rows] += half[rows] * local
        points[np.arange(1, len(rows) + 1), rows] += half[rows] * steps
        found = sign * function(np.clip(points, lower, upper))
        found = -np.where(np.isfinite(found), found, worst - scale) / scale
        return float(found[0]), (found[1:] - found[0]) / steps

    from scipy.optimize import minimize

    for i in order:
        start = ((trial[i] - middle)[rows] / half[rows]).clip(-1.0, 1.0)
        bounds = [(-1.0, 1.0)] * len(rows)
        found = minimize(loss, start, method="L-BFGS-B", jac=True, bounds=bounds)
        x = middle.copy()
        x[rows] += half[rows] * found.x
        x = np.clip(x, lower, upper)
        value = float(function(x[None])[0])
        if np.isfinite(value) and sign * (value - best) > 0:
            best, where = value, x
    return best, where


@cache
def _spread(free: tuple[bool, ...]) -> np.ndarray:
    return spread_points(np.array(free), _CANDIDATES)
