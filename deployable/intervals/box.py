"""The box of interval parameters, and the map between it and the unit cube [-1, 1]^k."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .errors import IntervalError

MAX_DIMENSION = 8


@dataclass(frozen=True)
class Box:
    """Interval parameters: names (k), lower (k) and upper (k) in the units of the parameters.

    An interval may have zero width: its parameter then keeps its one value, and its unit
    coordinate is 0 everywhere.
    """

    names: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray

    def __init__(self, names: Sequence[str], lower: Sequence[float], upper: Sequence[float]):
        names = (names,) if isinstance(names, str) else tuple(names)
        lower = np.array(lower, dtype=float, ndmin=1)
        upper = np.array(upper, dtype=float, ndmin=1)
        if not 1 <= len(names) <= MAX_DIMENSION:
            raise IntervalError("intervals", names, f"1 to {MAX_DIMENSION} names")
        if len(set(names)) != len(names):
            raise IntervalError("intervals", names, "names that differ from each other")
        if lower.shape != (len(names),) or upper.shape != (len(names),):
            found = (lower.shape, upper.shape)
            raise IntervalError("lower, upper", found, f"one number for each of {list(names)}")
        for name, low, high in zip(names, lower, upper, strict=True):
            if not (np.isfinite(low) and np.isfinite(high)):
                raise IntervalError(f"interval {name}", (low, high), "finite numbers")
            if low > high:
                raise IntervalError(f"interval {name}", (low, high), "lower <= upper")
        lower.setflags(write=False)
        upper.setflags(write=False)
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", upper)

    @property
    def dimension(self) -> int:
        """Number of parameters k, those of zero width included."""
        return len(self.names)

    @property
    def free(self) -> np.ndarray:
        """Mask (k) of the intervals that have a width."""
        return self.upper > self.lower

    def to_unit(self, values: np.ndarray) -> np.ndarray:
        """Unit coordinates (..., k) of parameter values (..., k); 0 where the width is zero."""
        values = np.asarray(values, dtype=float)
        width = np.where(self.free, self.upper - self.lower, 1.0)
        unit = ((values - self.lower) - (self.upper - values)) / width
        return np.where(self.free, unit, 0.0)

    def from_unit(self, unit: np.ndarray) -> np.ndarray:
        """Parameter values (..., k) of unit coordinates (..., k).

        -1 and 1 give exactly `lower` and `upper`, and equal unit coordinates give equal values
        to the last bit: runs are recognised by their values.
        """
        unit = np.asarray(unit, dtype=float)
        values = self.lower * ((1.0 - unit) / 2.0) + self.upper * ((1.0 + unit) / 2.0)
        inside = (np.abs(unit) <= 1.0) & self.free
        values = np.where(inside, np.clip(values, self.lower, self.upper), values)
        return np.where(self.free, values, self.lower)

    def corners(self) -> np.ndarray:
        """Unit coordinates (2^f, k) of the corners, f the number of intervals with a width."""
        choices = [(-1.0, 1.0) if free else (0.0,) for free in self.free]
        return np.array(list(itertools.product(*choices)))
