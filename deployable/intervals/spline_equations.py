"""Solving for splines: the natural cubic spline on a line, the polyharmonic one elsewhere.

On a line the cubes |x - x_i|^3 of a thousand runs cancel each other down to nothing; there a spline
is its values and second derivatives at the runs, whose equations are tridiagonal and diagonally
dominant whatever the spacing (Green and Silverman, Nonparametric Regression, 1994, chapter 2).
Elsewhere the matrix of the cubes is reduced to the vectors orthogonal to the linear functions, on
which it is positive definite (Wendland 2005, chapter 8)."""

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any

import numpy as np
import scipy

from .errors import IntervalError

_COLUMNS, _BLOCK, _MOST_RESULTS, _SEARCH_POINTS = 512, 1 << 14, 32, 64
_CONDITION = 1e9  # of the equations of runs left out together: above it others give no spline
# Runs closer than this, in unit coordinates, count once: the weights of three runs at distances h
# are of the order 1 / h^3. On a line no weights are needed.
MIN_SPACING, MIN_SPACING_ON_LINE = 1e-4, 1e-6


def in_blocks(function: Callable, points: np.ndarray, width: int) -> np.ndarray:
    """Return the values (P, ...) of a function of points (P, k), whose arrays have `width` numbers
    for each point. It takes so few points at once that these arrays stay below 128 kB: fresh
    memory, which larger ones take, costs three times as much as computing them."""
    step = max(_BLOCK // width, 16)
    blocks = [function(points[i : i + step]) for i in range(0, max(len(points), 1), step)]
    return np.concatenate(blocks) if len(blocks) > 1 else blocks[0]


def remember(function: Callable) -> Callable:
    """Decorate a function of arrays, whose latest results are returned again for equal arrays."""
    results: dict[tuple, Any] = {}

    @wraps(function)
    def call(*arrays: np.ndarray) -> Any:
        key = tuple((array.shape, array.dtype.char, array.tobytes()) for array in arrays)
        if key not in results:
            results[key] = function(*arrays)
            if len(results) > _MOST_RESULTS:
                del results[next(iter(results))]
        return results[key]

    return call


def remember_latest(method: Callable) -> Callable:
    """Decorate a method of points (P, k). Its latest results, for few and for many points, are
    returned again for equal points, as several masks and fits, and a search's end, ask for them."""
    name = f"latest {method.__name__}"

    @wraps(method)
    def call(self: Any, points: np.ndarray) -> Any:
        points, latest = np.asarray(points, dtype=float), self.__dict__.setdefault(name, {})
        key, is_many = points.tobytes(), len(points) > _SEARCH_POINTS
        if is_many not in latest or latest[is_many][0] != key:
            latest[is_many] = key, method(self, points)
        return latest[is_many][1]

    return call


def stands_alone(points: np.ndarray) -> np.ndarray:
    """Return a mask (N) of the runs at `points` (N, k) in [-1, 1]^k that are farther from all
    others than a quarter of the mean spacing of as many runs, spread over the box. Runs close to
    others say less about the rest of the box."""
    directions = int((np.ptp(points, axis=0) > 0).sum())
    if len(points) < 2 or not directions:
        return np.ones(len(points), dtype=bool)
    gaps = scipy.spatial.cKDTree(points).query(points, 2)[0][:, 1]
    return gaps >= 0.5 * len(points) ** (-1.0 / directions)


def distinct(points: np.ndarray, factor: float = 1.0) -> np.ndarray:
    """Choose the runs that a fit takes, without near repeats: returns increasing indices. points
    (N, k): of the runs, in [-1, 1]^k; factor: they are farther apart (Euclidean) than this times
    1e-4, or times 1e-6 where all lie along one direction; of nearer ones the first stays."""
    on_line = (np.ptp(points, axis=0) > 0).sum() <= 1
    # equal runs in bulk first: a tree would list all their pairs
    _, first = np.unique(np.round(points, 9) + 0.0, axis=0, return_index=True)
    first = np.sort(first)
    keep = np.ones(len(first), dtype=bool)
    radius = factor * (MIN_SPACING_ON_LINE if on_line else MIN_SPACING)
    pairs = scipy.spatial.cKDTree(points[first]).query_pairs(radius, output_type="ndarray")
    for i, j in pairs[np.lexsort(pairs.T[::-1])]:
        keep[j] &= not keep[i]
    return first[keep]


def line_rows(x: np.ndarray, knots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the matrix that evaluates a cubic spline on a line at x (P): indices (P, 4) into the
    list of its N values at knots (N, any order), then its N second derivatives there, and the
    factors (P, 4) of these. Beyond the outer knots the spline is straight."""
    order = np.argsort(knots)
    t, count = knots[order], len(knots)
    cell = np.clip(np.searchsorted(t, x, side="right") - 1, 0, count - 2)
    h = t[cell + 1] - t[cell]
    a, b = (t[cell + 1] - x) / h, (x - t[cell]) / h
    c, d = a**3 - a, b**3 - b
    c, d = np.where(b < 0, -2 * b, c), np.where(b < 0, -b, d)
    c, d = np.where(a < 0, -a, c), np.where(a < 0, -2 * a, d)
    first, second = order[cell], order[cell + 1]
    index = np.stack([first, second, first + count, second + count], axis=1)
    return index, np.stack([a, b, c * h**2 / 6, d * h**2 / 6], axis=1)


def solve_line(knots: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fit T natural cubic splines with one parameter to values (N, T) at knots (N, in any order).
    Returns their second derivatives (N, T), and leave-one-out errors (N, T), infinite below 3
    knots."""
    order = np.argsort(knots)
    h = np.diff(knots[order])
    second, left_out = np.zeros_like(values), np.full_like(values, np.inf)
    if len(knots) < 3:
        return second, left_out
    band = np.stack([np.append(0.0, h[1:-1] / 6), (h[:-1] + h[1:]) / 3])
    bend = np.zeros_like(values)
    slopes = np.diff(values[order], axis=0) / h[:, None]
    bend[1:-1] = _tridiagonal(band, np.diff(slopes, axis=0))
    # The spline without run i predicts the value that minimises its bending energy f' Q R^-1 Q' f.
    slope = np.diff(bend, axis=0) / h[:, None]
    force = np.concatenate([slope[:1], np.diff(slope, axis=0), -slope[-1:]])
    factors = [1 / h[:-1], -1 / h[:-1] - 1 / h[1:], 1 / h[1:]]
    bends = scipy.sparse.diags_array(factors, offsets=[0, 1, 2], shape=(len(h) - 1, len(h) + 1))
    energy, bends = np.empty(len(h) + 1), bends.tocsc()
    for start in range(0, len(energy), _COLUMNS):
        part = bends[:, start : start + _COLUMNS].toarray()
        energy[start : start + _COLUMNS] = (part * _tridiagonal(band, part)).sum(axis=0)
    second[order], left_out[order] = bend, force / energy[:, None]
    return second, left_out


def _tridiagonal(band: np.ndarray, right: np.ndarray) -> np.ndarray:
    # LAPACK's routine refuses one equation
    return right / band[1] if band.shape[1] == 1 else scipy.linalg.solveh_banded(band, right)


class Polyharmonic:
    """Factorised equations of a polyharmonic spline through N runs; cubes (N, N): distances between
    runs to the third power; linear (N, m): values at the runs of m linear functions, the constant
    and a coordinate each. IntervalError where the runs lie in one plane or too close together."""

    def __init__(self, cubes: np.ndarray, linear: np.ndarray):
        count, extra = linear.shape
        if count < extra or np.linalg.matrix_rank(linear) < extra:
            raise IntervalError("runs", count, f"at least {extra} runs that are not in one plane")
        (raw, tau), self._triangle = scipy.linalg.qr(linear, mode="raw")
        self._mirrors = np.tril(raw, -1)[:, :extra] + np.eye(count, extra)
        # Q = I - V C V^T of all mirrors V at once (Schreiber and Van Loan 1989)
        self._core, products = np.diag(tau), self._mirrors.T @ self._mirrors
        for j in range(extra):
            self._core[:j, j] = -tau[j] * self._core[:j, :j] @ products[:j, j]
        self._extra, self._cubes = extra, cubes
        half = self._rotate(cubes).T
        try:
            self._root = scipy.linalg.cholesky(self._rotate(half)[extra:, extra:], lower=True)
        except scipy.linalg.LinAlgError:
            raise IntervalError("runs", count, "runs that are farther apart") from None

    def _rotate(self, x: np.ndarray, inverse: bool = False) -> np.ndarray:
        """Q^T x, or Q x: first come the coordinates in the linear functions."""
        core = self._core if inverse else self._core.T
        return x - self._mirrors @ (core @ (self._mirrors.T @ x))

    def weights(self, values: np.ndarray) -> np.ndarray:
        """Solve for T splines through values (N, T) at the N runs: returns the weights (N + m, T)
        of the runs, then of the m linear functions."""
        coords = self._rotate(values)
        if len(coords) > self._extra:
            rest = coords[self._extra :]
            coords[self._extra :] = scipy.linalg.cho_solve((self._root, True), rest)
        coords[: self._extra] = 0.0
        weights = self._rotate(coords, inverse=True)
        rest = self._rotate(values - self._cubes @ weights)[: self._extra]
        trend = scipy.linalg.solve_triangular(self._triangle[: self._extra], rest)
        return np.concatenate([weights, trend])

    def left_out(self, weights: np.ndarray, groups: Iterable[np.ndarray] = ()) -> np.ndarray:
        """Leave-one-out errors (N, T) at the runs of T splines, from their weights (N + m, T);
        infinite where the other runs give no spline. groups: rows of runs that are left out
        together as well, if the others give a spline. Half of that error counts if it is larger:
        without them the spacing is twice as wide."""
        count = len(self._cubes)
        columns = self._rotate(np.eye(count))[self._extra :]
        if not len(columns):
            return np.full((count, weights.shape[1]), np.inf)
        columns = scipy.linalg.solve_triangular(self._root, columns, lower=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = weights[:count] / (columns**2).sum(axis=0)[:, None]
        errors = np.where(np.isfinite(errors), errors, np.inf)
        for rows in groups:
            block = columns[:, rows].T @ columns[:, rows]
            if np.linalg.cond(block) < _CONDITION:
                group_errors = 0.5 * np.linalg.solve(block, weights[rows])
                is_larger = np.abs(group_errors) > np.abs(errors[rows])
                errors[rows] = np.where(is_larger, group_errors, errors[rows])
        return errors
