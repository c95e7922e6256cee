"""Range of a polynomial surrogate over the box, at every instant."""

from __future__ import annotations

import numpy as np

from ..surrogate import Surrogate
from .ascent import climb, inner_range
from .bernstein import tighten
from .enclosures import effects_enclosure, grid_enclosure
from .line_range import line_range
from .range import Range


def surrogate_range(surrogate: Surrogate, tolerance: float = 1e-3) -> Range:
    """Range of the surrogate over [-1, 1]^k.

    In one dimension (or where only one direction matters) it is exact to rounding. In several, the
    outer range is the tightest of the enclosures of `enclosures` and `bernstein`, the inner one
    comes from `ascent`; subdivision goes on until the gap is below `tolerance` times the inner
    width, or its budget is spent. The gap is in the result either way.
    """
    indices = surrogate.multi_indices
    shape = surrogate.coefficients.shape[1:]
    k = indices.shape[1]
    c = surrogate.coefficients.reshape(len(indices), -1)
    free = np.flatnonzero(surrogate.degrees > 0)
    if len(free) <= 1:
        j = int(free[0]) if len(free) else 0
        line = np.zeros((int(indices[:, j].max()) + 1, c.shape[1]))
        np.add.at(line, indices[:, j], c)
        low, high, x_low, x_high, slack = line_range(line)
        argmin, argmax = np.zeros((c.shape[1], k)), np.zeros((c.shape[1], k))
        argmin[:, j], argmax[:, j] = x_low, x_high
        lower, upper = low - slack, high + slack
    else:
        low, high, argmin, argmax = inner_range(c, indices)
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
    return Range(
        lower.reshape(shape),
        upper.reshape(shape),
        low.reshape(shape),
        high.reshape(shape),
        argmin.reshape(*shape, k),
        argmax.reshape(*shape, k),
    )


def _tighten(c, surrogate, outer, attained, argument, close):
    """Tighter upper bound, and the attained value and argument, which subdivision may better."""
    dense = Surrogate(c, surrogate.multi_indices).dense()
    outer, value, where = tighten(dense, attained, outer, close)
    better = np.flatnonzero(value > attained)
    if len(better):
        attained, argument = attained.copy(), argument.copy()
        climbed, at = climb(c[:, better], surrogate.multi_indices, where[better])
        attained[better] = np.maximum(value[better], climbed)
        argument[better] = np.where((climbed > value[better])[:, None], at, where[better])
    return outer, attained, argument
