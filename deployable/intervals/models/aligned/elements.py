"""Splitting the box where the number of impacts changes: a multi-element surrogate.

Source of the idea: Wan and Karniadakis 2005 (multi-element polynomial chaos); here the box is cut
between runs that differ in their number of impacts, not by a variance criterion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .impacts import common_prefix


@dataclass(frozen=True)
class Element:
    """A part of the unit box, and the runs in it.

    Attributes
    ----------
    lower, upper
        (k) unit coordinates.
    runs
        Indices of the runs inside.
    impacts
        (len(runs), J): the impacts that all of its runs have.
    unresolved_from
        Time in s from which its runs differ in their number of impacts; infinite if they agree.
    """

    lower: np.ndarray
    upper: np.ndarray
    runs: np.ndarray
    impacts: np.ndarray
    unresolved_from: float

    @property
    def volume(self) -> float:
        """Share of the box."""
        width = np.where(self.upper > self.lower, self.upper - self.lower, 2.0)
        return float(np.prod(width / 2))

    def contains(self, unit: np.ndarray) -> np.ndarray:
        """Mask (P) of the unit coordinates (P, k) inside, the surface included."""
        return ((unit >= self.lower - 1e-12) & (unit <= self.upper + 1e-12)).all(axis=1)


def split_elements(
    points: np.ndarray, impacts: Sequence[np.ndarray], free: np.ndarray, minimum: int | None = None
) -> list[Element]:
    """Split the unit box until the runs of each element have the same number of impacts.

    Parameters
    ----------
    points
        Unit coordinates (N, k) of the runs.
    impacts
        Impact times of each run, of any length.
    free
        (k): directions that have a width.
    minimum
        Runs that an element needs; by default one more than there are free directions, which
        determine a linear surrogate. An element that cannot be split further keeps runs that
        disagree, and says from when on.
    """
    free = np.asarray(free, dtype=bool)
    minimum = int(free.sum()) + 1 if minimum is None else minimum
    lower, upper = np.where(free, -1.0, 0.0), np.where(free, 1.0, 0.0)
    counts = np.array([len(x) for x in impacts])
    elements: list[Element] = []

    def grow(low, high, runs):
        cut = _best_cut(points[runs], counts[runs], free, minimum)
        if cut is None:
            table, later = common_prefix([impacts[i] for i in runs])
            elements.append(Element(low, high, runs, table, later))
            return
        direction, value = cut
        middle_high, middle_low = high.copy(), low.copy()
        middle_high[direction] = middle_low[direction] = value
        below = points[runs, direction] < value
        grow(low, middle_high, runs[below])
        grow(middle_low, high, runs[~below])

    grow(lower, upper, np.arange(len(points)))
    return elements


def _best_cut(points, counts, free, minimum):
    """Direction and place of the cut that best separates the counts; None where none helps."""
    if len(np.unique(counts)) == 1:
        return None
    best, cut = _impurity(counts) - 1e-12, None
    for j in np.flatnonzero(free):
        places = np.unique(points[:, j])
        for value in (places[1:] + places[:-1]) / 2:
            below = points[:, j] < value
            if below.sum() < minimum or (~below).sum() < minimum:
                continue
            impurity = _impurity(counts[below]) + _impurity(counts[~below])
            if impurity < best:
                best, cut = impurity, (int(j), float(value))
    return cut


def _impurity(counts) -> float:
    """Gini impurity times the number of runs: 0 where all counts are equal."""
    _, sizes = np.unique(counts, return_counts=True)
    return float(sizes.sum() - (sizes**2).sum() / sizes.sum())


def cut_share(elements: Sequence[Element], points: np.ndarray) -> float:
    """Share of the box between the cuts and the nearest runs on either side of them.

    The number of impacts changes somewhere in these strips; the elements extrapolate into them.
    """
    share = 0.0
    for element in elements:
        inside = points[element.runs]
        for j in range(points.shape[1]):
            width = element.upper[j] - element.lower[j]
            if width > 0:
                below = inside[:, j].min() - element.lower[j] if element.lower[j] > -1 else 0.0
                above = element.upper[j] - inside[:, j].max() if element.upper[j] < 1 else 0.0
                share += element.volume * (below + above) / width
    return min(float(share), 1.0)
