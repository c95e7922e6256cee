"""Which runs of a scan come next: where a spline through those so far promises wider bounds.

A plain scan spends most of its runs where no bound is attained. Here a spline through all runs is
evaluated at many points; those that would widen the bounds most, summed over all instants, are
taken one after the other, each counted against what the ones before it promise. Every instant has
bounds of its own, so the points spread by themselves.
"""

from __future__ import annotations

import heapq

import numpy as np

from ..models.spline import fit_spline, spread_points

_INSTANTS = 1000  # looked at


def seek_points(
    unit: np.ndarray,
    values: np.ndarray,
    count: int,
    *,
    candidates: int = 16384,
    seed: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Next points (at most `count`, k) of a scan, and the growth that they promise (n).

    `unit` (R, k) and `values` (R, n, T) are the runs so far. Responses count relative to the mean
    width of their bounds, as does the growth: Hausdorff distance, mean over time. Fewer points come
    where no more promise anything. `seed` should differ from round to round.
    """
    instants = np.linspace(0, values.shape[2] - 1, min(values.shape[2], _INSTANTS)).astype(int)
    values = values[:, :, np.unique(instants)]
    width = np.ptp(values, axis=0).mean(axis=1)
    values = values[:, width > 0] / width[width > 0, None]
    spline = fit_spline(unit, values)
    trial = spread_points(spline.scales > 0, candidates, seed)
    free = spline.scales > 0
    # a point next to a run tells nothing new, and two that nearly agree spoil the spline
    spacing = 2.0 * len(spline.points) ** (-1.0 / max(int(free.sum()), 1))
    trial = trial[_far(trial, spline.points, 0.1 * spacing)]
    low, high = values.min(axis=0), values.max(axis=0)
    promised = np.empty((len(trial), *low.shape), dtype=np.float32)
    for start in range(0, len(trial), 1024):
        promised[start : start + 1024] = spline.evaluate(trial[start : start + 1024])
    chosen, new_low, new_high = _greedy(promised, low, high, trial, count, 0.1 * spacing)
    growth = np.zeros(len(width))
    growth[width > 0] = np.maximum(low - new_low, new_high - high).mean(axis=1)
    return trial[chosen], growth


def _greedy(promised, low, high, trial, count, distance):
    """Indices of the best points, and the bounds with them; a gain only shrinks as others come."""
    low, high = low.copy(), high.copy()

    def gain(i):
        return float((np.maximum(promised[i] - high, 0) + np.maximum(low - promised[i], 0)).sum())

    heap = [(-gain(i), i) for i in range(len(promised))]
    heapq.heapify(heap)
    chosen: list[int] = []
    while heap and len(chosen) < count:
        known, i = heapq.heappop(heap)
        now = gain(i)
        if now <= 0:
            continue
        if heap and now < -heap[0][0] and now < -known:
            heapq.heappush(heap, (-now, i))
        elif _far(trial[i : i + 1], trial[chosen], distance)[0]:
            chosen.append(i)
            low, high = np.minimum(low, promised[i]), np.maximum(high, promised[i])
    return chosen, low, high


def _far(points: np.ndarray, others: np.ndarray, distance: float) -> np.ndarray:
    """Mask of the points (P, k) that are farther than `distance` from all others (N, k)."""
    from scipy.spatial import cKDTree

    if not len(others):
        return np.ones(len(points), dtype=bool)
    return cKDTree(others).query(points)[0] > distance
