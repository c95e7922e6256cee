"""Extreme values of cubic splines over the box: exact on a line, by Newton's method elsewhere.

A search that stops before it has converged, or begins at one point of several that are nearly as
good, ends where rounding decides: its bounds differ between processors by a thousand times the
rounding. Each search here goes on until the next step can gain nothing above rounding."""

import numpy as np

from .designs import spread_points
from .ranges import Range, to_range
from .splines import CHUNK, Spline

CANDIDATES = 4096
"""Points, beside the runs, among which searches start."""

_BEST = 48  # trial points among which those are that searches start from
_MIN_DISTANCE = 0.2  # unit coordinates between two of them
_STEPS = 60
_GAIN = 1e-13  # of the spread of the runs' values: a smaller gain is rounding


def spline_range(spline: Spline, candidates: int = CANDIDATES) -> Range:
    """Bound a spline over [-1, 1]^k: the range that it attains in each column (each response and
    instant), and where; candidates: number of points, beside the runs, among which searches start.

    Exact where the runs differ in one parameter. Elsewhere Newton's method, kept inside the box,
    climbs from the best of all the runs and candidates (spread over the box, its faces, edges and
    corners), in each column from at most 2 + 2 f that are apart, f being the number of parameters
    that vary. No enclosure: the result's `lower` and `upper` are the attained values themselves;
    they contain every run, those that count as repeats too."""
    shape = spline.weights.shape[1:]
    flat = spline.weights.reshape(len(spline.weights), -1)
    k = len(spline.scales)
    sides = []
    for sign, runs, argument in (
        (-1.0, spline.lowest, spline.argmin),
        (1.0, spline.highest, spline.argmax),
    ):
        if spline.on_line:
            value, x = _line_maximum(spline, sign * flat)
        elif (spline.scales > 0).any():
            value, x = _maximum(spline, sign * flat, candidates)
        else:  # one run
            value, x = sign * flat[0], np.repeat(spline.points, flat.shape[1], axis=0)
        run = sign * runs.ravel() >= value
        value, x = np.where(run, sign * runs.ravel(), value), x.copy()
        x[run] = argument.reshape(-1, k)[run]
        sides += [(sign * value).reshape(shape), x.reshape(*shape, k)]
    low, x_low, high, x_high = sides
    return to_range(low, high, x_low, x_high)


def _line_maximum(spline: Spline, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest values (T) of a spline on a line, by the roots of its slope, and points (T, k)."""
    j = int(np.argmax(spline.scales > 0))
    order = np.argsort(spline.points[:, j])
    knots, count = spline.points[order, j], len(spline.points)
    value, second = flat[:count][order], flat[count:][order]
    h = np.diff(knots)[:, None]
    rise, bend = np.diff(value, axis=0), h**2 / 6
    # slope of an interval, by h, at its share t: a t^2 + 2 b t + c
    a = 3 * bend * np.diff(second, axis=0)
    b, c = 3 * bend * second[:-1], rise - bend * (2 * second[:-1] + second[1:])
    root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
    root_sum = -(b + np.copysign(root, b))
    points, columns = [np.full(flat.shape[1], x) for x in (-1.0, *knots, 1.0)], flat.shape[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        for t in (root_sum / a, c / root_sum):
            in_interval = (t > 0) & (t < 1)
            points.extend(np.where(in_interval, knots[:-1, None] + t * h, knots[:-1, None]))
    rows = np.stack(points)  # (P, T)
    best, x = np.full(columns, -np.inf), np.repeat(spline.points[:1], columns, axis=0)
    for row in rows:
        trial = x.copy()
        trial[:, j] = row
        index, factor = spline.line_rows(trial)
        height = (factor * flat[index, np.arange(columns)[:, None]]).sum(axis=1)
        better = height > best
        best[better], x[better] = height[better], trial[better]
    return best, x


def _maximum(spline: Spline, flat: np.ndarray, candidates: int) -> tuple[np.ndarray, np.ndarray]:
    """Largest values (T) that searches attain, and their points (T, k); weights (N + 1 + f, T)."""
    free = spline.scales > 0
    trial = spread_points(free, candidates)
    trial[:, ~free] = spline.points[0, ~free]
    trial = np.concatenate([spline.points, trial])
    spread = np.ptp(spline.values.reshape(len(spline.points), -1), axis=0)
    candidate_tops = _best_of(spline, flat, trial, _BEST)
    count = 2 + 2 * int(free.sum())
    start_counts = np.zeros(flat.shape[1], dtype=int)
    best, argument = np.full(flat.shape[1], -np.inf), candidate_tops[0].copy()
    starts = np.full((count, *argument.shape), np.inf)
    for x in candidate_tops:
        is_separate = (np.abs(starts - x).max(axis=-1) > _MIN_DISTANCE).all(axis=0)
        columns = np.flatnonzero(is_separate & (start_counts < count))
        starts[start_counts[columns], columns] = x[columns]
        start_counts[columns] += 1
    for i in range(count):
        columns = np.flatnonzero(start_counts > i)
        height, top = _climb(spline, flat[:, columns], spread[columns], starts[i, columns])
        better = height > best[columns]
        best[columns[better]], argument[columns[better]] = height[better], top[better]
    return best, argument


def _best_of(spline, flat, trial, count) -> np.ndarray:
    """Return the trial points (count, T, k) with the largest values, the largest first."""
    value, best_rows = np.zeros((0, flat.shape[1])), np.zeros((0, flat.shape[1]), dtype=int)
    step = max(CHUNK // max(flat.shape), 1)
    for start in range(0, len(trial), step):
        rows = spline.basis(trial[start : start + step]) @ flat
        value = np.concatenate([value, rows])
        index = np.arange(start, start + len(rows))
        best_rows = np.concatenate([best_rows, np.repeat(index[:, None], flat.shape[1], axis=1)])
        order = np.argpartition(-value, min(count, len(value)) - 1, axis=0)[:count]
        value, best_rows = (np.take_along_axis(x, order, axis=0) for x in (value, best_rows))
    return trial[np.take_along_axis(best_rows, np.argsort(-value, axis=0, kind="stable"), axis=0)]


def _climb(spline, flat, spread, start) -> tuple[np.ndarray, np.ndarray]:
    """Maxima (T) and their points (T, k) inside the box by at most `_STEPS` Newton steps, positive
    curvatures reversed, the radius quartered without gain, else doubled, until a step gains no more
    than rounding, relative to the runs' `spread` (T)."""
    free = np.flatnonzero(spline.scales > 0)
    half = spline.scales[free]
    x, columns = start.copy(), np.arange(len(start))
    radius = np.full(len(start), 0.5)
    value, slope, curvature = _derivatives(spline, flat, x)
    for _ in range(_STEPS):
        y = x[columns][:, free] * half
        g, h = slope[columns].copy(), curvature[columns].copy()
        at_faces = ((y >= half) & (g > 0)) | ((y <= -half) & (g < 0))
        g[at_faces] = 0.0
        h[at_faces[:, :, None] | at_faces[:, None, :]] = 0.0
        bends, axes = np.linalg.eigh(h)
        bends = np.abs(bends)
        largest = bends.max(axis=1, keepdims=True) + 1e-300
        bends = np.maximum(bends, 1e-12 * largest)
        newton = (axes @ ((axes.transpose(0, 2, 1) @ g[..., None]) / bends[..., None]))[..., 0]
        # The box can turn a Newton step downhill, but never a step along the slope.
        points, gain = _step_in_box(y, newton, g, half, radius[columns])
        slope_points, least = _step_in_box(y, g / largest, g, half, radius[columns])
        short = gain < least
        points[short], gain[short] = slope_points[short], least[short]
        go = (gain > _GAIN * spread[columns]) & (radius[columns] > 1e-9)
        columns, points = columns[go], points[go]
        if not len(columns):
            break
        trial = x[columns].copy()
        trial[:, free] = points / half
        height, *rest = _derivatives(spline, flat[:, columns], trial)
        better = height > value[columns]
        radius[columns] *= np.where(better, 2.0, 0.25)
        winners = columns[better]
        x[winners], value[winners] = trial[better], height[better]
        slope[winners], curvature[winners] = (r[better] for r in rest)
    return value, x


def _step_in_box(y, step, slope, half, radius) -> tuple[np.ndarray, np.ndarray]:
    """Points (T, f) of a step from y within box and radius, and by how much the slope gains (T)."""
    size = np.abs(step / half).max(axis=1)
    points = y + step * np.minimum(1.0, radius / np.maximum(size, 1e-300))[:, None]
    points = np.clip(points, -half, half)
    return points, ((points - y) * slope).sum(axis=1)


def _derivatives(spline, flat, x) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values (T), slopes (T, f), curvatures (T, f, f) of columns at points (T, k), scaled."""
    free = np.flatnonzero(spline.scales > 0)
    points, y = (spline.points * spline.scales)[:, free], (x * spline.scales)[:, free]
    n, f = points.shape
    value, slope, curvature = np.empty(len(y)), np.empty(y.shape), np.empty((*y.shape, f))
    step = max(CHUNK // (n * f), 1)
    for start in range(0, len(y), step):
        part = slice(start, start + step)
        offsets = y[part, None, :] - points
        squares = np.einsum("tnf,tnf->tn", offsets, offsets)
        distance = np.sqrt(squares)
        weight, linear = flat[:n, part].T, flat[n + 1 :, part].T
        by_distance = weight * distance
        value[part] = np.einsum("tn,tn->t", by_distance, squares) + flat[n, part]
        value[part] += (linear * y[part]).sum(axis=1)
        slope[part] = 3 * np.einsum("tn,tnf->tf", by_distance, offsets) + linear
        ratio = np.divide(weight, distance, out=np.zeros_like(distance), where=distance > 0)
        curvature[part] = 3 * (offsets * ratio[..., None]).transpose(0, 2, 1) @ offsets
        curvature[part] += 3 * by_distance.sum(axis=1)[:, None, None] * np.eye(f)
    return value, slope, curvature
