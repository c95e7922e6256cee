"""Which runs come next: where bounds are decided, and where they may be wider."""

import heapq
from dataclasses import dataclass

import numpy as np
import scipy

from .designs import spread_points
from .splines import fit_spline

_INSTANTS, _SEEK_INSTANTS = 400, 1000  # looked at
_CELLS = 8  # of each direction: places in one cell are told apart no further


@dataclass(frozen=True)
class BoundPoints:
    """A few `points` (P, k) in [-1, 1]^k that stand for all where bounds are attained, to repeat
    runs there. `lower`, `upper` (n, T): index of the point nearest to where the lower, or upper,
    bound of each response is attained at each instant."""

    points: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def errors(self, changes: np.ndarray) -> np.ndarray:
        """Errors (n, T) of the bounds, from changes (P, n, T) of the n responses at the P points,
        as by a finer mesh: the larger of those at the points of lower and upper bound."""
        sizes = np.abs(changes)
        n, instants = np.indices(self.lower.shape)
        return np.maximum(sizes[self.lower, n, instants], sizes[self.upper, n, instants])


def choose_bound_points(
    argmin: np.ndarray, argmax: np.ndarray, width: np.ndarray, count: int
) -> BoundPoints:
    """Choose at most `count` points that stand for where bounds are attained. argmin, argmax (n, T,
    k) in [-1, 1]^k: where; width (n, T): upper less lower. Each is chosen so that the distances
    from all to the nearest chosen one fall most, weighted by the width over the response's mean."""
    mean = width.mean(axis=1, keepdims=True)
    weight = np.divide(width, mean, out=np.zeros_like(width), where=mean > 0)
    t = np.unique(np.linspace(0, width.shape[1] - 1, min(width.shape[1], _INSTANTS)).astype(int))
    points = np.concatenate([x[:, t].reshape(-1, x.shape[2]) for x in (argmin, argmax)])
    weight = np.tile(weight[:, t].ravel(), 2)
    cell = np.round((points + 1) / 2 * _CELLS).astype(int)  # of each the point of largest weight
    order = np.lexsort((np.arange(len(points)), -weight))
    trial = points[order[np.unique(cell[order], axis=0, return_index=True)[1]]]
    distances = np.linalg.norm(trial[:, None] - points[None], axis=2)
    nearest = np.full(len(points), np.inf)
    indices: list[int] = []
    for _ in range(min(count, len(trial))):
        remainders = (np.minimum(distances, nearest) * weight).sum(axis=1)
        best = int(remainders.argmin())
        if indices and remainders[best] >= (nearest * weight).sum() * (1 - 1e-9):
            break
        indices.append(best)
        nearest = np.minimum(nearest, distances[best])
    normalized = trial[indices]
    squares = (
        np.stack([((x - point) ** 2).sum(axis=-1) for point in normalized])
        for x in (argmin, argmax)
    )
    return BoundPoints(normalized, *(x.argmin(axis=0) for x in squares))


def seek_points(
    points: np.ndarray, values: np.ndarray, count: int, *, candidates: int = 16384, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Find the next points of an adaptive design: where a spline exceeds the bounds most.

    Parameters
    ----------
    points, values: points (R, k) in [-1, 1]^k and responses (R, n, T) of the runs so far.
    count: largest number of points to be returned.
    candidates: number of points at which the spline is evaluated.
    seed: random seed of the candidates; should differ from iteration to iteration.

    Returns
    -------
    tuple of numpy.ndarray
        Points (at most `count`, k), fewer where no more exceed the bounds; and by how much the
        bounds of each response (n) would grow: Hausdorff distance, mean over time, relative to the
        mean width of its bounds."""
    instants = np.linspace(0, values.shape[2] - 1, min(values.shape[2], _SEEK_INSTANTS)).astype(int)
    values = values[:, :, np.unique(instants)]
    width = np.ptp(values, axis=0).mean(axis=1)
    if not (width > 0).any():
        return np.empty((0, points.shape[1])), np.zeros(len(width))
    values = values[:, width > 0] / width[width > 0, None]
    spline = fit_spline(points, values)
    trial = spread_points(spline.scales > 0, candidates, seed)
    free = spline.scales > 0
    # a point next to a run tells nothing new, and two that nearly agree spoil the spline
    spacing = 2.0 * len(spline.points) ** (-1.0 / max(int(free.sum()), 1))
    trial = trial[_far_mask(trial, spline.points, 0.1 * spacing)]
    low, high = values.min(axis=0), values.max(axis=0)
    forecast = np.empty((len(trial), *low.shape), dtype=np.float32)
    for start in range(0, len(trial), 1024):
        forecast[start : start + 1024] = spline.evaluate(trial[start : start + 1024])
    indices, new_low, new_high = _greedy(forecast, low, high, trial, count, 0.1 * spacing)
    growth = np.zeros(len(width))
    growth[width > 0] = np.maximum(low - new_low, new_high - high).mean(axis=1)
    return trial[indices], growth


def _greedy(forecast, low, high, trial, count, distance):
    """Indices of the best points, and the bounds with them; a gain only shrinks as others come."""
    low, high = low.copy(), high.copy()

    def gain(i):
        return float((np.maximum(forecast[i] - high, 0) + np.maximum(low - forecast[i], 0)).sum())

    heap = [(-gain(i), i) for i in range(len(forecast))]
    heapq.heapify(heap)
    indices: list[int] = []
    while heap and len(indices) < count:
        old_gain, i = heapq.heappop(heap)
        new_gain = gain(i)
        if new_gain <= 0:
            continue
        if heap and new_gain < -heap[0][0] and new_gain < -old_gain:
            heapq.heappush(heap, (-new_gain, i))
        elif _far_mask(trial[i : i + 1], trial[indices], distance)[0]:
            indices.append(i)
            low, high = np.minimum(low, forecast[i]), np.maximum(high, forecast[i])
    return indices, low, high


def _far_mask(points: np.ndarray, neighbours: np.ndarray, distance: float) -> np.ndarray:
    """Mask of the points (P, k) that are farther than `distance` from all others (N, k)."""
    if not len(neighbours):
        return np.ones(len(points), dtype=bool)
    return scipy.spatial.cKDTree(neighbours).query(points)[0] > distance
