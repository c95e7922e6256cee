"""Guaranteed outer enclosures of polynomials in several variables, without subdivision."""

from __future__ import annotations

import itertools

import numpy as np

from .. import chebyshev
from ..chebyshev import product_basis
from .line_range import line_range

_MAX_GRID = 20_000
_CHUNK = 1 << 23


def effects_enclosure(c: np.ndarray, indices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Enclosure by exact ranges of the main effects and |coefficients| of the interactions.

    p = c_0 + sum_j p_j(x_j) + interactions; |T_i| <= 1, and the range of a sum of functions of
    different variables is the sum of their ranges. Sharp where the interactions are small, cheap
    for any order and dimension. `c` is (M, T), `indices` (M, k); returns lower, upper (T).
    """
    active = (indices > 0).sum(axis=1)
    rest = np.abs(c[active > 1]).sum(axis=0)
    lower, upper = c[active == 0].sum(axis=0), c[active == 0].sum(axis=0)
    for j in range(indices.shape[1]):
        rows = np.flatnonzero((active == 1) & (indices[:, j] > 0))
        if len(rows):
            line = np.zeros((int(indices[rows, j].max()) + 1, c.shape[1]))
            line[indices[rows, j]] = c[rows]
            low, high, _, _, slack = line_range(line)
            lower, upper = lower + low - slack, upper + high + slack
    return lower - rest, upper + rest


def grid_enclosure(
    c: np.ndarray, indices: np.ndarray, density: int = 8
) -> tuple[np.ndarray, np.ndarray]:
    """Enclosure from the extreme values on a Chebyshev grid, inflated.

    Two inflations are valid, and the smaller one is taken at each instant:

    - Ehlich and Zeller (1964): on the m roots of T_m a polynomial of degree n < m has
      max |p| <= max_grid |p| / cos(n pi / (2 m)) in each direction; applied to p minus the middle
      of its grid values.
    - with x_j = cos t_j, between the nodes of a grid of spacing h_j in t_j a function exceeds its
      multilinear interpolant by at most sum_j h_j^2 / 8 max |d^2 p / d t_j^2|, and
      |d^2 p / d t_j^2| <= sum i_j^2 |c_i|. Sharper where the coefficients decay.

    The grid, extreme points of T_m, holds `density` points per degree, fewer where it would be too
    large. `c` is (M, T), `indices` (M, k); returns lower, upper (T); infinite without a grid.
    """
    degrees = indices.max(axis=0)
    total = c.shape[1]
    while density > 1 and np.prod(density * degrees + 1.0) > _MAX_GRID:
        density -= 1
    if np.prod(density * degrees + 1.0) > _MAX_GRID or density < 2:
        return np.full(total, -np.inf), np.full(total, np.inf)
    counts = density * degrees
    nodes = [chebyshev.lobatto(int(m)) for m in counts]
    basis = product_basis(np.array(list(itertools.product(*nodes))), indices)
    low, high = np.empty(total), np.empty(total)
    step = max(_CHUNK // len(basis), 1)
    for start in range(0, total, step):
        values = basis @ c[:, start : start + step]
        low[start : start + step] = values.min(axis=0)
        high[start : start + step] = values.max(axis=0)
    used = degrees > 0
    # the factor also holds for the extreme points of T_m, which resolve cos(n t) as finely
    factor = np.prod(1.0 / np.cos(np.pi * degrees[used] / (2 * counts[used])))
    ehlich_zeller = (factor - 1.0) * (high - low) / 2
    curvature = np.zeros(total)
    for j in np.flatnonzero(used):
        curvature += (np.pi / counts[j]) ** 2 / 8 * ((indices[:, j] ** 2.0) @ np.abs(c))
    rounding = 8 * np.finfo(float).eps * (degrees.sum() + 2) * np.abs(c).sum(axis=0)
    inflation = np.minimum(ehlich_zeller, curvature) + rounding
    return low - inflation, high + inflation
