"""What a range is, of whatever model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Range:
    """Outer and inner range of a model over the box; arrays have the trailing shape (...) of it.

    Attributes
    ----------
    lower, upper
        The bounds: guaranteed where the model can be enclosed, else the attained ones.
    inner_lower, inner_upper
        Attained: the model takes these values at `argmin` and `argmax`.
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


def attained(low: np.ndarray, high: np.ndarray, argmin: np.ndarray, argmax: np.ndarray) -> Range:
    """The range of attained values (...) and their arguments (..., k), without an enclosure."""
    return Range(low, high, low, high, argmin, argmax)


def raised(found: Range, least: np.ndarray) -> Range:
    """The range of a model of something that is never below `least`, whatever the model says."""
    ends = (found.lower, found.upper, found.inner_lower, found.inner_upper)
    return Range(*(np.maximum(end, least) for end in ends), found.argmin, found.argmax)
