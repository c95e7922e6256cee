"""Designs on parts of the box: the same polynomials, piece by piece (multi-element)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import IntervalError
from .design import Design


@dataclass(frozen=True)
class Part:
    """A design on the part [lower, upper] (k each) of the unit box."""

    lower: np.ndarray
    upper: np.ndarray
    design: Design

    def to_global(self, local: np.ndarray) -> np.ndarray:
        """Unit coordinates (..., k) of the box, of local coordinates (..., k) in [-1, 1]."""
        return self.lower * ((1.0 - local) / 2.0) + self.upper * ((1.0 + local) / 2.0)

    def to_local(self, unit: np.ndarray) -> np.ndarray:
        """Local coordinates (..., k) of unit coordinates (..., k)."""
        wide = self.upper > self.lower
        width = np.where(wide, self.upper - self.lower, 1.0)
        return np.where(wide, ((unit - self.lower) - (self.upper - unit)) / width, 0.0)

    def contains(self, unit: np.ndarray) -> np.ndarray:
        """Mask (P) of the unit coordinates (P, k) inside, the surface included."""
        return ((unit >= self.lower - 1e-12) & (unit <= self.upper + 1e-12)).all(axis=1)

    @property
    def points(self) -> np.ndarray:
        """Unit coordinates (N, k) of the design's points."""
        return self.to_global(self.design.points)


@dataclass(frozen=True)
class SplitDesign:
    """Designs on parts that together cover the box; it can stand wherever a Design does."""

    parts: tuple[Part, ...]

    @property
    def points(self) -> np.ndarray:
        """Unit coordinates (N, k) of all the points, each once."""
        points = np.concatenate([part.points for part in self.parts])
        _, first = np.unique(np.round(points, 12) + 0.0, axis=0, return_index=True)
        return points[np.sort(first)]

    @property
    def runs(self) -> int:
        """Number of different points."""
        return len(self.points)

    @property
    def dimension(self) -> int:
        """Number of directions k."""
        return self.parts[0].design.dimension

    @property
    def method(self) -> str:
        """Method of the parts."""
        return self.parts[0].design.method

    @property
    def order(self) -> tuple[int, ...]:
        """Highest order of each direction (k)."""
        return tuple(np.max([part.design.order for part in self.parts], axis=0).tolist())


def split_design(
    design: Design, boxes: Sequence[tuple[Sequence[float], Sequence[float]]]
) -> SplitDesign:
    """The same design on each of `boxes`, pairs (lower (k), upper (k)) of unit coordinates."""
    if not len(design.multi_indices):
        raise IntervalError("design", design.method, "a design with an order, to be split")
    parts = []
    for lower, upper in boxes:
        lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
        shape = (design.dimension,)
        if lower.shape != shape or upper.shape != shape or not (lower <= upper).all():
            raise IntervalError("part", (lower, upper), "lower <= upper for each direction")
        parts.append(Part(lower, upper, design))
    return SplitDesign(tuple(parts))


def parts_of(design: Design | SplitDesign) -> tuple[Part, ...]:
    """The parts; a plain design is one part, the whole box."""
    if isinstance(design, SplitDesign):
        return design.parts
    ones = np.ones(design.dimension)
    return (Part(-ones, ones, design),)
