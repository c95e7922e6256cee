"""Where in the box requirements are met, limits that numbers must keep; and the choice of some
parameters that meets them best, by the worst case over the intervals about it."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import scipy

from ..designs import scan_points
from .fits import choose_fit
from .occurrence import FittedOccurrence, NearestOccurrence, Occurrence, border_of_runs
from .surrogate import ScalarSurrogate

_LINES, _ON_LINE, _ON_ONE_LINE = 2048, 65, 4097
_GROUPS = 8  # of lines, whose means tell the error of all lines
_MISSED_LINES = 3.0  # of lines that all satisfy the limits, so many in all may be missed, at 95 %
_STUDENT = 2.36  # deviations of a mean that 8 groups tell: 95 % of Student's t
_BLOCK, _RIVAL_SHARE = 64, 4  # lines; of one in so many the other kind of fits is evaluated, too
_BISECTIONS = 24  # for the scale up to which limits are satisfied
_NEXT, _TINY = 16, 1e-300  # runs next to a border; a distance from it that is none
_CLEARLY = 0.5  # of what a fit leaves open: a border by runs that leaves less is taken instead
_RANGE = 2.0  # factor between numbers from which their logarithms are fitted, too
_FACTOR, _LEAST_COUNT = 2.0, 5  # times the volume of so many runs at least, told wrongly: likewise
_PART = 2.0**0.5  # of a border that counts in part, fewer stretches err each by itself
_RIVALRY = 10.0  # times the errors of the fit: kinds that predict worse have no say in proportion
_FIT_SHARE = 0.8  # of what errors of fits alone change, in several directions, where they cancel
_NEAREST_SAY = 2.5  # times what the border of the nearest runs changes: two deviations, calibrated
_STRETCHES = 5.0  # of a border: with more than these the nearest runs say less
_ROUNDING = 1e-9  # of the width of the runs: by so much an extreme may be beyond a limit
_OUTLOOK, _BATCHES = 512, 8  # lines along a halved interval at first; their sets, each by itself
_MOST_VALUES = 40_000_000  # points on such lines, times runs
_WORTH, _LEAST_WORTH = 0.25, 0.05  # of a gain, of what fails: errors of enough lines


@dataclass(frozen=True)
class Limit:
    """A limit that a quantity (a number of each run) must satisfy, and what is known of the
    quantity: its `surrogate`, None where only values of runs are compared (`find_margins`). kind:
    "at_most" or "at_least" a `level`, in the quantity's unit, or "happens", with level 1 if the
    event must occur and 0 if it must not; run_error: error of the runs themselves, as by mesh and
    step, in the quantity's unit; border_error: their error in the decision function, by which the
    event occurs (`Occurrence.decision`); infinite if finer runs differ in whether it does;
    by_nearest: whether a border that only runs tell is that of the nearest runs."""

    surrogate: Any
    kind: str
    level: float
    run_error: float = 0.0
    border_error: float = 0.0
    is_rival: bool = False

    def conditions(
        self, points: np.ndarray, cache: dict | None = None, has_errors: bool = True
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Functions that are not below 0 where the limit is satisfied, at `points` (P, k) in [-1,
        1]^k: a list of one or two pairs of values (P) and their errors (P), by which volume
        fractions are uncertain. The first is of whether
        the quantity exists (of "happens" with level 0: does not), by its decision function
        (`Occurrence.decision`); the second of its distance from the level, in its unit, left out of
        "happens" and where no run has the quantity. cache: what limits of the same surrogates
        gave at these points, which is filled; has_errors: whether errors are computed, else they
        are 0 where that takes long."""
        surrogate, cache = self.surrogate, {} if cache is None else cache

        def evaluate(function: Callable, is_error: bool = False) -> np.ndarray:
            if is_error and not has_errors:
                return np.zeros(len(points))
            key = id(surrogate), function.__name__
            return cache[key] if key in cache else cache.setdefault(key, function(points))

        decision = evaluate(surrogate.occurrence.decision)
        open_band = evaluate(surrogate.occurrence.usual_band, True) + self.border_error
        if np.isinf(self.border_error):  # all runs agree, and finer ones do not
            decision, open_band = np.sign(decision), np.full(len(points), 2.0)
        if self.kind == "happens":
            return [(decision if self.level else -decision, open_band)]
        if surrogate.fit is None:
            return [(decision, open_band)]
        if type(surrogate.occurrence) is Occurrence:
            open_band = _PART * open_band
        if self.border is not None:
            border = self.border
            error = np.zeros(len(points))
            if has_errors:
                error = border.usual_band(points) + self.run_error * self._steepness
            return [(decision, open_band), (border.decision(points), error)]
        sign = 1.0 if self.kind == "at_most" else -1.0
        margin = sign * (self.level - evaluate(surrogate.predict))
        error = evaluate(surrogate.fit.usual_errors, True) + self.run_error
        return [(decision, open_band), (margin, error)]

    @cached_property
    def rival(self) -> "Limit | None":
        """The limit with the other kind of fits (`ScalarSurrogate.rival`), and with the borders of
        the nearest runs where only runs tell them; None without such."""
        if self.surrogate is None:
            return None
        rival, border = self.surrogate.rival or self.surrogate, self.surrogate.occurrence
        if type(border) is Occurrence and border.is_mixed:
            nearest = NearestOccurrence(border.points, border.happens)
            rival = replace(rival, occurrence=nearest)
        has_border = self.kind != "happens" and self.border is not None
        if has_border:  # which the fit of values does not tell
            rival = replace(rival, fit=self.surrogate.fit)
        if rival is self.surrogate and not has_border:
            return None
        return replace(self, surrogate=rival, is_rival=True)

    @cached_property
    def rivalry(self) -> float:
        """How much the other kind of fits has to say, from 0 to 2: less where it predicts left-out
        runs far worse, as a spline does where a polynomial is exact. The nearest runs have as much
        as of two deviations, and less where many stretches of a border err each by itself."""
        borders = self.surrogate.occurrence, self.kind != "happens" and self.border
        counts = [x.stretch_count for x in borders if type(x) is Occurrence and x.is_mixed]
        if counts:
            return _NEAREST_SAY * min(1.0, (_STRETCHES / min(counts)) ** 0.5)
        fits = [getattr(x, "fit", None) for x in (borders[1] or self.surrogate, borders[0])]
        pairs = [(fit.mean_error, fit.rival.mean_error) for fit in fits if fit and fit.rival]
        ratios = [_RIVALRY * mean / rival_mean for mean, rival_mean in pairs if rival_mean > 0]
        return min(1.0, max(ratios, default=1.0))

    @cached_property
    def border(self) -> Any:
        """The border between where the level is kept and where not, if the fit of values does not
        give it: that of the runs alone (`run_border`) where it leaves shares less uncertain than
        the fit does, or that by the fit of logarithms (`fitted_border`)."""
        border, fit = self.run_border, self.surrogate.fit
        if fit is None:
            return None
        by_fit = self.fitted_border
        if border is not None and border.usual_open_fraction < by_fit.usual_open_fraction:
            return NearestOccurrence(border.points, border.happens) if self.is_rival else border
        if by_fit.fit is fit or not by_fit.is_mixed:
            return None
        return replace(by_fit, fit=by_fit.fit.rival or by_fit.fit) if self.is_rival else by_fit

    @cached_property
    def run_border(self) -> Occurrence | None:
        """The border by runs alone, about which further runs are made, where that leaves less of
        the box open than the fit of values does, or than the volume next to runs whose side the fit
        to all others tells wrongly, as beside steps, plateaus and jumps; None elsewhere."""
        if self.surrogate.fit is None:
            return None
        by_fit = self.fitted_border
        border, level = border_of_runs(by_fit.points, by_fit.happens), by_fit.latest
        if not border.is_mixed:
            return None
        values, left_out = by_fit.fit.values, by_fit.fit.left_out
        is_wrong = (values - left_out > level) != (values > level)
        is_wrong &= np.abs(left_out) > _ROUNDING * np.ptp(values)
        most = _CLEARLY * by_fit.open_fraction
        if is_wrong.sum() >= _LEAST_COUNT:
            most = max(most, _FACTOR * float(is_wrong @ border.cells))
        return border if border.open_fraction < most else None

    @cached_property
    def fitted_border(self) -> FittedOccurrence:
        """The border by the fit between where the quantity, which has one, keeps the level and
        where not; or by a fit of logarithms, in which products are sums, where numbers have the
        sign of the level, differ by more than a factor of 2, and less is open."""
        fit, sign = self.surrogate.fit, 1.0 if self.kind == "at_most" else -1.0
        is_kept = self.find_margins(fit.values) >= 0
        border = FittedOccurrence(fit.points, is_kept, fit, fit.error, self.level)
        ratios = fit.values / self.level if self.level else 0.0 * fit.values
        if border.is_mixed and ratios.max() > _RANGE * ratios.min() > 0:
            logs = choose_fit(fit.points, sign * np.sign(self.level) * np.log(ratios))
            by_logs = FittedOccurrence(logs.points, logs.values <= 0, logs, logs.error, 0.0)
            border = min(border, by_logs, key=lambda x: x.usual_open_fraction)
        return border

    @cached_property
    def _steepness(self) -> float:
        """Change of the border's decision function for one of the quantity, by the runs next to
        the border."""
        fit = self.surrogate.fit
        decision = np.abs(self.border.decision(fit.points))
        rows = np.argsort(decision, kind="stable")[:_NEXT]
        return float(
            np.median(decision[rows] / np.maximum(np.abs(self.level - fit.values[rows]), _TINY))
        )

    @property
    def rounding(self) -> float:
        """By how much an extreme may lie beyond the level by rounding alone, in its unit."""
        return 0.0 if self.surrogate.fit is None else _ROUNDING * np.ptp(self.surrogate.fit.values)

    @property
    def error(self) -> float:
        """Error of the quantity, in its unit: the surrogate's (NaN without fit) plus the runs'."""
        return self.surrogate.error + self.run_error

    @cached_property
    def size(self) -> float:
        """What margins are compared as shares of, whatever the unit: the size of the level, or of 0
        the range of the quantity in the runs."""
        fit = self.surrogate.fit
        is_zero = self.kind != "happens" and not self.level and fit is not None
        return float(np.ptp(fit.values)) or 1.0 if is_zero else abs(self.level) or 1.0

    def forecast(self, points: np.ndarray) -> np.ndarray:
        """Limit margins (P) at `points` (P, k) in [-1, 1]^k, as `find_margins` has them."""
        return self.find_margins(self.surrogate.evaluate(points))

    def find_margins(self, values: np.ndarray) -> np.ndarray:
        """Limit margins (...) of values (...) of the quantity, NaN where it does not exist:
        distance from the level, below 0 where the limit is violated; minus infinity without a
        value. Of a limit "happens" it is plus or minus infinity."""
        values = np.asarray(values, dtype=float)
        is_number = np.isfinite(values)
        if self.kind == "happens":
            return np.where(is_number == bool(self.level), np.inf, -np.inf)
        sign = 1.0 if self.kind == "at_most" else -1.0
        return np.where(is_number, sign * (self.level - np.where(is_number, values, 0.0)), -np.inf)

    def worst(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """Least limit margin over the part of the box from `lower` to `upper` (k each, in [-1, 1]),
        and the point (k) where: the distance from the level, below 0 where violated; minus infinity
        if the quantity is absent somewhere; of "happens" plus (satisfied) or minus infinity."""
        return self._end(lower, upper, worst=True)

    def best(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """Largest limit margin over the part of the box from `lower` to `upper` (k each, in [-1,
        1]), and the point (k) where: the distance from the level, below 0 if violated; minus
        infinity if the quantity is nowhere; of "happens" plus (met somewhere) or minus infinity."""
        return self._end(lower, upper, worst=False)

    def _end(self, lower: np.ndarray, upper: np.ndarray, worst: bool) -> tuple[float, np.ndarray]:
        surrogate, middle = self.surrogate, (lower + upper) / 2
        if self.kind == "happens":
            point = surrogate.find_place(lower, upper, bool(self.level) != worst)
            feasible = (point is None) == worst
            return (np.inf if feasible else -np.inf), middle if point is None else point
        if worst and (point := surrogate.find_place(lower, upper, False)) is not None:
            return -np.inf, point
        sign = 1.0 if (self.kind == "at_most") == worst else -1.0
        value, point = surrogate.end(sign, lower, upper)
        if not np.isfinite(value):
            return -np.inf, middle
        return (self.level - value if self.kind == "at_most" else value - self.level), point


@dataclass(frozen=True)
class EventLimit(Limit):
    """A limit "happens" whose margin tells by how much the event occurs, or does not: its decision
    function over the error of that, so that 1 is as much as the error; infinite where all runs
    agree."""

    @property
    def error(self) -> float:
        return 1.0

    @cached_property
    def size(self) -> float:
        occurrence = self.surrogate.occurrence
        margins = self.forecast(occurrence.points) if occurrence.is_mixed else np.ones(1)
        return float(np.ptp(margins)) or 1.0

    def forecast(self, points: np.ndarray) -> np.ndarray:
        occurrence = self.surrogate.occurrence
        decision = occurrence.decision(points) * (1.0 if self.level else -1.0)
        if not occurrence.is_mixed:
            return decision
        return decision / np.maximum(occurrence.band(points), np.finfo(float).tiny)

    def worst(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        point = (lower + upper) / 2
        if self.surrogate.occurrence.is_mixed:
            _, point = self.surrogate.decision_end(-1.0 if self.level else 1.0, lower, upper)
        return float(self.forecast(point[None])[0]), point


def sub_box(nominal: np.ndarray, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Shrink the box [-1, 1]^k towards a nominal point (k) in it: returns the lower and the upper
    corner (k each); scale: factor of all its sides, from 0 (the point) to 1."""
    nominal = np.asarray(nominal, dtype=float)
    return nominal + scale * (-1.0 - nominal), nominal + scale * (1.0 - nominal)


def find_least_scales(nominal: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Least scale factors (P) at which the box [-1, 1]^k, shrunk towards a nominal point (k) by
    `sub_box`, still contains each of the `points` (P, k) in it."""
    offset = np.asarray(points, dtype=float) - nominal
    room = np.where(offset > 0, 1.0 - nominal, 1.0 + nominal)
    return np.divide(np.abs(offset), room, out=np.zeros_like(offset), where=room > 0).max(axis=1)


def share_of_box(
    limits: Sequence[Limit],
    free: np.ndarray,
    lower: np.ndarray | float = -1.0,
    upper: np.ndarray | float = 1.0,
    lines: int = _LINES,
) -> tuple[float, float]:
    """Volume fraction of the box in which all limits are satisfied, and its uncertainty: of one set
    of limits what `shares_of_box` tells of several."""
    return shares_of_box([limits], free, lower, upper, lines)[0]


def shares_of_box(
    sets: Sequence[Sequence[Limit]],
    free: np.ndarray,
    lower: np.ndarray | float = -1.0,
    upper: np.ndarray | float = 1.0,
    lines: int = _LINES,
) -> list[tuple[float, float]]:
    """Volume fractions of the box in which all limits of a set are satisfied, and uncertainties: by
    how much these change by the errors of `Limit.conditions`, calibrated on boxes of known
    fractions (about twice the deviation), or, if that is more, by the other kind of fits. Measured
    on one line in one dimension, on many lines spread over the box in several, whose parts differ
    by so much that the deviation of their mean counts, too; borders of where limits are satisfied
    are found on each by linear interpolation, whose error every other point tells. All is certain
    only if the worst case satisfies all limits; else three lines may be missed.

    sets: sets of limits, which evaluate surrogates that they share once; free: mask (k) of the
    directions with a width; lower, upper: corners (k each), in [-1, 1]^k, of the part of the box
    that counts; lines: how many are spread over it. Returns of each set the fraction and its
    uncertainty, both from 0 to 1."""
    free, shares = np.asarray(free, dtype=bool), [(0.0, 0.0)] * len(sets)
    single = free.sum() == 1
    count = _ON_ONE_LINE if single else _ON_LINE
    line = np.linspace(-1.0, 1.0, count) if free.any() else np.zeros(3)
    corners = [np.where(free, end, (lower + upper) / 2) for end in (lower, upper)]
    # The lines go along the direction with the largest differences.
    directions = [int(np.argmax(free)) if single else _steepest(limits, free) for limits in sets]
    for direction in sorted(set(directions)):
        numbers = [i for i in range(len(sets)) if directions[i] == direction]
        start_axes = free.copy()
        start_axes[direction] = False
        starts = scan_points(start_axes, lines if start_axes.any() else 1, corners=False)
        fractions, changes = [], []
        pairs = [(sets[i], _rivals(sets[i])) for i in numbers]
        for first in range(0, len(starts), _BLOCK):
            points = np.repeat(starts[first : first + _BLOCK, None], len(line), axis=1)
            points[:, :, direction] = line
            flat = lower + 0.5 * (points.reshape(-1, len(free)) + 1.0) * (upper - lower)
            is_tested = first <= len(starts) // _RIVAL_SHARE
            parts, differences = _compare(pairs, flat, len(line), is_tested)
            fractions.append(parts)
            changes += [differences] * is_tested
        all_parts = np.concatenate(fractions, axis=2)
        means, deviations = all_parts.mean(axis=2).tolist(), _deviations(all_parts[:, 0]).tolist()
        sizes = np.abs(np.concatenate(changes, axis=1).mean(axis=1)).tolist()
        for i, row, change, deviation in zip(numbers, means, sizes, deviations, strict=True):
            fraction, least, most, coarse = row
            open_ = max(most - fraction, fraction - least, change)
            open_ = open_ * _fit_share(sets[i], free) + abs(coarse - fraction)
            if fraction == 1 and len(starts) > 1 and not _is_kept(sets[i], *corners):
                open_ += _MISSED_LINES / len(starts)
            shares[i] = fraction, float(np.hypot(open_, _STUDENT * deviation))
    return shares


def _fit_share(limits: Sequence[Limit], free: np.ndarray) -> float:
    """Share of what errors change that counts: less where all are those of fits, which cancel in
    several directions."""
    is_whole = free.sum() == 1 or any(limit.run_error or limit.border_error for limit in limits)
    return 1.0 if is_whole else _FIT_SHARE


class Halving(NamedTuple):
    """Share of the box that satisfies all limits if one interval is half as wide about the nominal
    value, and the gain over the whole interval; each with its uncertainty, from 0 to 1."""

    share: float
    share_uncertainty: float
    gain: float
    gain_uncertainty: float


def find_halving(limits: Sequence[Limit], free: np.ndarray, nominal: np.ndarray, j: int) -> Halving:
    """Find what halving the interval of index `j` gains, on lines along it through the whole box,
    so that much of the error of a share cancels in the gain. Uncertainties are those of the fits
    (`shares_of_box`) and the deviation by sets of lines, each scrambled by itself, which are
    added while it exceeds a quarter of the gain and a twentieth of what fails. All is certain only
    if the worst case of the halved box satisfies all limits; else three lines may be missed. free,
    nominal (k each): as elsewhere, normalized."""
    ends = np.array([nominal[j] - 1.0, nominal[j] + 1.0]) / 2.0
    start_axes = np.where(np.arange(len(free)) == j, False, free)
    cells = 8 if start_axes.any() else 1024
    stretches = (-1.0, ends[0], cells), (*ends, 2 * cells), (ends[1], 1.0, cells)
    line = np.unique(np.concatenate([np.linspace(a, b, n + 1) for a, b, n in stretches]))
    middles, lengths = (line[1:] + line[:-1]) / 2, np.diff(line)
    is_inside = (middles > ends[0]) & (middles < ends[1])
    weights = np.array([lengths * is_inside, lengths / 2]).T  # of the half, and of the whole
    most = _MOST_VALUES // (len(line) * max(len(x.surrogate.occurrence.points) for x in limits))
    count, shares, changes = (_OUTLOOK if start_axes.any() else 1), np.zeros((0, 2)), []
    size = max(count // _BATCHES, 1)
    while True:
        sets = range(len(shares) // size, count // size)
        starts = np.concatenate(
            [scan_points(start_axes, size, seed=i, corners=False) for i in sets]
        )
        signs = (0,) if len(shares) else (0, -1, 1)
        for first in range(0, len(starts), _BLOCK):
            points = np.repeat(starts[first : first + _BLOCK, None], len(line), axis=1)
            points[:, :, j] = line
            cache: dict = {}
            points = points.reshape(-1, len(free))
            parts = _met(limits, points, cache, len(line), signs, weights)
            if signs[1:]:
                rivals, rivalry = _rivals(limits)
                parts += _met(rivals, points, cache, len(line), (0,), weights) if rivals else []
                scales = (1.0, 1.0, 1.0, rivalry)
                rows = zip(parts[1:], scales[1:], strict=False)
                changes.append([scale * np.mean(row - parts[0], axis=0) for row, scale in rows])
            shares = np.concatenate([shares, parts[0]])
        fit_errors = _halving_errors(np.mean(changes, axis=0), _fit_share(limits, free))
        share, gain = _with_gains(shares.mean(axis=0))
        means = _with_gains(shares.reshape(-1, size, 2).mean(axis=1))
        errors = np.zeros(2)
        if count > 1:
            student = scipy.special.stdtrit(len(means) - 1, 0.975)
            errors = student * means.std(axis=0, ddof=1) / len(means) ** 0.5
        target = max(_WORTH * gain, _LEAST_WORTH * (1.0 - share + gain), *fit_errors)
        if 2 * count > most or count == 1 or errors.max() <= target:
            break
        count *= 2
    lower, upper = -np.asarray(free, dtype=float), np.asarray(free, dtype=float)
    lower[j], upper[j] = ends
    errors = np.hypot(errors, fit_errors)
    is_sure = share < 1 or _is_kept(limits, lower, upper)
    errors[0] = max(errors[0], 0.0 if is_sure else _MISSED_LINES / count)
    return Halving(*map(float, (share, errors[0], gain, errors[1])))


def _is_kept(limits: Sequence[Limit], lower: np.ndarray, upper: np.ndarray) -> bool:
    """Whether the worst case of the part of the box between corners satisfies all limits."""
    return all(limit.worst(lower, upper)[0] >= -limit.rounding for limit in limits)


def _halving_errors(changes: np.ndarray, fit_share: float) -> np.ndarray:
    """Errors of the share of the halved box and of the gain, by changes (n, 2) of the shares of the
    halved and of the whole box; fit_share: what counts of the first (`_fit_share`). The two halves
    of the box, within and about the halved interval, err each by itself: the gain is half their
    difference."""
    # The share of the whole box is the mean of those of both halves: whole = (halved + rest) / 2.
    halved, rest = np.abs(changes[:, 0]), np.abs(2.0 * changes[:, 1] - changes[:, 0])
    return np.array([fit_share * halved.max(), np.hypot(halved, rest).max() / 2.0])


def _with_gains(shares: np.ndarray) -> np.ndarray:
    """Pairs (..., 2) of the shares of halved and whole boxes as pairs of share and gain."""
    return np.stack([shares[..., 0], shares[..., 0] - shares[..., 1]], axis=-1)


def _deviations(parts: np.ndarray) -> np.ndarray:
    """Standard deviations (n) of the means of parts (n, L) of lines, by those of groups of lines
    that follow each other; each group is spread over the box."""
    if parts.shape[1] < _GROUPS:
        return np.zeros(len(parts))
    means = np.array([group.mean(axis=1) for group in np.array_split(parts, _GROUPS, axis=1)])
    return means.std(axis=0, ddof=1) / np.sqrt(_GROUPS)


def _compare(
    pairs: Sequence[tuple[Sequence[Limit], tuple[list[Limit], float]]], points: np.ndarray,
    count: int, is_tested: bool,
) -> tuple[list, list]:  # fmt: skip
    """Parts of lines on which each set of limits is satisfied, plus 0, -1 and 1 errors, by every
    other point, and, where that `is_tested`, by how much the rivals of a set change the first."""
    cache: dict = {}
    parts = []
    for limits, _ in pairs:
        conditions = _conditions(limits, points, cache, count)
        coarse = [(values[:, ::2], error[:, ::2]) for values, error in conditions]
        rows = [_parts_met(conditions, sign) for sign in (0, -1, 1)] + [_parts_met(coarse, 0)]
        parts.append([row.mean(axis=1) for row in rows])
    differences = [
        rivalry * (_met(rivals, points, cache, count, (0,))[0] - part[0])
        if rivals else 0.0 * part[0]
        for (_, (rivals, rivalry)), part in zip(pairs, parts, strict=True) if is_tested
    ]  # fmt: skip
    return parts, differences


def _rivals(limits: Sequence[Limit]) -> tuple[list[Limit], float]:
    """Return the limits with the other kind of fits, none where no limit has such, and the most
    that one of these has to say (`Limit.rivalry`)."""
    rivals = [limit.rival for limit in limits]
    rivalry = max((limit.rivalry for limit in limits if limit.rival), default=0.0)
    if not rivalry:
        return [], 0.0
    return [rival or limit for limit, rival in zip(limits, rivals, strict=True)], rivalry


def _met(
    limits: Sequence[Limit], points: np.ndarray, cache: dict, count: int, signs: Sequence[int],
    weights: np.ndarray | None = None,
) -> list[np.ndarray]:  # fmt: skip
    """Return the parts (L) of lines on which all limits, plus `sign` errors, are satisfied, for
    each of the `signs`. points (L count, k): `count` points on each line. With `weights` (count -
    1, m) of the stretches, which otherwise count equally, return sums (L, m)."""
    weights = np.full(count - 1, 1.0 / (count - 1)) if weights is None else weights
    conditions = _conditions(limits, points, cache, count, any(signs))
    return [_parts_met(conditions, sign) @ weights for sign in signs]


def _conditions(
    limits: Sequence[Limit], points: np.ndarray, cache: dict, count: int, with_errors: bool = True
) -> list[tuple[np.ndarray, ...]]:
    """Values and errors (L, S) of all limits on lines of `count` points each."""
    return [
        tuple(array.reshape(-1, count) for array in row)
        for limit in limits
        for row in limit.conditions(points, cache, with_errors)
    ]


def _parts_met(conditions: Sequence[tuple[np.ndarray, ...]], sign: int) -> np.ndarray:
    """Parts (L, S - 1) of stretches of lines on which values plus `sign` errors (L, S) are >= 0."""
    start, end = np.zeros((1, 1)), np.ones((1, 1))
    for values, error in conditions:
        if sign:
            values = np.where(np.isfinite(values), values + sign * error, values)
        # Infinity has a sign only; it changes half way between two points.
        size = np.abs(values[np.isfinite(values)]).max(initial=1.0)
        values = np.clip(values, -size, size)
        a, b = values[:, :-1], values[:, 1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            border = a / (a - b)
        start = np.maximum(start, np.where(a >= 0, 0.0, np.where(b >= 0, border, 1.0)))
        end = np.minimum(end, np.where(b >= 0, 1.0, np.where(a >= 0, border, 0.0)))
    return np.maximum(end - start, 0.0)


def _steepest(limits: Sequence[Limit], free: np.ndarray) -> int:
    """Return the direction along which what decides changes most, as shares of all its change."""
    rows, total = np.flatnonzero(free), np.zeros(len(free))
    ends = np.zeros((2 * len(rows), len(free)))
    ends[np.arange(len(rows)), rows], ends[len(rows) + np.arange(len(rows)), rows] = -1.0, 1.0
    for limit in limits:
        for values, _ in limit.conditions(ends):
            if len(rows) and np.isfinite(values).all():
                change = np.abs(np.diff(values.reshape(2, -1), axis=0)[0])
                total[rows] += change / (change.sum() or 1.0)
    return int(np.argmax(np.where(free, total, -1.0)))


def find_max_scale(
    limits: Sequence[Limit], nominal: np.ndarray
) -> tuple[float, int | None, np.ndarray | None]:
    """Largest scale factor (0 to 1) at which all of the box, shrunk towards the nominal point (k)
    in [-1, 1]^k, satisfies every one of `limits` (at least one); with the index of the limit that
    is violated first beyond it and the point (k) where, both None if it is 1. It is 0 where the
    nominal point itself violates one."""

    def is_kept(scale: float) -> bool:
        return all(limit.worst(*sub_box(nominal, scale))[0] >= 0 for limit in limits)

    if is_kept(1.0):
        return 1.0, None, None
    low, high = 0.0, 1.0 if is_kept(0.0) else 0.0
    for _ in range(_BISECTIONS if high else 0):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_kept(middle) else (low, middle)
    worst = [limit.worst(*sub_box(nominal, high)) for limit in limits]
    index = min(range(len(limits)), key=lambda i: worst[i][0] / limits[i].size)
    return low, index, worst[index][1]


_GRID, _ZOOM_GRID, _SPREAD = 33, 7, 128
_FINEST = 3e-7  # of a range: the finest grid of choices reaches no farther

# From choices (c) to the corners (k each), in unit coordinates, of the box that they leave.
BoxOf = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


ENDS = ("upper", "lower", "width")
"""What of a number's interval may be a goal."""


@dataclass(frozen=True)
class Goal:
    """An objective of a choice of parameters: the bound ("upper", "lower") or the "width" (`kind`)
    of a quantity's range over the box that the choice leaves, by its surrogate. sign: 1: minimise,
    -1: maximise."""

    surrogate: ScalarSurrogate
    kind: str
    sign: float = 1.0

    def value(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """Value of the objective, without sign, over the box from `lower` to `upper` (k each, in
        [-1, 1]), and the points of its bound, (1, k), of a width of both, (2, k)."""
        if self.kind == "width":
            interval = self.surrogate.range(lower, upper, climbs=1)
            return interval.width, np.array([interval.argmin, interval.argmax])
        value, point = self.surrogate.end(1.0 if self.kind == "upper" else -1.0, lower, upper)
        return value, point[None]

    def forecast(self, points: np.ndarray) -> float:
        """Value that the objective is no better than, from where its bound may be: `points`, (1, k)
        or (2, k), in the box."""
        values = self.surrogate.evaluate(points)
        value = np.ptp(values) if self.kind == "width" else values[0]
        can_tell = (self.sign > 0) == (self.kind != "lower") and np.isfinite(value)
        return float(value) if can_tell else -self.sign * np.finfo(float).max


@dataclass(frozen=True)
class Choice:
    """Chosen parameter `values` (c), in their units, and how good they are in the worst case of the
    box about them. goals (g): of the objectives; margin: least margin of all limits, as a share of
    their sizes (`Limit.size`), infinite without any; margins (l): least margin of each limit,
    attained at points `worst` (l, k) in [-1, 1]^k; goal_points: g arrays of the points where each
    objective's bounds are attained, (1, k), of a width (2, k); safety: least margin over its error,
    infinite where no limit has both."""

    values: np.ndarray
    goals: np.ndarray
    margin: float
    margins: np.ndarray
    worst: np.ndarray
    goal_points: list[np.ndarray]
    safety: float = np.inf

    @property
    def is_allowed(self) -> bool:
        """Whether the whole box that the choice leaves satisfies all limits."""
        return bool((self.margins >= 0).all())

    @property
    def is_safe(self) -> bool:
        """Whether the box that the choice leaves satisfies all limits by their errors or more."""
        return self.is_allowed and self.safety >= 1


@dataclass(frozen=True)
class ChoiceProblem:
    """A choice of c parameter values that satisfies `limits` in all of the box that it leaves, with
    the best worst case of the first of `goals` there (robust optimisation). ranges: least and
    largest of each value (c pairs); box: function of the values (c) that returns the lower and
    upper corner (k each, in [-1, 1]) of the box that they leave; room: by how many errors the best
    choice is to satisfy each limit."""

    goals: Sequence[Goal]
    limits: Sequence[Limit]
    ranges: Sequence[tuple[float, float]]
    box: BoxOf
    room: float = 1.0

    def judge(self, values: np.ndarray) -> Choice:
        """Evaluate goals and limits in the worst case for chosen values (c)."""
        choice = self._judge(np.asarray(values, dtype=float), lambda choice: False, True)
        assert choice is not None
        return choice

    @cached_property
    def _choices(self) -> dict[bytes, Choice]:
        return {}

    def _judge(self, values: np.ndarray, rank: Callable[[Choice], Any], most: Any) -> Choice | None:
        """Evaluate goals and limits in turn; None once the rank, which further ones do not lower,
        is not below `most`."""
        if (choice := self._choices.get(values.tobytes())) is not None:  # grids share points
            return choice if rank(choice) < most else None
        lower, upper = self.box(values)
        choice = Choice(values, np.zeros(0), np.inf, np.zeros(0), np.zeros((0, len(lower))), [])
        items: list[Goal | Limit] = [*self.goals, *self.limits]
        for item in items:
            goals, margins = choice.goals, choice.margins
            if isinstance(item, Goal):
                value, points = item.value(lower, upper)
                choice = replace(choice, goal_points=[*choice.goal_points, points])
                goals = np.append(goals, value)
            else:
                value, point = item.worst(lower, upper)
                choice = replace(choice, worst=np.concatenate([choice.worst, [point]]))
                margins = np.append(margins, value)
            choice = self.weigh(choice, goals, margins)
            if not rank(choice) < most:
                return None
        self._choices[values.tobytes()] = choice
        return choice

    def _forecast(self, values: np.ndarray, best: Choice) -> Choice:
        """Return a choice that is at least as good as that of `values` (c): judged only at the
        places of its box that correspond to those that decide the choice `best`."""
        (low, high), (lower, upper) = self.box(best.values), self.box(values)
        scale = (upper - lower) / np.where(high > low, high - low, 1.0)

        def move(points: np.ndarray) -> np.ndarray:
            return np.clip(lower + (points - low) * scale, lower, upper)

        goals = [
            goal.forecast(move(points))
            for goal, points in zip(self.goals, best.goal_points, strict=True)
        ]
        margins = [
            limit.forecast(move(point[None]))[0]
            for limit, point in zip(self.limits, best.worst, strict=True)
        ]
        return self.weigh(best, goals, margins)

    def weigh(
        self, choice: Choice, goals: Sequence | np.ndarray, margins: Sequence | np.ndarray
    ) -> Choice:
        """Return a choice with other `goals` (g) and `margins` (l), of the first goals and limits,
        and what follows from them."""
        margin_array, goal_array = np.array(margins, dtype=float), np.array(goals, dtype=float)
        limits = self.limits[: len(margin_array)]
        errors = np.array([limit.error for limit in limits])
        is_finite = np.isfinite(margin_array)
        has_error = is_finite & ~np.isnan(errors)
        least_errors = np.maximum(errors[has_error], np.finfo(float).tiny)
        safety = float((margin_array[has_error] / least_errors).min(initial=np.inf))
        shares = margin_array / np.array([limit.size for limit in limits])
        if (shares[is_finite] < 0).any():  # which tells how far it is, as infinity does not
            shares = shares[is_finite]
        least = float(shares.min(initial=np.inf))
        return replace(choice, goals=goal_array, margins=margin_array, margin=least, safety=safety)

    def find_best(self) -> tuple[Choice, list[Choice]]:
        """Choose the values with the best first goal that satisfy every limit with room. If there
        are none, choose those with the largest margins over their errors, or, if no choice
        satisfies all limits, those that violate them least, as shares of their sizes. A grid of
        choices (from three values on a Sobol sequence) is searched, then finer ones about the best.
        Returns the choice, and all choices of the first grid."""

        def rank(choice: Choice) -> tuple[int, float]:
            if not choice.is_allowed:
                return 2, -choice.margin
            has_room = choice.safety >= self.room
            value = self.goals[0].sign * choice.goals[0] if has_room else -choice.safety
            return 0 if has_room else 1, value if np.isfinite(value) else np.inf

        trials = [self.judge(point) for point in self._grid()]
        return self._refine(trials, rank), trials

    def find_safest(self, trials: Sequence[Choice], best: Choice) -> Choice:
        """Choose the values whose least limit margin is the most times its error
        (`Choice.safety`); if no choice satisfies all limits, those that violate them least.
        Searched on finer and finer grids from the best of `trials`, all that were tried. Values
        that gain no more than the errors of two margins stay as in the choice `best`."""

        def rank(choice: Choice) -> tuple[bool, float]:
            return not choice.is_allowed, -choice.safety if choice.is_allowed else -choice.margin

        safest = self._refine(trials, rank)
        for i in range(len(self.ranges)):
            values = np.where(np.arange(len(self.ranges)) == i, best.values, safest.values)
            trial = self.judge(values)
            if trial.is_allowed and trial.safety >= safest.safety - 2:
                safest = trial
        return safest

    def find_safe_range(self, best: Choice, index: int) -> tuple[float, float]:
        """Range (least, largest) of one chosen value, of index `index`, about that of the safe
        choice `best`, all other values kept, in which all limits are satisfied by their errors; it
        ends where one is not, or with the range that is allowed. A gap narrower than a 16th of the
        way to an end is not noticed."""

        problem = replace(self, goals=())

        def is_safe(value: float) -> bool:
            values = np.where(np.arange(len(best.values)) == index, value, best.values)
            return problem._judge(values, lambda choice: not choice.is_safe, True) is not None

        ends = []
        for end in self.ranges[index]:
            safe_value = best.values[index]
            for value in np.linspace(safe_value, end, 17)[1:]:
                if not is_safe(value):
                    for _ in range(10):
                        middle = (safe_value + value) / 2
                        if is_safe(middle):
                            safe_value = middle
                        else:
                            value = middle
                    break
                safe_value = value
            ends.append(float(safe_value))
        return ends[0], ends[1]

    def _grid(self) -> np.ndarray:
        """Values (n, c) to be tried first: a grid, or from three on a Sobol sequence."""
        ends = np.array(self.ranges, dtype=float)
        wide = ends[:, 1] > ends[:, 0]
        if len(ends) <= 2:
            count = _GRID if len(ends) == 1 else _ZOOM_GRID + 6
            sizes = [count if free else 1 for free in wide]
            lines = [np.linspace(a, b, size) for (a, b), size in zip(ends, sizes, strict=True)]
            return np.array(list(itertools.product(*lines)))
        points = (scan_points(wide, _SPREAD) + 1) / 2
        return ends[:, 0] + points * (ends[:, 1] - ends[:, 0])

    def _refine(self, trials: Sequence[Choice], rank: Callable[[Choice], tuple]) -> Choice:
        """Return the choice of the lowest rank: the best of `trials`, then of finer and finer
        grids."""
        ends = np.array(self.ranges, dtype=float)
        wide = ends[:, 1] > ends[:, 0]
        best = min(trials, key=rank)
        reach = 1.5 / len(trials) ** (1 / len(ends))
        steps = np.linspace(-1.0, 1.0, _ZOOM_GRID if len(ends) == 1 else 3)
        while reach > _FINEST:
            for offset in itertools.product(*[steps if free else [0.0] for free in wide]):
                steps_away = reach * np.array(offset) * (ends[:, 1] - ends[:, 0])
                point = np.clip(best.values + steps_away, ends[:, 0], ends[:, 1])
                if rank(self._forecast(point, best)) < rank(best):
                    best = self._judge(point, rank, rank(best)) or best
            reach *= 0.45 if len(ends) == 1 else 0.6
        return best
