"""Search for the bounds of a quantity: what runs attain, what the surrogate may add, and the points
at which further runs may extend a bound.

A point is worth a run where the surrogate, with its local error in favour, exceeds the extreme run:
an upper confidence bound, as in Bayesian optimisation (Jones, Schonlau and Welch 1998), with errors
by leave-one-out validation in place of a posterior deviation. Next to jumps and limit-state
surfaces these errors stay large until runs enclose the place, so that the search goes on there."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from ..box import MOST_FULL, ROUNDING
from ..designs import spread_points
from .fits import Fit, level
from .occurrence import REACH, Occurrence
from .surrogate import Extremes, ScalarSurrogate, extreme

TOLERANCE = 1e-3
"""A bound is converged when nothing may exceed the extreme run by this fraction of the width."""

NEAREST = 1e-6
"""Distance in unit coordinates by which a run must differ from all others."""

_CANDIDATES, _CLOUD = 1024, 96
_CLOUD_SIZES = (1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4)  # about the extreme run
_REACH, _RIDGE, _STEP = 1.4, 0.1, 0.2  # of runs near by; for their slopes; on a line
_MOVES = 12  # of single parameters, of one iteration
_INFILL, _SECTIONS = 3, 3  # runs of one iteration by confidence, and towards a limit-state surface
_WORTH = 10.0  # times the tolerance: a gain by confidence, which may be none, that is worth runs
_END_SHARE = 0.05  # of the width: so near the end of the runs a time is taken to go on beyond it
_MOST_EXCESS = 0.3  # of the width of the runs: so far beyond them a surrogate may be a bound
_STEADY, _GROWTH = 0.75, 0.05  # of a time's growth before, and of its width: growth without an end
_TRUST_RATIO = 3.0  # times its error: so far the surrogate must exceed all runs to be a bound


class BoundEstimate(NamedTuple):
    """Lower or upper bound of a quantity. value: the extreme run's, or the surrogate's where that
    goes farther by several times its own error, or, of a time that may lie beyond the runs, their
    end; error: largest error of the bound, by what the surrogate leaves possible, not
    negative; points (P, k) in [-1, 1]^k: where further runs may extend it, if any."""

    value: float
    error: float
    points: np.ndarray


def estimate_bounds(
    surrogate: ScalarSurrogate,
    points: np.ndarray,
    values: np.ndarray,
    mispredictions: Sequence[float] = (0.0, 0.0),
    is_endless: bool | None = None,
) -> tuple[BoundEstimate, ...]:
    """Estimate the lower and the upper bound of a quantity from its surrogate and values (N) of
    runs at `points` (N, k) in [-1, 1]^k, NaN where a run has none: two estimates; an empty tuple
    where no run has a value. mispredictions: for the lower and the upper bound, by how much the
    last run at that end of the surrogate differed from it; 0 without such a run, infinite if that
    run has no value; is_endless: whether a time is known to have no upper end, else None."""
    if surrogate.fit is None:
        return ()
    surrogate_range, values = surrogate.range(), level(values)
    rows = int(np.nanargmin(values)), int(np.nanargmax(values))
    width = max(float(np.diff(values[list(rows)])[0]), surrogate_range.width)
    tolerance = max(TOLERANCE * width, ROUNDING * np.abs(values[list(rows)]).max())
    extremes = ((values[row], points[row]) for row in rows)
    return tuple(
        _estimate(surrogate, surrogate_range, sign, attained, tolerance, miss, is_endless)
        for sign, attained, miss in zip((-1.0, 1.0), extremes, mispredictions, strict=True)
    )


def local_errors(fit: Fit, x: np.ndarray) -> np.ndarray:
    """Errors (P) of a fit at points `x` (P, k) in [-1, 1]^k, by leave-one-out errors: the
    largest over the nearest runs of such an error times the distance from the nearest run, over the
    distance of the run from its own next one; 0 at a run, at most the largest error of all."""
    points, width = fit.points, float(np.ptp(fit.values))
    errors = np.minimum(np.abs(fit.left_out), width)
    if len(points) == 1:
        return np.full(len(x), errors[0])
    count = min(len(points), int((np.ptp(points, axis=0) > 0).sum()) + 2)
    tree = scipy.spatial.cKDTree(points)
    spacings = np.maximum(tree.query(points, 2)[0][:, 1], NEAREST)
    distances, rows = tree.query(x, count)
    ratios = distances[:, :1] / spacings[rows]
    return np.minimum((errors[rows] * ratios).max(axis=1), errors.max())


def _estimate(
    surrogate: ScalarSurrogate,
    surrogate_range: Extremes,
    sign: float,
    attained: tuple[float, np.ndarray],
    tolerance: float,
    misprediction: float = 0.0,
    is_endless: bool | None = None,
) -> BoundEstimate:
    """Return the upper (sign 1) or lower (sign -1) bound of a quantity that has a fit. attained:
    extreme value of all runs, its unit point (k). Gains below `tolerance` do not count.
    misprediction, is_endless: see `estimate_bounds`."""
    value, argument = attained
    end, peak = surrogate_range.low, surrogate_range.argmin
    if sign > 0:
        end, peak = surrogate_range.high, surrogate_range.argmax
    excess = max(sign * (end - value), 0.0)
    is_wide = (np.ptp(surrogate.fit.points, axis=0) > 0).sum() > MOST_FULL
    error = max(misprediction, surrogate.fit.error)
    candidates, gains = _gains(surrogate, sign, value, argument)
    gain = max(float(gains.max(initial=0.0)), excess)
    # What the runs span comes first: far beyond it, or by a fit of large errors, nothing is known.
    is_near = excess <= _MOST_EXCESS * float(np.ptp(surrogate.fit.values))
    is_predicted = is_near and excess > max(_TRUST_RATIO * error, tolerance)
    points = [peak] if excess > tolerance else []
    worth, width = _WORTH * tolerance, tolerance / TOLERANCE
    if is_wide:  # too many directions for candidates to come near all that the fit leaves open
        gain = max(gain, min(excess + surrogate.fit.mean_error, surrogate.room(sign, value)))
        points += _moves(surrogate, sign, argument, tolerance)
    if gain > worth and not is_predicted:
        points += [*_sections(surrogate.occurrence, argument)]
    if gain > worth and not is_predicted and not is_wide:
        points += _space_points(surrogate.occurrence.points, candidates[gains > worth])
    unit_points = np.array(points).reshape(-1, len(argument))
    # A time that in a part of the box comes after the runs have ended.
    is_late = excess > 0 and end >= surrogate.latest and excess <= _END_SHARE * width
    is_late = is_late or surrogate.is_censored
    if sign > 0 and surrogate.occurrence.is_mixed and not is_late:
        is_late = _is_endless(surrogate, argument) if is_endless is None else is_endless
    if sign > 0 and surrogate.occurrence.is_mixed and is_late:
        return BoundEstimate(surrogate.latest, 0.0, unit_points[: int(excess > tolerance)])
    if is_predicted:
        return BoundEstimate(end, max(error, gain - excess), unit_points)
    return BoundEstimate(value, gain, unit_points)


def _is_endless(surrogate: ScalarSurrogate, argument: np.ndarray) -> bool:
    """Return whether a time, largest at a point (k), grows with every bisection of the way to where
    it ceases, as beside a separatrix: when a run without it is four times as near, about as much as
    by the four times before, where beside a root's edge it grows by half of that."""
    occurrence, fit, width = surrogate.occurrence, surrogate.fit, np.ptp(surrogate.fit.values)
    misses = scipy.spatial.cKDTree(occurrence.points[~occurrence.happens])
    gaps, gap = misses.query(fit.points)[0], misses.query(argument)[0]
    order = np.argsort(-gaps, kind="stable")
    heights = np.maximum.accumulate(fit.values[order])  # the largest that far from all misses
    ends = -np.log(gap * np.array([16.0, 4.0, 1.0]))
    first, middle, last = np.interp(ends, -np.log(gaps[order]), heights)
    is_near = np.isfinite(surrogate.latest) and 16 * gap <= min(REACH, gaps.max())
    return bool(is_near and last - middle >= max(_STEADY * (middle - first), _GROWTH * width))


def _gains(
    surrogate: ScalarSurrogate, sign: float, value: float, argument: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Unit points (P, k), most promising first, and how far a run there may exceed `value` (P)."""
    occurrence, points = surrogate.occurrence, surrogate.occurrence.points
    free = np.ptp(points, axis=0) > 0
    # Spread over the box, by the extreme run, and on the limit-state surface.
    spread = spread_points(free, _CANDIDATES)
    spread[:, ~free] = points[0, ~free]
    cloud = spread_points(free, _CLOUD, seed=3) * free
    clouds = [np.clip(argument + size * cloud, -1.0, 1.0) for size in _CLOUD_SIZES]
    candidates = np.concatenate([spread, *clouds, occurrence.surface_points])
    decision, band = occurrence.decision(candidates), occurrence.band(candidates)
    candidates, is_open = candidates[decision > -band], (decision < band)[decision > -band]
    values = sign * surrogate.predict(candidates)
    values[is_open] = np.maximum(
        values[is_open], sign * surrogate.fit.evaluate_border(candidates[is_open])
    )
    gains = values - sign * value + local_errors(surrogate.fit, candidates)
    gains = np.minimum(gains, surrogate.room(sign, value))
    order = np.argsort(-gains, kind="stable")
    return candidates[order], gains[order]


def _moves(
    surrogate: ScalarSurrogate, sign: float, argument: np.ndarray, tolerance: float
) -> list[np.ndarray]:
    """Normalized points (P, k) of a search about the extreme run, at a point (k), by the polynomial
    with slopes by the runs near by: its extreme and that of the polynomial alone, all changes of
    single parameters together that it gains by and the four best of them, then single ones: to
    either end, the middle, and half way to the next runs, best first, as many as may gain."""
    fit, trend = surrogate.fit, surrogate.trend
    side = (np.ptp(fit.points, axis=0) > 0).astype(float)
    offsets = fit.points - argument
    distances = np.linalg.norm(offsets, axis=1)
    rest = fit.values - trend.fit.evaluate(fit.points)
    weights = np.exp(-0.5 * (distances / _REACH) ** 2)[:, None] * offsets
    matrix = weights.T @ offsets + _RIDGE * np.eye(len(argument))
    slopes = np.linalg.solve(matrix, weights.T @ (rest - rest[distances.argmin()]))

    def predict(x: np.ndarray) -> np.ndarray:
        return trend.predict(x) + x @ slopes

    differs, changes = np.abs(offsets) > NEAREST, []
    for j in np.flatnonzero(side):
        line = argument[j] + offsets[~np.delete(differs, j, axis=1).any(axis=1), j]
        halves = {(argument[j] + x) / 2 for x in line if abs(x - argument[j]) > _STEP}
        changes += [(j, x) for x in halves | {-1.0, 0.0, 1.0}]
    candidates = np.repeat(argument[None], len(changes), axis=0)
    for candidate, (j, x) in zip(candidates, changes, strict=True):
        candidate[j] = x
    gains = sign * (predict(candidates) - predict(argument[None]))
    order = np.argsort(-gains, kind="stable")
    points = [extreme(predict, sign, -side, side, argument[None], 1)[1]]
    points.append(trend.end(sign, -side, side)[1])
    for most in (len(order), 4):
        points.append(argument.copy())
        for i in order[:most][gains[order[:most]] > 0][::-1]:  # the best of a parameter is the last
            points[-1][changes[i][0]] = changes[i][1]
    gaps = scipy.spatial.cKDTree(fit.points).query(candidates)[0]
    is_full = np.array([x in (-1, 0, 1) or abs(argument[j]) < 1 for j, x in changes])
    is_open = gains > np.where(is_full, tolerance - fit.mean_error, tolerance)
    is_open &= gaps > NEAREST
    if fit.mean_error > tolerance and not is_open.any():  # tells what each parameter contributes
        is_open = (gaps > NEAREST) & [x == 0 for _, x in changes]
    singles = order[is_open[order]]
    return [*points, *candidates[singles[:_MOVES]]]


def _space_points(runs: np.ndarray, candidates: np.ndarray) -> list[np.ndarray]:
    """First unit points (P, k) farther apart than half their distance to the next run (N, k)."""
    points: list[np.ndarray] = []
    gaps = scipy.spatial.cKDTree(runs).query(candidates)[0]
    for point, gap in zip(candidates, gaps, strict=True):
        is_apart = all(np.linalg.norm(point - neighbour) > gap / 2 for neighbour in points)
        if len(points) < _INFILL and gap > NEAREST and is_apart:
            points.append(point)
    return points


def _sections(occurrence: Occurrence, argument: np.ndarray) -> np.ndarray:
    """Unit points (P, k) that divide the way from the run at a point (k) to the nearest without."""
    misses = occurrence.points[~occurrence.happens]
    if not len(misses):
        return misses
    offset = misses[np.linalg.norm(misses - argument, axis=1).argmin()] - argument
    if np.abs(offset).max() < NEAREST:
        return misses[:0]
    return argument + np.arange(1, _SECTIONS + 1)[:, None] / (_SECTIONS + 1) * offset
