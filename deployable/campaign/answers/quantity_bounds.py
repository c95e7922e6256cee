"""Bounds of each quantity: sought with a surrogate, simulated, and sought again."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from deployable.campaign.answers.endless import grows_without_end
from deployable.campaign.answers.evaluations import SAME_POINT, ModelEvaluator
from deployable.campaign.answers.limits import LimitSpec, assess_limits
from deployable.campaign.plan.jobs import LANES
from deployable.intervals.box import MOST_FULL, ROUNDING, is_general
from deployable.intervals.designs import scan_points
from deployable.intervals.scalars import TOLERANCE, Climb, FittedOccurrence, estimate_bounds

_MIN_FRACTION = 1e-3  # volume fraction of the box at which the search for a surface stops
_STEPS = 4  # iterations of a search by single parameters, each in place of one of fewer parameters
_MOST_SHARE = 0.7  # of the runs that are left, for local searches of one iteration
_MOST_CLIMBS = 40  # runs in a row of a local search
_PARAMETER_RUNS = 8  # runs for each parameter before the surrogate says where others are made
_ROUGH = 0.02  # of the width of the runs: error of a fit that is not close
_MOST_SPREAD = 4  # times as many where a quantity has no value
_CORNER_DIRECTIONS = 3  # parameters whose corners are run at once
_UNSURE = 0.02  # of the width: error of an upper bound whose growth is followed
_OPEN = 0.05  # of the width: error of an upper bound that may not exist
_STAGNANT = 0.9  # of the error with half as many runs: what does not fall by more is given up
_MOST_TURNS = 16  # runs for each parameter where expressions of the structure turn back or bend
_SURFACE = 8  # runs of an iteration about a limit-state surface: eight take what three do
_BORDER_RUNS = 4  # about the border that a fit gives a limit
_FAILURE_POINTS, _SPARE = 2, 6  # about the border to failed runs, while so many more may fail


@dataclass(frozen=True)
class QuantityBounds:
    """Bounds of a quantity over the parameter box, by its surrogate and by the runs. surrogate:
    `intervals.scalars.ScalarSurrogate` of all runs; surrogate_range: its extreme values over the
    box (`Extremes`); lower, upper: extreme values of the runs, NaN if none has the quantity;
    argmin, argmax (k): normalized points of these runs; estimates: `BoundEstimate` of the lower and
    the upper bound, empty without a value; unconverged (2): whether the surrogate goes below
    `lower`, above `upper` by more than 0.1 % of the width; remainders (2): by how much lower and
    upper bound may be exceeded as searches did not come to their end (`Climb.remainder`); is_grown:
    whether runs on a line show that a time grows without an end, None if no runs tell."""

    surrogate: Any
    surrogate_range: Any
    lower: float
    upper: float
    argmin: np.ndarray
    argmax: np.ndarray
    estimates: tuple[Any, ...] = ()
    unconverged: tuple[bool, bool] = (False, False)
    remainders: tuple[float, float] = (0.0, 0.0)
    is_grown: bool | None = None

    @property
    def outer(self) -> tuple[float, float]:
        """Lower and upper bound as reported, in the quantity's unit: the extreme run's value, or
        the surrogate's where it goes farther by several times its own error. The upper bound of a
        time that may come after the end of the runs is that end. NaN without a value."""
        return tuple(e.value for e in self.estimates) or (np.nan, np.nan)

    @property
    def error(self) -> float:
        """Larger of the errors of lower and upper bound, in the quantity's unit: by how much the
        surrogate, or a search that did not end, may be beyond the bound; NaN without a value."""
        errors = [e.error for e in self.estimates]
        return max([*errors, *self.remainders]) if errors else np.nan

    @property
    def may_be_endless(self) -> bool:
        """Whether the quantity, a time, may have no upper bound: runs show it, or leave open how
        far it grows towards where it ceases, and no performance function tells where that is."""
        occurrence, (lower, upper) = self.surrogate.occurrence, self.outer
        if self.is_grown is not None:
            return self.is_grown and upper < self.surrogate.latest
        is_blind = occurrence.is_mixed and not isinstance(occurrence, FittedOccurrence)
        is_below = is_blind and upper < self.surrogate.latest < np.inf
        return bool(is_below and self.estimates[1].error > _OPEN * (upper - lower))

    @property
    def is_growing(self) -> bool:
        """Whether runs are to tell if the quantity, a time, grows without an end: its largest value
        has an error, or lies beside where it ceases, which no performance function tells."""
        surrogate = self.surrogate
        if surrogate.latest == np.inf or surrogate.is_censored or not self.upper > self.lower:
            return False
        is_fitted = isinstance(surrogate.occurrence, FittedOccurrence)
        is_blind = surrogate.occurrence.is_mixed and not is_fitted
        return is_blind or self.estimates[1].error > _UNSURE * (self.upper - self.lower)

    @property
    def relative_error(self) -> float:
        """Error of the bounds where runs were sampled adaptively, the larger of `error` and the
        surrogate's `bound_error`, over the width; infinite without a width, 0 if all is equal but
        for rounding; NaN without a value."""
        error, (lower, upper) = max(self.error, self.surrogate.bound_error), self.outer
        rounding = ROUNDING * max(abs(lower), abs(upper))
        if upper - lower > rounding:
            return float(error / (upper - lower))
        return 0.0 if error <= rounding else np.inf if error > 0 else np.nan


def converge_bounds(
    model: ModelEvaluator,
    max_iterations: int,
    specs: Sequence[LimitSpec] = (),
    tolerances: Sequence[float] = (),
) -> list[QuantityBounds]:
    """Bound all quantities by runs and surrogates, one `QuantityBounds` each, in order, in at most
    `max_iterations` iterations; 0: by the runs so far. An iteration adds runs to `model` at the
    surrogates' bounds and where these may still go farther, at limit-state surfaces of events, and
    where the limits `specs` are worst, then refits; where none is to be added, it ends.
    tolerances (q): errors, as fractions of widths, that are asked for (`accuracy`): where one is
    exceeded, and falls with runs, iterations go on with runs spread over the box, too, as long as
    the evaluator allows any. At the end come up to twice as many iterations for the limits alone,
    until the places that decide them are simulated."""
    mispredictions = np.zeros((len(model.experiment.quantity_list), 2))
    if model.points.shape[1] > MOST_FULL:
        max_iterations *= _STEPS
    if max_iterations > 0:
        model.add(_turning_points(model))
    climbs, confirmations = _Climbs(model), 2 * max_iterations
    history: list[tuple[int, list[float]]] = []
    is_searched = max_iterations > 0 and bool(climbs.climbs)
    for iteration in itertools.count():
        is_extra = iteration >= max_iterations
        if not is_extra or tolerances:
            climbs.run()
        surrogates = model.surrogates() if iteration or is_extra else climbs.fill()
        bounds = [
            _bounds(climbs, q, s, mispredictions[q], is_searched) for q, s in enumerate(surrogates)
        ]
        unmet = _find_unmet(bounds, tolerances, len(model.points), history)
        points = _infill(unmet if is_extra else bounds)
        if not is_extra:
            points += _find_deciding_points(model, bounds, specs, 0 if iteration else _BORDER_RUNS)
        if unmet and (is_extra or not points):
            points += [*_spread(model, max(LANES, len(model.points) // 4))]
        if is_extra and not points and confirmations > 0:
            confirmations -= 1
            points = _find_deciding_points(model, bounds, specs)
        if not points or not _grow(model, points):
            return _follow_ends(climbs, bounds, mispredictions) if is_searched else bounds
        mispredictions = _mispredictions(model, bounds, mispredictions)
    raise AssertionError  # iterations end above


def _turning_points(model: ModelEvaluator) -> list[np.ndarray]:
    """Unit points (k) at which an expression of the structure's file turns back or bends as one
    parameter varies: others nominal, then as in the runs at which a quantity is least, largest;
    and where those of several parameters meet, as the peaks of a product do, or one meets the end
    of an interval."""
    experiment, points = model.experiment, []
    numbers = [values for values in model.numbers.T if np.isfinite(values).any()]
    rows = [find(values) for values in numbers for find in (np.nanargmin, np.nanargmax)]
    bases = [model.nominal, *model.points[list(dict.fromkeys(rows))]]
    nominal, turns = dict(zip(experiment.intervals, experiment.nominal, strict=True)), []
    for j, (name, interval) in enumerate(experiment.intervals.items()):
        arguments = experiment.parameters(nominal), name, interval.lower, interval.upper
        values = experiment.scene_type.find_turns(*arguments)
        ends = np.interp(values, arguments[2:], (-1.0, 1.0))
        pairs = itertools.islice(itertools.product(bases, ends), _MOST_TURNS)
        points += [np.where(np.arange(len(base)) == j, end, base) for base, end in pairs]
        turns.append(ends if len(ends) else [model.nominal[j], -1.0, 1.0])
    peaks = itertools.islice(itertools.product(*turns), _MOST_TURNS if points else 0)
    return [*points, *map(np.array, peaks)]


def _find_unmet(
    bounds: Sequence[QuantityBounds], tolerances: Sequence[float], count: int,
    history: list[tuple[int, list[float]]],
) -> list[QuantityBounds]:  # fmt: skip
    """Bounds whose errors exceed what is asked for, and have fallen since there were half as many
    runs as the `count` that there are now. history: numbers of runs with errors, which grows."""
    if not tolerances:
        return []
    shares = [b.relative_error for b in bounds]
    previous = [row for number, row in history if 2 * number <= count]
    limits = previous[-1] if previous else [np.inf] * len(shares)
    history.append((count, shares))
    rows = zip(bounds, shares, limits, tolerances, strict=True)
    return [b for b, share, limit, most in rows if most < share <= _STAGNANT * limit]


def _spread(model: ModelEvaluator, count: int) -> np.ndarray:
    """Unit points (count, k) spread over the box, after as many others as there are runs."""
    return scan_points(model.experiment.box.free, len(model.points) + count, corners=False)[-count:]


def _grow(model: ModelEvaluator, points: Sequence[np.ndarray] | np.ndarray) -> bool:
    """Add runs at points (P, k), and tell whether there was one to be added."""
    count = len(model.points) + len(model.failures)
    model.add(points)
    return len(model.points) + len(model.failures) > count


def _is_rough(surrogate: Any) -> bool:
    """Return whether a quantity does not exist in all runs, or its fit is not close."""
    if surrogate.fit is None or surrogate.occurrence.is_mixed:
        return True
    values = surrogate.fit.values
    least = max(_ROUGH * np.ptp(values), ROUNDING * np.abs(values).max())
    return bool(surrogate.usual_error > least)


class _Climbs:
    """Local searches for the bounds of all quantities, which make their runs side by side."""

    def __init__(self, model: ModelEvaluator) -> None:
        is_wide = model.points.shape[1] > MOST_FULL
        quantities = [] if is_wide else model.experiment.quantity_list
        self.model, self.climbs = model, [(Climb(-1.0), Climb(1.0)) for _ in quantities]
        self.margin_climbs = [Climb(1.0) for _ in quantities]  # where an event may begin to occur

    def missing_points(self, surrogates: Sequence[Any]) -> np.ndarray:
        """Points (P, k) of runs that tell whether searches missed a part of the box: none where all
        quantities are smooth; else the corners, if these are few, and points spread over the
        box, so that there are eight runs for each parameter (of many that vary more than two at
        once); where a quantity has no value and no
        margin in any run four times as many, eight for each parameter at a time."""
        model = self.model
        if not self.climbs or not any(map(_is_rough, surrogates)):
            return model.points[:0]
        box = model.experiment.box
        corners = box.corners() if box.free.sum() <= _CORNER_DIRECTIONS else model.points[:0]
        corners = model.find_missing(corners)
        is_blank = any(
            s.fit is None and not np.isfinite(margin).all()
            for s, margin in zip(surrogates, model.margins.T, strict=True)
        )
        total = _PARAMETER_RUNS * int(box.free.sum())
        present = int(is_general(model.points).sum()) + len(corners)
        count = min((_MOST_SPREAD if is_blank else 1) * total - present, total)
        if count <= 0:
            return np.reshape(corners, (-1, len(box.free)))
        spread = _spread(model, len(corners) + count)[-count:]
        return np.concatenate([*[point[None] for point in corners], spread])

    def fill(self) -> list[Any]:
        """Make the missing runs, go on from these, and return the surrogates of all runs."""
        surrogates = self.model.surrogates()
        while _grow(self.model, self.missing_points(surrogates)):
            self.run()
            surrogates = self.model.surrogates()
        return surrogates

    def run(self) -> None:
        """Search until no search promises a gain, or most of the remaining runs are made. The rest
        is kept for limit-state surfaces, and for places where other bounds may be."""
        model = self.model
        count = len(model.refinements)
        most = count + _MOST_SHARE * (model.max_refinements - count)
        for _ in range(_MOST_CLIMBS):
            if len(model.refinements) >= most:
                break
            points = []
            for pair, margin_climb, values, margins in zip(
                self.climbs, self.margin_climbs, model.numbers.T, model.margins.T, strict=False
            ):
                if np.isfinite(values).any():
                    points += [climb.propose(model.points, values, margins) for climb in pair]
                elif np.isfinite(margins).all():  # which tell where there is a value
                    points.append(margin_climb.propose(model.points, margins))
            if not _grow(model, [point for point in points if point is not None]):
                break

    def remainders(self, q: int) -> tuple[float, float]:
        """Return by how much the lower and the upper bound of quantity `q` may be exceeded because
        the limit on runs ended its searches."""
        if not self.climbs or not self.climbs[q][0]:
            return 0.0, 0.0
        lower, upper = self.climbs[q]
        return lower.remainder, upper.remainder


def _bounds(
    climbs: _Climbs, q: int, surrogate: Any, mispredictions: np.ndarray, is_searched: bool,
    is_grown: bool | None = None,
) -> QuantityBounds:  # fmt: skip
    """Bounds of one quantity; what runs attain where they were searched (`is_searched`)."""
    model, remainders = climbs.model, climbs.remainders(q)
    surrogate_range, values = surrogate.range(), model.numbers[:, q]
    if not np.isfinite(values).any():
        no_point = np.full(model.points.shape[1], np.nan)
        return QuantityBounds(surrogate, surrogate_range, np.nan, np.nan, no_point, no_point)
    rows = int(np.nanargmin(values)), int(np.nanargmax(values))
    lower, upper = (float(values[row]) for row in rows)
    estimates: Any = estimate_bounds(
        surrogate, model.points, values, tuple(mispredictions), is_grown
    )
    if is_searched:
        estimates = tuple(  # with their errors at least what they differ by, but at the runs' end
            e if e.value == surrogate.latest
            else e._replace(value=value, error=max(e.error, abs(e.value - value)))
            for e, value in zip(estimates, (lower, upper), strict=True)
        )  # fmt: skip
    if is_grown and not surrogate.occurrence.is_mixed:  # else the end of the runs stands for it
        estimates = estimates[0], estimates[1]._replace(error=np.inf)
    tolerance = TOLERANCE * max(upper - lower, surrogate_range.width)
    unconverged = surrogate_range.low < lower - tolerance, surrogate_range.high > upper + tolerance
    first, last = model.points[list(rows)]
    return QuantityBounds(
        surrogate, surrogate_range, lower, upper, first, last, estimates, unconverged, remainders,
        is_grown,
    )  # fmt: skip


def _follow_ends(
    climbs: _Climbs, bounds: list[QuantityBounds], mispredictions: np.ndarray
) -> list[QuantityBounds]:
    """Return the bounds by all runs, with what further ones tell of times that may grow without an
    end: those whose upper bound has an error, or lies beside where they cease."""
    count = len(climbs.model.points)
    verdicts = [
        grows_without_end(climbs.model, q, b.argmax, b.upper - b.lower) if b.is_growing else None
        for q, b in enumerate(bounds)
    ]
    if set(verdicts) == {None} and len(climbs.model.points) == count:
        return bounds
    rows = zip(climbs.model.surrogates(), mispredictions, verdicts, strict=True)
    return [_bounds(climbs, q, *row[:2], True, row[2]) for q, row in enumerate(rows)]


def _infill(bounds: Sequence[QuantityBounds]) -> list[np.ndarray]:
    """Unit points (k) of the next runs for some quantities."""
    points = []
    for b in bounds:
        points += [point for estimate in b.estimates for point in estimate.points]
        if b.surrogate.occurrence.open_fraction > _MIN_FRACTION:
            points += list(b.surrogate.occurrence.infill_points(_SURFACE))
    return points


def _find_deciding_points(
    model: ModelEvaluator, bounds: Sequence[QuantityBounds], specs: Sequence[LimitSpec],
    border_runs: int | None = None,
) -> list[np.ndarray]:  # fmt: skip
    """Unit points (k) that decide limits of all quantities, where no run was made: their worst
    places, where runs may fail nearest to the nominal values, and, if `border_runs` is a number,
    the border of a limit that jumps there, which no fit tells, and so many points about one that a
    fit tells: no run between the levels of a grid tests a fit to it."""
    if not specs:
        return []
    assessment = assess_limits(model, [b.surrogate for b in bounds], specs)
    has_borders = border_runs is not None
    points = list(assessment.points)
    if assessment.doubt is not None:
        border, spare = assessment.limits[-1].surrogate.occurrence, model.spare_failures
        points += [assessment.doubt] if spare > 0 else []
        points += [*border.infill_points(_FAILURE_POINTS if has_borders and spare > _SPARE else 0)]
    for limit in assessment.limits[: len(specs)] if has_borders else []:
        if (border := limit.run_border) is not None:
            is_open = border.open_fraction > _MIN_FRACTION
            points += list(border.infill_points(_SURFACE if is_open else 0))
        elif limit.surrogate.fit is not None:
            points += list(limit.fitted_border.infill_points(border_runs or 0))
    return model.find_missing(points)


def _mispredictions(
    model: ModelEvaluator, bounds: list[QuantityBounds], previous: np.ndarray
) -> np.ndarray:
    """Errors (q, 2) of surrogates' bounds against runs there, inf without number; or `previous`."""
    mispredictions = previous.copy()
    for q, b in enumerate(bounds):
        r = b.surrogate_range
        for side, (value, point) in enumerate(((r.low, r.argmin), (r.high, r.argmax))):
            if b.unconverged[side]:
                row, distance = model.nearest(point)
                difference = abs(model.numbers[row, q] - value)
                if distance <= SAME_POINT:
                    mispredictions[q, side] = difference if np.isfinite(difference) else np.inf
    return mispredictions
