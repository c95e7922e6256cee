"""Least and largest value of a function over a part of the box, attained."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..models.spline.search import spread_points

_CANDIDATES = 1024
_CLIMBS = 3

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

    The best of points spread over the part, its faces and corners, and of those of `also` (P, k)
    that lie in it; from the best `climbs` of them a quasi-Newton search goes on (L-BFGS-B), which
    takes a smooth function. `function` takes unit coordinates (P, k) and gives values (P), NaN
    where it has none.
    """
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    local = _spread(tuple(half > 0))
    trial = np.clip(middle + half * local, lower, upper)
    if also is not None and len(also):
        inside = ((also >= lower - 1e-12) & (also <= upper + 1e-12)).all(axis=1)
        trial = np.concatenate([trial, np.clip(also[inside], lower, upper)])
    values = function(trial)
    there = np.isfinite(values)
    if not there.any():
        nowhere = np.full(len(lower), np.nan)
        return Extremes(np.nan, np.nan, nowhere, nowhere)
    trial, values = trial[there], values[there]
    low, argmin = _search(function, -1.0, trial, values, lower, upper, climbs)
    high, argmax = _search(function, 1.0, trial, values, lower, upper, climbs)
    return Extremes(low, high, argmin, argmax)


@cache
def _spread(free: tuple[bool, ...]) -> np.ndarray:
    return spread_points(np.array(free), _CANDIDATES)


def _search(function, sign, trial, values, lower, upper, climbs) -> tuple[float, np.ndarray]:
    """The best value, largest with sign 1, and where it is, from the best of the points tried."""
    from scipy.optimize import minimize

    if (upper > lower).sum() == 1:
        climbs = min(climbs, 1)  # on a line the points are close enough
    order = np.argsort(-sign * values, kind="stable")[: max(climbs, 1)]
    best, where = float(values[order[0]]), trial[order[0]].copy()
    free = upper > lower
    if not free.any() or not climbs:
        return best, where
    middle, half = (lower + upper) / 2, (upper - lower) / 2

    def place(local: np.ndarray) -> np.ndarray:
        x = middle.copy()
        x[free] = np.clip(middle[free] + half[free] * local, lower[free], upper[free])
        return x

    # L-BFGS-B needs numbers everywhere; where there are none is worse than all that was tried.
    worst = float(-sign * values[order[0]]) + np.ptp(values) + 1.0
    scale = float(np.ptp(values)) or 1.0

    def loss(local: np.ndarray) -> float:
        value = -sign * float(function(place(local)[None])[0])
        return (value if np.isfinite(value) else worst) / scale

    for i in order:
        start = ((trial[i] - middle)[free] / half[free]).clip(-1.0, 1.0)
        found = minimize(loss, start, method="L-BFGS-B", bounds=[(-1.0, 1.0)] * int(free.sum()))
        x = place(found.x)
        value = float(function(x[None])[0])
        if np.isfinite(value) and sign * (value - best) > 0:
            best, where = value, x
    return best, where
