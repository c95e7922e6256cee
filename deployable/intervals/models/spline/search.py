"""Range that a spline attains: searched from many points, then climbed along each direction."""

from __future__ import annotations

import numpy as np

from ...designs.scan import scan_points
from ...points import corner_points
from ...ranges import Range, attained
from .spline import Spline

_CANDIDATES = 4096
_CHUNK = 1 << 20  # numbers at a time: memory that is used again is faster than fresh memory


def spline_range(spline: Spline, candidates: int = _CANDIDATES) -> Range:
    """Range that the spline attains over [-1, 1]^k, at every instant.

    The best of all the runs and of `candidates` points spread over the box, its faces, edges and
    corners, then improved along each direction by parabolas. No enclosure: `lower` and `upper` are
    the attained values themselves, and contain every run, those that count as repeats too.
    """
    shape = spline.weights.shape[1:]
    flat = spline.weights.reshape(len(spline.weights), -1)
    free = spline.scales > 0
    trial = spread_points(free, candidates)
    trial[:, ~free] = spline.points[0, ~free]
    columns, k = np.arange(flat.shape[1]), len(free)
    low, high = spline.lowest.ravel().copy(), spline.highest.ravel().copy()
    x_low, x_high = spline.argmin.reshape(-1, k).copy(), spline.argmax.reshape(-1, k).copy()
    step = max(_CHUNK // max(flat.shape), 1)
    for start in range(0, len(trial), step):
        values = spline.basis(trial[start : start + step]) @ flat
        for sign, best, at in ((-1, low, x_low), (1, high, x_high)):
            where = (sign * values).argmax(axis=0)
            found = values[where, columns]
            better = sign * (found - best) > 0
            best[better], at[better] = found[better], trial[start + where[better]]
    spacing = 2.0 * max(candidates, 1) ** (-1.0 / max(int(free.sum()), 1))
    low, x_low = _climb(spline, flat, -1.0, low, x_low, spacing)
    high, x_high = _climb(spline, flat, 1.0, high, x_high, spacing)
    low, high = low.reshape(shape), high.reshape(shape)
    return attained(low, high, x_low.reshape(*shape, k), x_high.reshape(*shape, k))


def spread_points(free: np.ndarray, count: int, seed: int = 1) -> np.ndarray:
    """Points (about `count`, k): corners, a line or Sobol sequence, half of it pushed to faces."""
    dimension = int(np.sum(free))
    if dimension == 0:
        return np.zeros((1, len(free)))
    if dimension == 1:
        points = np.zeros((max(count, 3), len(free)))
        points[:, free] = np.linspace(-1.0, 1.0, len(points))[:, None]
        return points
    points = scan_points(free, samples=count, seed=seed, corners=False)
    half = points[: count // 2]
    outer = np.abs(half) > 0.7
    half[outer] = np.sign(half[outer])
    points = np.concatenate([corner_points(free), points])
    return np.unique(points, axis=0)


def _climb(spline, flat, sign, best, x, step) -> tuple[np.ndarray, np.ndarray]:
    """Parabolas along each direction through x (T, k), one point for each column."""
    best, x = best.copy(), x.copy()
    for turn in range(4):
        width = step / 2**turn
        for j in np.flatnonzero(spline.scales > 0):
            sides = []
            for side in (-width, width):
                moved = x.copy()
                moved[:, j] = np.clip(moved[:, j] + side, -1.0, 1.0)
                sides.append((moved, _pairs(spline, flat, moved)))
            (a, fa), (b, fb) = sides
            left, right = a[:, j] - x[:, j], b[:, j] - x[:, j]
            with np.errstate(divide="ignore", invalid="ignore"):
                rise, fall = (fa - best) / left, (fb - best) / right
                top = (rise * right - fall * left) / (2 * (rise - fall))
            moved = x.copy()
            inside = np.isfinite(top)
            moved[inside, j] += np.clip(top[inside], left[inside], right[inside])
            for trial, value in (*sides, (moved, _pairs(spline, flat, moved))):
                better = sign * (value - best) > 0
                best[better], x[better] = value[better], trial[better]
    return best, x


def _pairs(spline, flat, x) -> np.ndarray:
    """Values (T) of column t at the point x[t]."""
    if spline.on_line:
        index, factor = spline.line_rows(x)
        return (factor * flat[index, np.arange(len(x))[:, None]]).sum(axis=1)
    out = np.empty(len(x))
    step = max(_CHUNK // len(flat), 1)
    for start in range(0, len(x), step):
        part = slice(start, start + step)
        out[part] = np.einsum("tn,nt->t", spline.basis(x[part]), flat[:, part])
    return out
