"""The few places that decide: near which the bounds are attained at most instants.

What a finer model changes is looked at there, since bounds move by what changes where they are
attained. At every instant they are attained somewhere else, and each place costs a run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_INSTANTS = 400  # looked at
_CELLS = 8  # of each direction: places in one cell are told apart no further


@dataclass(frozen=True)
class Places:
    """Places `unit` (P, k) in the box, and which of them is nearest (n, T) to where the lower and
    the upper bound of each response are attained at each instant."""

    unit: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def errors(self, changes: np.ndarray) -> np.ndarray:
        """Errors (n, T) of the bounds from changes (P, n, T) of the responses at the places: the
        larger of those at the places of both bounds."""
        at = np.abs(changes)
        n, instants = np.indices(self.lower.shape)
        return np.maximum(at[self.lower, n, instants], at[self.upper, n, instants])


def deciding_places(
    argmin: np.ndarray, argmax: np.ndarray, width: np.ndarray, count: int
) -> Places:
    """At most `count` places for bounds attained at unit points argmin, argmax (n, T, k).

    Chosen one after the other from these points, each so that the distances from them to the
    nearest place fall most, weighted by the width (n, T) at the instant, a share of the mean one.
    """
    mean = width.mean(axis=1, keepdims=True)
    weight = np.divide(width, mean, out=np.zeros_like(width), where=mean > 0)
    some = np.unique(np.linspace(0, width.shape[1] - 1, min(width.shape[1], _INSTANTS)).astype(int))
    points = np.concatenate([at[:, some].reshape(-1, at.shape[2]) for at in (argmin, argmax)])
    weight = np.tile(weight[:, some].ravel(), 2)
    trial = _one_of_each_cell(points, weight)
    apart = np.linalg.norm(trial[:, None] - points[None], axis=2)
    nearest = np.full(len(points), np.inf)
    chosen: list[int] = []
    for _ in range(min(count, len(trial))):
        left = (np.minimum(apart, nearest) * weight).sum(axis=1)
        best = int(left.argmin())
        if chosen and left[best] >= (nearest * weight).sum() * (1 - 1e-9):
            break
        chosen.append(best)
        nearest = np.minimum(nearest, apart[best])
    unit = trial[chosen]
    return Places(unit, *(_nearest(at, unit) for at in (argmin, argmax)))


def _one_of_each_cell(points: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Of the points (N, k) in each cell of the box, the heaviest."""
    cell = np.round((points + 1) / 2 * _CELLS).astype(int)
    order = np.lexsort((np.arange(len(points)), -weight))
    _, first = np.unique(cell[order], axis=0, return_index=True)
    return points[order[first]]


def _nearest(at: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Index (n, T) of the place (P, k) nearest to each point (n, T, k)."""
    apart = np.stack([((at - place) ** 2).sum(axis=-1) for place in unit])
    return apart.argmin(axis=0)
