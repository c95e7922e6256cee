"""Exact range of one-dimensional Chebyshev sums, thousands of them at once.

With x = cos(t) a sum is g(t) = sum_k c_k cos(k t), with |g'''| <= sum_k k^3 |c_k|. Branch and bound
over cells of [0, pi]: a cell is closed when its Taylor bound cannot exceed the best value found,
when g is monotone or convex on it, or so surely concave that Newton's iteration finds its one
maximum. The result is as exact as the eigenvalues of the colleague matrix (Trefethen 2013, chapter
18)."""

from math import factorial

import numpy as np

_CHUNK = 1 << 21  # numbers in one temporary of the first pass
_ROUNDS = 60


def line_range(coefficients: np.ndarray) -> tuple[np.ndarray, ...]:
    """Least and largest value on [-1, 1] of T Chebyshev sums, coefficients (n + 1, T): low, high,
    x_low, x_high, rounding_error, (T) each, attained at x to rounding; no value lies outside [low -
    rounding_error, high + rounding_error]."""
    c = np.asarray(coefficients, dtype=float)
    degree, total = c.shape[0] - 1, c.shape[1]
    ranges = np.empty((5, total))
    step = max(_CHUNK // (8 * max(degree, 1)), 1)
    for start in range(0, total, step):
        part = slice(start, start + step)
        wave = c[1:, part]
        waves = np.concatenate([-wave, wave], axis=1)
        best, x, rounding_error = _maximum(waves)
        n = wave.shape[1]
        ranges[0, part] = c[0, part] - best[:n]
        ranges[1, part] = c[0, part] + best[n:]
        ranges[2, part], ranges[3, part] = x[:n], x[n:]
        ranges[4, part] = rounding_error[:n]
    return tuple(ranges)


def _maximum(c: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Largest value, its x and the rounding error of sum_(k>=1) c[k-1] cos(k t), c of (n, T)."""
    degree, total = c.shape
    if degree == 0:
        return np.zeros(total), np.zeros(total), np.zeros(total)
    k = np.arange(1.0, degree + 1)
    size = np.abs(c).sum(axis=0)
    rounding_error = 4 * np.finfo(float).eps * (degree + 2) * size
    third = (k**3) @ np.abs(c)

    cells = max(2 * degree, 4)
    radius = np.pi / (2 * cells)
    ends = np.linspace(0.0, np.pi, cells + 1)
    middle = 0.5 * (ends[1:] + ends[:-1])
    angle = np.concatenate([ends, middle])[:, None] * k
    values = np.cos(angle) @ c
    index = values.argmax(axis=0)
    best = values[index, np.arange(total)]
    angles = np.concatenate([ends, middle])[index]
    sine = np.sin(angle[cells + 1 :])
    cosine = np.cos(angle[cells + 1 :])
    g = values[cells + 1 :]
    g1 = -(sine * k) @ c
    g2 = -(cosine * k**2) @ c
    keep, newton = _classify(g, g1, g2, third, radius, best + rounding_error)

    cell, column = np.nonzero(newton)
    _newton(c, best, angles, column, middle[cell], radius)
    cell, column = np.nonzero(keep)
    centre = middle[cell]
    sixth = (k**6) @ np.abs(c)
    for turn in range(_ROUNDS):
        if not len(column):
            break
        radius /= 2
        column = np.concatenate([column, column])
        centre = np.concatenate([centre - radius, centre + radius])
        # a top that is nearly flat would need too many cells with the cubic bound
        terms = 2 if turn < 2 else 5
        waves = _waves(c, column, centre, terms)
        improve(best, angles, column, waves[0], centre)
        target = (best + rounding_error)[column]
        keep, newton = _classify(waves[0], waves[1], waves[2], third[column], radius, target)
        if terms > 2:
            bound = waves[0] + sixth[column] * (radius**6 / factorial(6))
            for m in range(1, 6):
                bound += np.abs(waves[m]) * (radius**m / factorial(m))
            keep &= bound > target
        _newton(c, best, angles, column[newton], centre[newton], radius)
        column, centre = column[keep], centre[keep]
    return best, np.cos(angles), rounding_error


def _classify(g, g1, g2, third, radius, target):
    """Masks: cells to be halved, and cells that hold one maximum for Newton's iteration."""
    bound = g + np.abs(g1) * radius + np.maximum(g2, 0) * (radius**2 / 2) + third * (radius**3 / 6)
    open_ = bound > target
    bend = third * radius
    monotone = np.abs(g1) > radius * (np.abs(g2) + bend / 2)
    convex = g2 >= bend
    # twice the bend: g'' then stays within half and three halves of its value at the centre, and
    # Newton's iteration cannot leave the cell for good
    newton = open_ & ~monotone & (g2 < -2 * bend)
    return open_ & ~monotone & ~convex & ~newton, newton


def _waves(c, column, t, terms=2):
    """g and its derivatives 1 ... terms at angles t (P) of sums `column` (P), by Horner's rule."""
    z = np.exp(1j * t)
    sums = [np.zeros(len(t), dtype=complex) for _ in range(terms + 1)]
    for k in range(len(c), 0, -1):
        term = c[k - 1, column]
        for m in range(terms + 1):
            sums[m] += float(k) ** m * term
            sums[m] *= z
    return [(1j**m * total).real for m, total in enumerate(sums)]


def improve(best, arguments, owner, values, points):
    """Put values that exceed the `best` of their owners, and their points, in the place of these;
    returns these owners."""
    better = values > best[owner]
    owner, values, points = owner[better], values[better], points[better]
    np.maximum.at(best, owner, values)
    is_best = values == best[owner]
    arguments[owner[is_best]] = points[is_best]
    return owner[is_best]


def _newton(c, best, angles, column, t, radius):
    """Find the one maximum of each concave cell and improve the best value with it."""
    if not len(column):
        return
    low, high = np.maximum(t - radius, 0.0), np.minimum(t + radius, np.pi)
    for _ in range(6):
        _, g1, g2 = _waves(c, column, t)
        step = np.where(g2 < 0, g1 / np.where(g2 < 0, g2, -1.0), 0.0)
        t = np.clip(t - step, low, high)
        if np.abs(step).max() < 1e-9:  # the value's error is the square of this
            break
    (g,) = _waves(c, column, t, 0)
    improve(best, angles, column, g, t)
