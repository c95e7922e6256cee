"""Ranges over the box: what bounds a function of the parameters, guaranteed or attained.

`find_surrogate_range` is that of a polynomial, `to_range` that of anything else."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from .box import corner_points
from .chebyshev import Surrogate, grid, lobatto, product_basis
from .enclosures import MAX_TENSOR, effects_enclosure, grid_enclosure, tighten
from .line_range import line_range


@dataclass(frozen=True)
class Range:
    """Outer and inner range over the box of what a model gives, arrays of one shape (...). lower,
    upper: guaranteed where the model can be enclosed; inner_lower, inner_upper: attained at
    `argmin` and `argmax` (..., k) in [-1, 1]."""

    lower: np.ndarray
    upper: np.ndarray
    inner_lower: np.ndarray
    inner_upper: np.ndarray
    argmin: np.ndarray
    argmax: np.ndarray

    @property
    def gap(self) -> np.ndarray:
        """By how much (...) outer bounds lie outside the attained ones, both sides together."""
        return (self.inner_lower - self.lower) + (self.upper - self.inner_upper)

    def include(
        self, low: np.ndarray, high: np.ndarray, argmin: np.ndarray, argmax: np.ndarray
    ) -> "Range":
        """Widen the range to values that runs take: `low`, `high` (...), the least and largest of
        them, at `argmin`, `argmax` (..., k); returns a copy."""
        is_lower, is_higher = low < self.inner_lower, high > self.inner_upper
        return Range(
            np.minimum(self.lower, low),
            np.maximum(self.upper, high),
            np.minimum(self.inner_lower, low),
            np.maximum(self.inner_upper, high),
            np.where(is_lower[..., None], argmin, self.argmin),
            np.where(is_higher[..., None], argmax, self.argmax),
        )


def to_range(low: np.ndarray, high: np.ndarray, argmin: np.ndarray, argmax: np.ndarray) -> Range:
    """Make the Range of a model without an enclosure: low, high (...) are attained values, which
    become outer bounds, too; argmin, argmax (..., k): their points in [-1, 1]^k."""
    return Range(low, high, low, high, argmin, argmax)


def spread_out(bounds: Range, columns: np.ndarray) -> Range:
    """Return the range of C columns as that of all responses and instants (n, T), with NaN where
    the mask `columns` (n, T) of the C is False."""

    def place(values: np.ndarray) -> np.ndarray:
        whole = np.full((*columns.shape, *values.shape[1:]), np.nan)
        whole[columns] = values
        return whole

    ends = (bounds.lower, bounds.upper, bounds.inner_lower, bounds.inner_upper)
    a, b, c, d = map(place, ends)
    return Range(a, b, c, d, place(bounds.argmin), place(bounds.argmax))


def clip_bounds(bounds: Range, least: np.ndarray, most: np.ndarray) -> Range:
    """Copy of the range `bounds` with all bounds within `least` and `most`, what the responses can
    be, of shapes that broadcast to (...); -inf, inf where there is no limit."""
    ends = (bounds.lower, bounds.upper, bounds.inner_lower, bounds.inner_upper)
    a, b, c, d = (np.clip(end, least, most) for end in ends)
    return Range(a, b, c, d, bounds.argmin, bounds.argmax)


def find_surrogate_range(surrogate: Surrogate, tolerance: float = 1e-3) -> Range:
    """Bound a polynomial surrogate over [-1, 1]^k. tolerance: gap of enclosed and attained range,
    over the latter's width, that is small enough. Exact in one dimension; in several the outer
    range is the tightest of `enclosures`, the inner one of `find_inner_range`, and subdivision goes
    on until its budget is spent."""
    indices = surrogate.multi_indices
    shape = surrogate.coefficients.shape[1:]
    k = indices.shape[1]
    c = surrogate.coefficients.reshape(len(indices), -1)
    free = np.flatnonzero(surrogate.degrees > 0)
    if len(free) <= 1:
        j = int(free[0]) if len(free) else 0
        line = np.zeros((int(indices[:, j].max()) + 1, c.shape[1]))
        np.add.at(line, indices[:, j], c)
        low, high, x_low, x_high, rounding_error = line_range(line)
        argmin, argmax = np.zeros((c.shape[1], k)), np.zeros((c.shape[1], k))
        argmin[:, j], argmax[:, j] = x_low, x_high
        lower, upper = low - rounding_error, high + rounding_error
    else:
        low, high, argmin, argmax = find_inner_range(c, indices)
        lower, upper = effects_enclosure(c, indices)
        grid_lower, grid_upper = grid_enclosure(c, indices)
        lower, upper = np.maximum(lower, grid_lower), np.minimum(upper, grid_upper)
        close = tolerance / 2 * (high - low)
        upper, high, argmax = _tighten(c, surrogate, upper, high, argmax, close)
        lower, low, argmin = _tighten(-c, surrogate, -lower, -low, argmin, close)
        lower, low = -lower, -low
        # an enclosure and an attained value can cross by rounding only
        lower, upper = np.minimum(lower, low), np.maximum(upper, high)
    if len(free):
        # sums over the coefficients round, those of a large constant and small waves visibly
        rounding = (len(c) + 8) * np.finfo(float).eps * np.abs(c).sum(axis=0)
        lower, upper = lower - rounding, upper + rounding
    ends = (end.reshape(shape) for end in (lower, upper, low, high))
    return Range(*ends, *(points.reshape(*shape, k) for points in (argmin, argmax)))


def _tighten(c, surrogate, outer, inner, argument, close):
    """Tighter upper bound, and the attained value and argument, which subdivision may better."""
    if np.prod(surrogate.degrees + 1.0) > MAX_TENSOR:  # of which the effects are bounds enough
        return outer, inner, argument
    dense = Surrogate(c, surrogate.multi_indices).dense()
    outer, value, vertices = tighten(dense, inner, outer, close)
    better = np.flatnonzero(value > inner)
    if len(better):
        inner, argument = inner.copy(), argument.copy()
        tops, points = climb(c[:, better], surrogate.multi_indices, vertices[better])
        inner[better] = np.maximum(value[better], tops)
        argument[better] = np.where((tops > value[better])[:, None], points, vertices[better])
    return outer, inner, argument


_MAX_GRID = 1024
_SWEEPS = 30  # most passes over all directions
_CHUNK = 1 << 22


def find_inner_range(
    coefficients: np.ndarray, indices: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Find values that T polynomials attain over [-1, 1]^k, as extreme as a search by coordinate
    ascent finds: returns low and high (T), and the points (T, k) of either. coefficients (M, T);
    indices (M, k): degrees of M Chebyshev products."""
    samples = sample_points(indices.max(axis=0))
    basis = product_basis(samples, indices)
    total = coefficients.shape[1]
    low, high = np.empty(total), np.empty(total)
    x_low, x_high = np.empty((total, indices.shape[1])), np.empty((total, indices.shape[1]))
    step = max(_CHUNK // max(len(samples), len(indices) * indices.shape[1]), 1)
    for start in range(0, total, step):
        part = slice(start, start + step)
        c = coefficients[:, part]
        values = basis @ c
        low[part], x_low[part] = climb(-c, indices, samples[values.argmin(axis=0)])
        high[part], x_high[part] = climb(c, indices, samples[values.argmax(axis=0)])
    return -low, high, x_low, x_high


def sample_points(degrees: np.ndarray) -> np.ndarray:
    """Points (P, k) in [-1, 1]^k from which extremes of polynomials of these degrees (k) are
    sought: the Lobatto grid of twice the degrees, at most 1024 of it, with corners and centre."""
    free = degrees > 0
    nodes = [lobatto(2 * int(n)) for n in degrees]
    if np.prod([float(len(x)) for x in nodes]) <= _MAX_GRID:
        return grid(nodes)
    generator = np.random.default_rng(0)
    draws = np.stack([generator.choice(x, _MAX_GRID) for x in nodes], axis=1)
    return np.concatenate([corner_points(free), np.zeros((1, len(free))), draws])


def climb(c: np.ndarray, indices: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Maximize T polynomials by coordinate ascent from points `start` (T, k) in [-1, 1]^k: returns
    local maxima (T), and where (T, k). c (M, T): coefficients; indices (M, k): degrees of the
    Chebyshev products."""
    directions = [j for j in range(indices.shape[1]) if indices[:, j].any()]
    plans = {j: _Plan(indices, j) for j in directions}
    best = np.full(c.shape[1], -np.inf)
    x = start.copy()
    if not directions:
        return c.sum(axis=0), x
    scale = np.abs(c).sum(axis=0)
    active = np.arange(c.shape[1])
    for _ in range(_SWEEPS):
        previous = best[active]
        points, cost = x[active], c[:, active]
        for j in directions:
            line = plans[j].line(cost, points)
            _, value, _, argument, _ = line_range(line)
            points[:, j] = argument
        gain = value > previous  # the last direction's value is that of the whole point
        best[active[gain]] = value[gain]
        x[active[gain]] = points[gain]
        with np.errstate(invalid="ignore"):
            is_rising = ~(value - previous <= 1e-13 * scale[active])
        active = active[is_rising]
        if not len(active):
            break
    return best, x


class _Plan:
    """How to collect the coefficients along one direction, worked out once."""

    def __init__(self, indices: np.ndarray, direction: int) -> None:
        self.axes = [j for j in range(indices.shape[1]) if j != direction and indices[:, j].any()]
        self.order = np.argsort(indices[:, direction], kind="stable")
        self.indices = indices[self.order]
        self.rows, self.starts = np.unique(self.indices[:, direction], return_index=True)

    def line(self, c: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Coefficients (n + 1, T) along the direction through the points x (T, k)."""
        terms = c[self.order]
        for j in self.axes:
            values = chebvander(x[:, j], int(self.indices[:, j].max()))
            terms *= values.T[self.indices[:, j]]
        line = np.zeros((int(self.rows[-1]) + 1, c.shape[1]))
        line[self.rows] = np.add.reduceat(terms, self.starts, axis=0)
        return line
