"""Inner estimate of the range of a polynomial in several variables, with known arguments.

Sampling finds good starting points, then exact searches along one coordinate after the other
climb from them. Every value returned is attained, so the range found lies inside the true one.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from .. import chebyshev
from ..chebyshev import product_basis
from ..points import corner_points
from .line_range import line_range

_MAX_GRID = 1024
_CHUNK = 1 << 22


def inner_range(
    coefficients: np.ndarray, indices: np.ndarray, sweeps: int = 30
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Attained low and high values (T) and their unit arguments (T, k).

    `coefficients` is (M, T), `indices` (M, k).
    """
    samples = sample_points(indices.max(axis=0))
    basis = product_basis(samples, indices)
    total = coefficients.shape[1]
    low, high = np.empty(total), np.empty(total)
    x_low, x_high = np.empty((total, indices.shape[1])), np.empty((total, indices.shape[1]))
    step = max(_CHUNK // max(len(samples), len(indices) * indices.shape[1]), 1)
    for start in range(0, total, step):
        part = slice(start, start + step)
        c = coefficients[:, part]
        values = basis @ c
        low[part], x_low[part] = climb(-c, indices, samples[values.argmin(axis=0)], sweeps)
        high[part], x_high[part] = climb(c, indices, samples[values.argmax(axis=0)], sweeps)
    return -low, high, x_low, x_high


def sample_points(degrees: np.ndarray) -> np.ndarray:
    """Corners and the Lobatto grid of about twice the degree, thinned to about a thousand."""
    free = degrees > 0
    nodes = [chebyshev.lobatto(2 * int(n)) for n in degrees]
    if np.prod([float(len(x)) for x in nodes]) <= _MAX_GRID:
        return np.array(list(itertools.product(*nodes)))
    generator = np.random.default_rng(0)
    drawn = np.stack([generator.choice(x, _MAX_GRID) for x in nodes], axis=1)
    return np.concatenate([corner_points(free), np.zeros((1, len(free))), drawn])


def climb(
    c: np.ndarray, indices: np.ndarray, start: np.ndarray, sweeps: int = 30
) -> tuple[np.ndarray, np.ndarray]:
    """Coordinate ascent of sums c (M, T) from start (T, k): values (T) and arguments (T, k)."""
    directions = [j for j in range(indices.shape[1]) if indices[:, j].any()]
    plans = {j: _Plan(indices, j) for j in directions}
    best = np.full(c.shape[1], -np.inf)
    x = start.copy()
    if not directions:
        return c.sum(axis=0), x
    scale = np.abs(c).sum(axis=0)
    active = np.arange(c.shape[1])
    for _ in range(sweeps):
        before = best[active]
        here, cost = x[active], c[:, active]
        for j in directions:
            line = plans[j].line(cost, here)
            _, value, _, argument, _ = line_range(line)
            here[:, j] = argument
        gain = value > before  # the last direction's value is that of the whole point
        best[active[gain]] = value[gain]
        x[active[gain]] = here[gain]
        with np.errstate(invalid="ignore"):
            going = ~(value - before <= 1e-13 * scale[active])
        active = active[going]
        if not len(active):
            break
    return best, x


class _Plan:
    """How to collect the coefficients along one direction, worked out once."""

    def __init__(self, indices: np.ndarray, direction: int) -> None:
        self.others = [j for j in range(indices.shape[1]) if j != direction and indices[:, j].any()]
        self.order = np.argsort(indices[:, direction], kind="stable")
        self.indices = indices[self.order]
        self.rows, self.starts = np.unique(self.indices[:, direction], return_index=True)

    def line(self, c: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Coefficients (n + 1, T) along the direction through the points x (T, k)."""
        terms = c[self.order]
        for j in self.others:
            values = chebvander(x[:, j], int(self.indices[:, j].max()))
            terms *= values.T[self.indices[:, j]]
        line = np.zeros((int(self.rows[-1]) + 1, c.shape[1]))
        line[self.rows] = np.add.reduceat(terms, self.starts, axis=0)
        return line
