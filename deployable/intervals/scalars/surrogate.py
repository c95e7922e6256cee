"""The surrogate of a number over the box: a fit, and where there is such a number at all; its range
over a part of the box, and which parameter widens that."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
import scipy

from ..box import MOST_FULL
from ..chebyshev import Formula
from ..designs import spread_points
from .fits import choose_fit, root_fit
from .occurrence import FittedOccurrence, JointOccurrence, Occurrence, border_of_runs

_CANDIDATES = 1024
_CLIMBS = 3
_TRUSTED = 3.0  # times its error: so far the surrogate must exceed all runs to be relied on
_STEP = 1e-7  # of half a side, for slopes
_FLAT = 1e-5  # largest projected slope at which L-BFGS-B ends, its default

Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Extremes:
    """Least and largest value (`low`, `high`) of a function over a part of the box, and where
    (`argmin`, `argmax`, k each, in [-1, 1]); all NaN where it has no value there."""

    low: float
    high: float
    argmin: np.ndarray
    argmax: np.ndarray

    @property
    def width(self) -> float:
        """Difference of the largest and the least value, NaN without values."""
        return self.high - self.low


def extreme(
    function: Function,
    sign: float,
    lower: np.ndarray,
    upper: np.ndarray,
    extra_points: np.ndarray | None = None,
    climbs: int = _CLIMBS,
) -> tuple[float, np.ndarray]:
    """Find the largest (sign 1) or least (sign -1) value that a function attains over the part of
    the box from `lower` to `upper` (k each, in [-1, 1]), and where (k); both NaN if it has none
    there. function: takes points (P, k) and returns values (P), NaN where it has none. The best of
    points spread over the part, its faces and corners, and of those `extra_points` (P, k; None:
    none) that lie in it; from the best `climbs` of them (on a line one, at 0 none) a quasi-Newton
    search goes on (L-BFGS-B), which takes a smooth function."""
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    trial = np.clip(middle + half * _spread(tuple(half > 0)), lower, upper)
    if extra_points is not None and len(extra_points):
        in_part = ((extra_points >= lower - 1e-12) & (extra_points <= upper + 1e-12)).all(axis=1)
        trial = np.concatenate([trial, np.clip(extra_points[in_part], lower, upper)])
    values = function(trial)
    is_number = np.isfinite(values)
    if not is_number.any():
        return np.nan, np.full(len(lower), np.nan)
    trial, values = trial[is_number], values[is_number]
    free = half > 0
    if free.sum() == 1:
        climbs = min(climbs, 1)  # on a line the points are close enough
    heights = sign * values
    order = np.argsort(-heights, kind="stable")[:climbs] if climbs > 1 else [heights.argmax()]
    best, argument = float(values[order[0]]), trial[order[0]].copy()
    if not free.any() or not climbs:
        return best, argument
    # The search needs numbers everywhere; where there are none is worse than all that was tried.
    worst, scale = float((sign * values).min()), float(np.ptp(values)) or 1.0
    rows = np.flatnonzero(free)

    def loss(local: np.ndarray) -> tuple[float, np.ndarray]:
        """Return minus the value and its slopes, from one call; differences point into the part."""
        steps = np.where(local > 0, -_STEP, _STEP)
        points = np.repeat(middle[None], len(rows) + 1, axis=0)
        points[:, rows] += half[rows] * local
        points[np.arange(1, len(rows) + 1), rows] += half[rows] * steps
        losses = sign * function(np.clip(points, lower, upper))
        losses = -np.where(np.isfinite(losses), losses, worst - scale) / scale
        return float(losses[0]), (losses[1:] - losses[0]) / steps

    for i in order:
        place = ((trial[i] - middle)[rows] / half[rows]).clip(-1.0, 1.0)
        slopes = loss(place)[1]
        # In most corners all slopes point out of the part, and L-BFGS-B would stay there.
        if np.abs(np.clip(place - slopes, -1.0, 1.0) - place).max() > _FLAT:
            bounds = [(-1.0, 1.0)] * len(rows)
            search = {"method": "L-BFGS-B", "jac": True, "bounds": bounds}
            place = scipy.optimize.minimize(loss, place, **search).x
        x = middle.copy()
        x[rows] += half[rows] * place
        x = np.clip(x, lower, upper)
        value = float(function(x[None])[0])
        if np.isfinite(value) and sign * (value - best) > 0:
            best, argument = value, x
    return best, argument


@cache
def _spread(free: tuple[bool, ...]) -> np.ndarray:
    return spread_points(np.array(free), _CANDIDATES)


@dataclass(frozen=True)
class ScalarSurrogate:
    """Surrogate of a quantity (a number of each run, as the time of an event) over the box. Made by
    `fit_scalar`. fit: its value as a function of the normalized parameters, None: no run has one;
    occurrence: in which part of the box it exists; least, most: physical bounds; latest: of a time,
    the end of the runs (s), which no value passes; each infinite where there is none."""

    fit: Any  # Fit | None
    occurrence: Occurrence
    least: float = -np.inf
    latest: float = np.inf
    most: float = np.inf

    @property
    def error(self) -> float:
        """Estimated error of the values, the largest leave-one-out error; NaN without a fit."""
        return np.nan if self.fit is None else self.fit.error

    @property
    def usual_error(self) -> float:
        """Estimated error of the values where runs were sampled adaptively, a mean of leave-one-out
        errors (`Fit.usual_error`); NaN where no run has a value."""
        return np.nan if self.fit is None else self.fit.usual_error

    @property
    def bound_error(self) -> float:
        """Return the least error of bounds of adaptively sampled runs: half of `usual_error`, which
        covers the whole box, mostly far from bounds. NaN without a fit."""
        return 0.5 * self.usual_error

    @property
    def trend(self) -> ScalarSurrogate:
        """Copy without the kriging correction, which makes a polynomial pass through every run, to
        compare parts of the box with each other; splines, and surrogates without a fit, stay."""
        is_same = self.fit is None or self.fit.trend is self.fit
        return self if is_same else replace(self, fit=self.fit.trend)

    @cached_property
    def rival(self) -> ScalarSurrogate | None:
        """The surrogate with the other kind of fits, polynomials or splines (`Fit.rival`), also of
        the border of where the quantity exists; None where neither fit has one."""
        fit, occurrence = self.fit and self.fit.rival, self.occurrence
        if isinstance(occurrence, FittedOccurrence) and occurrence.fit.rival is not None:
            occurrence = replace(occurrence, fit=occurrence.fit.rival)
        if fit is None and occurrence is self.occurrence:
            return None
        return replace(self, fit=fit or self.fit, occurrence=occurrence)

    @property
    def is_censored(self) -> bool:
        """Whether the quantity is a time that in a part of the box comes after the runs have ended,
        so that its largest value there is not known, only `latest`, the end of the runs."""
        return isinstance(self.occurrence, FittedOccurrence) and self.occurrence.latest is not None

    def predict(self, points: np.ndarray) -> np.ndarray:
        """Values (P) of the fit at `points` (P, k) in [-1, 1]^k, clipped to what is
        possible; also where the quantity does not exist; `fit` must not be None."""
        values = self.fit.evaluate(np.asarray(points, dtype=float))
        return np.clip(values, self.least, min(self.latest, self.most))

    def room(self, sign: float, value: float) -> float:
        """By how much a value may grow (sign 1) or fall (sign -1) up to what is possible."""
        return sign * ((min(self.latest, self.most) if sign > 0 else self.least) - value)

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P) of the quantity at `points` (P, k) in [-1, 1]^k, NaN if absent."""
        if self.fit is None:
            return np.full(len(points), np.nan)
        return np.where(self.occurrence.evaluate(points), self.predict(points), np.nan)

    def formulas(self) -> tuple[Formula | None, Formula | bool]:
        """Two tables for other programs: of the fit, None without one; and of the decision
        function, at least 0 where the quantity exists; True, False: in all runs, in none."""
        sure = not self.occurrence.is_mixed
        return (
            None if self.fit is None else self.fit.formula(),
            bool(self.occurrence.happens.all()) if sure else self.occurrence.formula(),
        )

    def range(
        self, lower: np.ndarray | None = None, upper: np.ndarray | None = None, **options: Any
    ) -> Extremes:
        """Range that the surrogate attains over the part of the box from `lower` to `upper` (k
        each, in [-1, 1]; None: the whole), and where; NaN without values. options: `climbs`, number
        of best points from which a search goes on."""
        if lower is None and upper is None and not options:
            return self._whole_range
        part = (*self._part(lower, upper), self._trial_points)
        low, argmin = extreme(self.evaluate, -1.0, *part, **options)
        high, argmax = extreme(self.evaluate, 1.0, *part, **options)
        return Extremes(low, high, argmin, argmax)

    @cached_property
    def _whole_range(self) -> Extremes:
        """The range over the whole box, which bounds, their errors and influences all ask for."""
        return self.range(*self._part())

    def end(
        self, sign: float, lower: np.ndarray, upper: np.ndarray, climbs: int = 1
    ) -> tuple[float, np.ndarray]:
        """Return the upper (sign 1) or lower (sign -1) bound of the surrogate over the part of the
        box from `lower` to `upper` (k each, in [-1, 1]), and the point (k) where it is attained;
        both NaN without values. climbs: number of best points from which a local search starts."""
        part = self._part(lower, upper)
        return self._find_once(self.evaluate, sign, *part, self._trial_points, climbs)

    def _find_once(self, function: Function, sign, lower, upper, points, climbs):
        """Return the result of `extreme` for a function of this surrogate, computed once, since
        limits of the same quantity ask for the same."""
        key = (function.__name__, sign, lower.tobytes(), upper.tobytes(), climbs)
        if key not in self._extremes:
            self._extremes[key] = extreme(function, sign, lower, upper, points, climbs)
        return self._extremes[key]

    @cached_property
    def _extremes(self) -> dict[tuple, tuple[float, np.ndarray]]:
        return {}

    @cached_property
    def _trial_points(self) -> np.ndarray | None:
        """Unit points (P, k) at which extremes are sought: runs, and the limit-state surface."""
        if self.fit is None:
            return None
        return np.concatenate([self.fit.points, self.occurrence.surface_points])

    def _part(
        self, lower: np.ndarray | None = None, upper: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the part of the box, without extent along parameters that do not vary."""
        side = np.ones(self.occurrence.points.shape[1])
        free = np.ptp(self.occurrence.points, axis=0) > 0
        lower = np.where(free, -side if lower is None else lower, 0.0)
        return lower, np.where(free, side if upper is None else upper, 0.0)

    def find_place(self, lower: np.ndarray, upper: np.ndarray, happens: bool) -> np.ndarray | None:
        """Find the point (k) of a part of the box where the quantity most certainly exists
        (`happens`), or does not: where the decision function (`Occurrence.decision`) is largest, or
        least; the part's middle if all runs agree with that; None if there is no such point. lower,
        upper (k each): corners of the part, in [-1, 1]."""
        lower, upper = self._part(lower, upper)
        if not self.occurrence.is_mixed:
            return (lower + upper) / 2 if self.occurrence.happens.all() == happens else None
        value, point = self.decision_end(1.0 if happens else -1.0, lower, upper)
        return point if (value >= 0) == happens else None

    def decision_end(
        self, sign: float, lower: np.ndarray, upper: np.ndarray
    ) -> tuple[float, np.ndarray]:
        """Return the largest (sign 1) or least (sign -1) value of the decision function
        (`Occurrence.decision`) over a part of the box (corners of k each), and the point (k)."""
        part, points = self._part(lower, upper), self.occurrence.points
        return self._find_once(self.occurrence.decision, sign, *part, points, climbs=1)


def fit_scalar(
    points: np.ndarray,
    values: np.ndarray,
    latest: float | None = None,
    limits: tuple[float, float] = (-np.inf, np.inf),
    margin: Any = None,
) -> ScalarSurrogate:
    """Fit the surrogate of a quantity to values (N) of runs at `points` (N, k) in [-1, 1]^k, NaN
    where the quantity does not exist in a run, as the time of an event that does not occur.

    latest: of a time, when runs end (s), else None; limits: physical bounds; margin (N): event
    margin, how far a run is from having the event, above 0 where it occurs, NaN where not known.
    The border between runs with and without a value is the one that leaves least volume undecided:
    by the runs alone, where the fit reaches `latest`, or where a fit to `margin`, if known of all
    runs, vanishes."""
    points, values = np.asarray(points, dtype=float), np.asarray(values, dtype=float)
    happens = np.isfinite(values)
    fit: Any = choose_fit(points[happens], values[happens]) if happens.any() else None
    if happens.sum() == 1 and np.ptp(points, axis=0).any():  # which no other run tests
        fit = replace(fit, left_out=np.full(1, np.inf))
    occurrence = _occurrence(points, happens, fit, latest, margin)
    if occurrence.is_mixed and getattr(occurrence, "latest", None) is None:
        edge_fit = root_fit(points[happens], values[happens], occurrence)
        if edge_fit is not None and edge_fit.mean_error < fit.mean_error:
            fit = edge_fit
    end = np.inf if latest is None else latest
    return ScalarSurrogate(fit, occurrence, limits[0], end, limits[1])


def share_borders(surrogates: Sequence[ScalarSurrogate]) -> list[ScalarSurrogate]:
    """Give quantities whose border only runs tell the borders of up to three others that all exist
    in the same runs and are fitted, as an expression those of its parts: copies, in order."""
    borders = {
        border.happens.tobytes(): border
        for border in (surrogate.occurrence for surrogate in surrogates)
        if isinstance(border, FittedOccurrence)
    }

    def best(border: Occurrence) -> Occurrence:
        if type(border) is not Occurrence or not border.is_mixed:
            return border
        wider = [part for part in borders.values() if (part.happens >= border.happens).all()]

        def is_of(parts: Sequence[Occurrence]) -> bool:
            return np.array_equal(np.all([part.happens for part in parts], axis=0), border.happens)

        rivals: list[Occurrence] = [part for part in wider if part.latest is None and is_of([part])]
        candidates = [part for part in wider if not is_of([part])]
        for size in (2, 3):
            for parts in itertools.combinations(candidates, size) if not rivals else ():
                if is_of(parts):
                    rivals.append(JointOccurrence(border.points, border.happens, parts=parts))
        return min([border, *rivals], key=_openness)

    return [replace(surrogate, occurrence=best(surrogate.occurrence)) for surrogate in surrogates]


def _openness(border: Occurrence) -> float:
    return border.usual_open_fraction


def _occurrence(
    points: np.ndarray,
    happens: np.ndarray,
    fit: Any,
    latest: float | None,
    margin: np.ndarray | None,
) -> Occurrence:
    by_runs = border_of_runs(points, happens)
    if not by_runs.is_mixed:
        return by_runs
    borders = [by_runs]
    if margin is not None and np.isfinite(margin).all():
        margin_fit = choose_fit(points, margin)
        border = FittedOccurrence(points, happens, margin_fit, margin_fit.error)
        borders += [border] if np.isfinite(border.error) and border.agrees(border.error) else []
    if latest is not None and np.isfinite(fit.error):
        by_time = FittedOccurrence(points, happens, fit, fit.error, latest)
        borders += [by_time] if by_time.agrees() else []
    return min(reversed(borders), key=_openness)


@dataclass(frozen=True)
class Influence:
    """Widths of a quantity's range, by parameter: `alone` (k), if only this one varies; `share`
    (k), that over the sum for all parameters, widths not above the fit's error counted as 0;
    `fixed` and `halved` (k), if all vary but this one keeps its nominal value, or half its interval
    about it, NaN where a time may have no upper end. `width`: of the whole box; `error` (k): by how
    much these widths may be wrong. All but `share` in the quantity's unit."""

    width: float
    alone: np.ndarray
    share: np.ndarray
    fixed: np.ndarray
    halved: np.ndarray
    error: np.ndarray


def find_influence(
    surrogate: ScalarSurrogate,
    nominal: np.ndarray,
    previous: ScalarSurrogate | None = None,
    is_endless: bool = False,
) -> Influence:
    """Compute the influence of each parameter on the width of a quantity's range, by its surrogate
    (of up to eight without kriging corrections), so without further runs. nominal (k): nominal
    values of the parameters, normalized to [-1, 1]; previous: surrogate before runs were added
    where extremes are: places like these that have no run may be as wrong as it was, in widths;
    is_endless: of a time that may have no upper end towards where it does not exist."""
    nominal = np.asarray(nominal, dtype=float)
    k = len(nominal)
    if surrogate.fit is not None and (np.ptp(surrogate.fit.points, axis=0) > 0).sum() > MOST_FULL:
        return _influence_at_ends(surrogate, nominal, is_endless)
    rival, full_surrogate, surrogate = surrogate.rival, surrogate, surrogate.trend
    side = np.ones(k)
    lone_widths, fixed_widths, halved = np.zeros((3, k))
    is_mixed = surrogate.occurrence.is_mixed
    errors = np.full(k, surrogate.error)
    previous = previous if previous is not None and previous.fit is not None else surrogate
    changes = [_width_error(surrogate, rival, -side, side)]
    for j in range(k):
        lower, upper = nominal.copy(), nominal.copy()
        lower[j], upper[j] = -1.0, 1.0
        lone_widths[j] = surrogate.range(lower, upper).width
        for widths, part in ((fixed_widths, 0.0), (halved, 0.5)):
            lower, upper = -side, side.copy()
            lower[j] = nominal[j] + part * (-1.0 - nominal[j])
            upper[j] = nominal[j] + part * (1.0 - nominal[j])
            widths[j] = surrogate.range(lower, upper).width
            changes.append(abs(previous.range(lower, upper, climbs=1).width - widths[j]))
            errors[j] = np.fmax(errors[j], _width_error(surrogate, rival, lower, upper))
            is_certain = is_mixed and surrogate.find_place(lower, upper, False) is None
            if is_endless and not is_certain:
                widths[j] = np.nan
    # What the corrections at runs add to the width of the whole box, the polynomial lacks in parts.
    lack = abs(full_surrogate.range().width - surrogate.range().width)
    errors = np.fmax(errors, np.fmax.reduce(changes)) + lack
    share = _contributions(lone_widths, surrogate.error)
    return Influence(surrogate.range().width, lone_widths, share, fixed_widths, halved, errors)


def _width_error(
    surrogate: ScalarSurrogate, rival: ScalarSurrogate | None, lower: np.ndarray, upper: np.ndarray
) -> float:
    """Return the largest change of the width over a part of the box, with the other kind of fits
    and with the border of the quantity's existence moved through its undecided band; NaN if the
    quantity has no such border."""
    if not surrogate.occurrence.is_mixed:
        return np.nan
    part, width = surrogate._part(lower, upper), surrogate.range(lower, upper).width
    widths = [] if rival is None else [rival.range(lower, upper, climbs=1).width]

    def evaluate_beside(points: np.ndarray, side: float) -> np.ndarray:
        occurrence = surrogate.occurrence
        is_there = occurrence.decision(points) >= side * occurrence.band(points)
        return np.where(is_there, surrogate.predict(points), np.nan)

    for side in (-1.0, 1.0):
        high, low = (
            extreme(
                partial(evaluate_beside, side=side), sign, *part, surrogate._trial_points, climbs=1
            )[0]
            for sign in (1.0, -1.0)
        )
        widths.append(np.subtract(high, low))
    return float(np.fmax.reduce(np.abs(np.subtract(widths, width))))


def _contributions(widths: np.ndarray, error: float) -> np.ndarray:
    significant = np.where(widths > error, widths, 0.0)
    return significant / (significant.sum() or 1.0)


def _influence_at_ends(
    surrogate: ScalarSurrogate, nominal: np.ndarray, is_endless: bool
) -> Influence:
    """Influence of many parameters, by changes of one at a time from the ends of the range, with
    the corrections through runs, as there are runs so near; other parameters do not follow."""
    bounds, eye = surrogate.range(), np.eye(len(nominal), dtype=bool)
    values, width = surrogate.fit.values, bounds.width
    points: Any = (bounds.argmin, bounds.argmax)
    if width <= np.ptp(values) + _TRUSTED * surrogate.error:  # what runs attain can be relied on
        width, points = np.ptp(values), surrogate.fit.points[[values.argmin(), values.argmax()]]
    widths = []
    for part in (0.0, 0.5):
        ends = [
            surrogate.predict(np.where(eye, nominal + part * (end - nominal), end))
            for end in points
        ]
        widths.append(ends[1] - ends[0])
    lines = [surrogate.predict(np.where(eye, x, nominal)) for x in np.linspace(-1.0, 1.0, 9)]
    lone_widths = np.ptp(lines, axis=0)
    share = _contributions(lone_widths, surrogate.error)
    errors = np.full(len(nominal), surrogate.error)
    first, second = np.maximum(widths, np.nan if is_endless else 0.0)
    return Influence(float(width), lone_widths, share, first, second, errors)
