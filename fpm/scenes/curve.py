"""Curves of time: numbers by which loads, drives, motors, winches and gravity are scaled.

Between two of its points, with the fraction f of the way from one to the next, a curve is

    v0 + f (v1 - v0) + d1 f + d2 f² + ...,   d1 + d2 + ... = 0,

so that it is continuous, and its integral and derivatives are exact. Without d it is a table,
linear between its values. Smooth tables are Fritsch and Carlson's monotone cubics (SIAM J. Numer.
Anal. 17, 1980), which pass no value between two points, as a natural spline would; slopes are zero
at both ends, beyond which curves are constant. Functions become one polynomial, or as many as it
takes, by interpolation at Chebyshev's points."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

TOL = 1e-12
"""Largest error of a function's polynomials, as a share of its largest absolute value."""

PLACES = 4000
"""Number of places at which a function is compared with its polynomials, at least."""

COARSE, FINEST, MOST_PLACES = 256, 30, 20_000
"""Of places where a function may bend: in how many intervals its parts are looked at first, how
often the distance of the places beside such a place is halved, and how many places there may be."""

MOST_PIECES = 4000
"""Number of polynomials of a curve, at most."""

SHORTEST, STEEP = 2.0**-50, 1e-9
"""Length of the shortest polynomial, as a share of the whole, and error (as TOL) above which the
function jumps there."""

KINK = 1e-6
"""Jump of the rate of a smooth curve that counts as a kink, as a share of its largest rate."""

SMALL, JUMP, IMPULSE, PARTS = 0.02, 1e-5, 1e-7, 8
"""Of features: the least height, as a share of the whole range; the longest jump and the longest
impulse, as shares of the duration; into how many parts of a polynomial they are looked at."""

NODES = np.polynomial.chebyshev.chebpts1(12) / 2 + 0.5
"""Chebyshev's points, between 0 and 1, at which the deviation over f (1 - f) is interpolated."""

_TO_CHEBYSHEV = np.linalg.inv(np.polynomial.chebyshev.chebvander(2 * NODES - 1, len(NODES) - 1))
_TO_POWERS = np.zeros((len(NODES), len(NODES)))
for _k in range(len(NODES)):
    _TO_POWERS[: _k + 1, _k] = Chebyshev.basis(_k, [0, 1]).convert(kind=Polynomial).coef


class CurveError(ValueError):
    """Raised for a function that no curve follows; its text says where and why."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A continuous curve of time, polynomial between its points and constant beyond both ends.
    times (p,): of its points (s), increasing; values (p,): at them, in the unit of what refers to
    the curve; powers (p, k): of the piece after each point, the coefficients d of f, f², ... (see
    above), which add up to 0; k = 0: linear pieces."""

    times: np.ndarray
    values: np.ndarray
    powers: np.ndarray

    @staticmethod
    def table(times: np.ndarray, values: np.ndarray) -> "Curve":
        """Return the curve that is straight between values (p,) at increasing times (p,), s."""
        return Curve(times, values, np.zeros((len(times), 0)))

    @staticmethod
    def smooth(times: np.ndarray, values: np.ndarray) -> "Curve":
        """Return the cubic curve through values (p,) at increasing times (p,), s, with a continuous
        rate that is 0 at both ends; between two points it passes none of their values."""
        from scipy.interpolate import PchipInterpolator

        powers = np.zeros((len(times), 3))
        slopes = np.zeros(len(times))
        if len(times) > 2:
            slopes[1:-1] = PchipInterpolator(times, values)(times[1:-1], 1)
        steps, rises = np.diff(times), np.diff(values)
        first, last = slopes[:-1] * steps - rises, rises - slopes[1:] * steps
        powers[:-1] = np.transpose([first, last - 2 * first, first - last])
        return Curve(times, values, powers)

    @staticmethod
    def fit(
        function: Callable[[float], float],
        start: float,
        end: float,
        parts: Sequence[Callable[[float], float]] = (),
    ) -> "Curve":
        """Return the curve that follows function(u), u going from 0 to 1 from time `start` to `end`
        (s), with errors of TOL times its largest value. parts: functions of u of which it is made,
        inner ones first. What is narrower than a 4000th part may be missed where no part vanishes
        or turns within twice its width. CurveError where it jumps, is too steep, or takes too many
        polynomials."""
        places = (np.arange(PLACES) + 0.5) / PLACES
        sample_values = {u: function(u) for u in places}
        for u in _places_of(parts):
            with suppress(CurveError):  # as where 0 is divided by 0
                sample_values[u] = function(u)
        places, samples = np.transpose(sorted(sample_values.items()))
        tol = TOL * max(np.abs(samples).max(), abs(function(0.0)), abs(function(1.0)))
        rounding = 2e-16 * max(1.0, max(abs(start), abs(end)) / (end - start))
        shortest = max(SHORTEST, 8e-16 * max(abs(start), abs(end)) / (end - start))
        points, powers, rest = [(0.0, function(0.0))], [], [(1.0, function(1.0))]
        while rest:
            (u0, v0), (u1, v1) = points[-1], rest[-1]
            fractions, width = np.concatenate([NODES, (np.arange(7) + 0.5) / 7]), u1 - u0
            values = np.array([function(u0 + width * f) for f in fractions])
            span = slice(*np.searchsorted(places, [u0, u1]))
            fractions = np.append(fractions, (places[span] - u0) / width)
            deviations = np.append(values, samples[span]) - v0 - fractions * (v1 - v0)
            nodes = deviations[: len(NODES)] / (NODES * (1 - NODES))
            coefficients = _TO_CHEBYSHEV @ nodes
            coefficients = _TO_POWERS @ np.where(np.abs(coefficients) > 1e-3 * tol, coefficients, 0)
            piece = np.append(coefficients, 0.0) - np.append(0.0, coefficients)
            values = fractions * np.polynomial.polynomial.polyval(fractions, piece)
            error = np.abs(values - deviations).max()
            noise = 4 * rounding / width * np.ptp(deviations + fractions * (v1 - v0))
            noise = min(noise, STEEP / TOL * tol)
            if error <= tol + noise or (width < 2 * shortest and error <= STEEP / TOL * tol):
                points.append(rest.pop())
                powers.append(piece)
            elif width < 2 * shortest or len(points) + len(rest) > MOST_PIECES:
                text = "jumps, or is too steep"
                if width >= 2 * shortest:
                    text = f"has taken {MOST_PIECES} polynomials already, the most there may be"
                raise CurveError(f"at {start + u0 * (end - start):.9g} s it {text}")
            else:
                rest.append(((u0 + u1) / 2, function((u0 + u1) / 2)))
        places, values = np.transpose(points)
        table = np.array([*powers, np.zeros(len(NODES) + 1)])
        degree = np.flatnonzero(table.any(axis=0)).max(initial=1)
        return Curve(start + places * (end - start), values, table[:, : degree + 1])

    def value(self, time: float | np.ndarray) -> np.ndarray:
        """Return the values at times (s), in the shape of `time`."""
        value = np.interp(time, self.times, self.values)
        if not self.powers.size:
            return value
        time = np.clip(time, self.times[0], self.times[-1])
        k = np.searchsorted(self.times[1:-1], time, side="right")
        f = (time - self.times[k]) / np.append(np.diff(self.times), 1.0)[k]
        return value + f * np.polynomial.polynomial.polyval(f, self.powers[k].T, tensor=False)

    def rate_after(self, time: float, factor: float = 1.0) -> float:
        """Return the rate (1/s) just after a time (s), times a factor."""
        piece = int(np.searchsorted(self.times, time, side="right"))
        if not 0 < piece < len(self.times):
            return 0.0
        step = self.times[piece] - self.times[piece - 1]
        f, powers = (time - self.times[piece - 1]) / step, self.powers[piece - 1]
        rise = self.values[piece] - self.values[piece - 1]
        order = np.arange(1, len(powers) + 1)
        return float(factor * (rise + (order * powers) @ f ** (order - 1)) / step)

    @cached_property
    def sums(self) -> np.ndarray:
        """Integrals (p,), s, from time 0 to each point after 0; 0 at the others."""
        areas = self._area(np.arange(len(self.times) - 1), self.times[1:])
        return np.cumsum(np.append(self.values[0] * max(self.times[0], 0.0), areas))

    def _area(self, k, time):
        """Integrals (s) over pieces k, from their starts, if these are not before 0, to times (s)
        in them; 0 where these are earlier. k, time: one or several."""
        start, step = np.maximum(self.times[k], 0.0), self.times[k + 1] - self.times[k]
        end = np.maximum(time, start)
        middle = (0.5 * (start + end) - self.times[k]) / step
        area = (end - start) * (self.values[k] + middle * (self.values[k + 1] - self.values[k]))
        for j, power in enumerate(self.powers[k].T, 2):
            f0, f1 = (start - self.times[k]) / step, (end - self.times[k]) / step
            area = area + step * power / j * (f1**j - f0**j)
        return area

    def integral(self, time: float) -> float:
        """Return the integral (s) from time 0 to a time (s), which is 0 or later."""
        if time <= self.times[0]:
            return float(self.values[0] * time)
        if time >= self.times[-1]:
            duration = time - max(self.times[-1], 0.0)
            return float(self.sums[-1] + self.values[-1] * duration)
        k = int(np.searchsorted(self.times, time, side="right")) - 1
        return float(self.sums[k] + self._area(k, time))

    def kick_mean(self, time: float, step: float) -> float:
        """Return the mean over a step (s) about a time (s), not before 0, as kernels take it."""
        start, end = max(time - 0.5 * step, 0.0), time + 0.5 * step
        return (self.integral(end) - self.integral(start)) / (end - start)

    def find_feature(self, duration: float) -> float:
        """Return the length (s) of the finest feature until `duration` (s), or infinity: the least
        time in which the curve, at its steepest, makes all of a rise or fall, or that between the
        middles of a rise and the fall beside it. Not smaller than SMALL of the range, faster than
        JUMP, or shorter than IMPULSE of the duration."""
        if len(self.times) < 2:
            return np.inf
        parts = PARTS if self.powers.size else 1
        ends = self.times[:-1, None] + np.diff(self.times)[:, None] * np.arange(parts) / parts
        times = np.clip(np.append(ends, self.times[-1]), 0.0, duration)
        values = self.value(times)
        lengths, changes = np.diff(times), np.diff(values)
        keep = lengths > 0
        lengths, changes = lengths[keep], changes[keep]
        first = np.flatnonzero(np.diff(np.sign(changes), prepend=np.nan) != 0)
        if not len(first):
            return np.inf
        sizes, middles = np.abs(changes), 0.5 * (times[1:] + times[:-1])[keep]
        heights = np.add.reduceat(sizes, first)
        is_large = heights > SMALL * np.ptp(values)
        spans = heights[is_large] / np.maximum.reduceat(sizes / lengths, first)[is_large]
        moments = np.add.reduceat(sizes * middles, first)[is_large] / heights[is_large]
        is_return = np.diff(np.sign(changes[first][is_large])) != 0
        pulses = np.diff(moments)[is_return]
        spans, pulses = spans[spans > JUMP * duration], pulses[pulses > IMPULSE * duration]
        return float(min(*spans, *pulses, np.inf, np.inf))

    @cached_property
    def kinks(self) -> np.ndarray:
        """Times (p,), s: of the first kink, where the rate jumps, at each point or after it; of a
        table with linear pieces every point is one. Infinite: none follows."""
        if not self.powers.shape[1]:
            return self.times
        rises, steps, powers = np.diff(self.values), np.diff(self.times), self.powers[:-1]
        first = np.append((rises + powers[:, 0]) / steps, 0.0)  # rates after and before points
        last = np.append(0.0, (rises + powers @ np.arange(1, powers.shape[1] + 1)) / steps)
        changes = np.abs(rises) + np.abs(powers).sum(axis=1)
        changes[steps < KINK * steps.sum()] = 0.0  # about a kink, where these are rounding
        is_kink = np.abs(last - first) > KINK * (changes / steps).max(initial=0.0)
        kinks = np.where(is_kink, self.times, np.inf)
        return np.minimum.accumulate(kinks[::-1])[::-1]

    def extremes(self, start: float = -np.inf) -> tuple[float, float]:
        """Return least and largest value from `start` (s) on; 0 but for rounding is 0."""
        values = [self.value(max(start, self.times[0])), *self.values[self.times > start]]
        ends = np.sort([self.values[:-1], self.values[1:]], axis=0)
        reach = np.abs(self.powers[:-1]).sum(axis=1)
        is_beyond = (ends[0] - reach < min(values)) | (ends[1] + reach > max(values))
        for k in np.flatnonzero((reach > 0) & is_beyond & (self.times[1:] > start)):
            slope = self.powers[k] * np.arange(1, self.powers.shape[1] + 1)
            slope[0] += self.values[k + 1] - self.values[k]
            roots = np.clip(np.polynomial.polynomial.polyroots(slope).real, 0, 1)
            times = self.times[k] + roots * (self.times[k + 1] - self.times[k])
            values.extend(self.value(times[times > start]))
        least, largest = float(min(values)), float(max(values))
        rounding = 10 * TOL * max(-least, largest) if self.powers.size else 0.0
        return (
            0.0 if abs(least) < rounding else least,
            0.0 if abs(largest) < rounding else largest,
        )


def _places_of(parts: Sequence[Callable[[float], float]]) -> np.ndarray:
    """Places between 0 and 1 at and beside which functions of u vanish or turn, to see what is
    narrow there; where one does so at a narrow place of another, that one comes first."""
    from scipy.optimize import bisect, minimize_scalar

    distances = np.append(0.0, 0.5 ** np.arange(1, FINEST + 1))
    offsets = np.append(-distances[:0:-1], distances)
    grid = np.unique([*np.linspace(0, 1, COARSE + 1), *distances, *(1 - distances)])
    for part in parts:
        values = np.array([part(u) for u in grid])
        places = []
        for k in np.flatnonzero(values[:-1] * values[1:] < 0):
            with suppress(ValueError):  # no number at a place between
                places.append(bisect(part, grid[k], grid[k + 1], xtol=1e-17, rtol=1e-15))
        steps = np.diff(values)
        for k in np.flatnonzero(steps[:-1] * steps[1:] < 0):
            sign, bounds = np.sign(steps[k + 1]), (grid[k], grid[k + 2])
            turn = minimize_scalar(lambda u, f=part, s=sign: s * f(u), bounds=bounds,
                                   method="bounded", options={"xatol": 1e-15})  # fmt: skip
            places.append(turn.x)
        for place in places[: MOST_PLACES // len(offsets)]:
            if len(grid) < MOST_PLACES and np.abs(grid - place).min() > 1e-15:
                grid = np.append(grid, place + offsets)
        grid = np.unique(np.clip(grid, 0, 1))
    return grid


CONSTANT = Curve.table(np.zeros(1), np.ones(1))
"""The curve that stands for the index -1: constant 1."""
