"""Range of a surrogate over the box, at every instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .ascent import inner_range
from .enclosures import effects_enclosure, grid_enclosure
from .line_range import line_range
from .surrogate import Surrogate


@dataclass(frozen=True)
class Range:
    """Outer and inner range of a surrogate; every array has the surrogate's trailing shape (...).

    Attributes
    ----------
    lower, upper
        Guaranteed: the polynomial stays within them over the whole box.
    inner_lower, inner_upper
        Attained: the polynomial takes these values at `argmin` and `argmax`. In one dimension they
        differ from the outer range by rounding only.
    argmin, argmax
        (..., k) unit coordinates.
    """

    lower: np.ndarray
    upper: np.ndarray
    inner_lower: np.ndarray
    inner_upper: np.ndarray
    argmin: np.ndarray
    argmax: np.ndarray

    @property
    def gap(self) -> np.ndarray:
        """By how much the outer range may be too wide, (...): the sum over both sides."""
        return (self.inner_lower - self.lower) + (self.upper - self.inner_upper)


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
        other_lower, other_upper = grid_enclosure(c, indices)
        lower, upper = np.maximum(lower, other_lower), np.minimum(upper, other_upper)
        # an enclosure and an attained value can cross by rounding only
        lower, upper = np.minimum(lower, low), np.maximum(upper, high)
    return Range(
        lower.reshape(shape),
        upper.reshape(shape),
        low.reshape(shape),
        high.reshape(shape),
        argmin.reshape(*shape, k),
        argmax.reshape(*shape, k),
    )
