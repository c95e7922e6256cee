"""Chebyshev points, products and one-dimensional transforms on [-1, 1].

Source: Trefethen, Approximation Theory and Approximation Practice (SIAM 2013), chapters 2-4.
"""

from __future__ import annotations

from math import gcd

import numpy as np
from numpy.polynomial.chebyshev import chebvander


def _sine(numerator: np.ndarray, denominator: int) -> np.ndarray:
    """sin(pi numerator / (2 denominator)), from the reduced fraction.

    The sine form keeps the points symmetric to the last bit, and reducing the fraction makes a
    point that belongs to two grids the same float in both: designs share runs by their values.
    """
    points = np.empty(len(numerator))
    for i, top in enumerate(int(t) for t in numerator):
        divisor = gcd(abs(top), 2 * denominator) or 1
        points[i] = np.sin(np.pi * (top // divisor) / (2 * denominator // divisor))
    return points


def roots(order: int) -> np.ndarray:
    """The order + 1 roots of T_(order+1), ascending, shape (order + 1)."""
    count = order + 1
    return _sine(2 * np.arange(count) - order, count)


def lobatto(order: int) -> np.ndarray:
    """The order + 1 extreme points of T_order, ascending; the centre for order 0.

    They contain -1 and 1, and those of order n are among those of order 2n.
    """
    if order == 0:
        return np.zeros(1)
    return _sine(2 * np.arange(order + 1) - order, order)


def product_basis(points: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """Values (N, M) of the Chebyshev products `indices` (M, k) at `points` (N, k)."""
    values = np.ones((len(points), len(indices)))
    for j in range(indices.shape[1]):
        highest = int(indices[:, j].max()) if len(indices) else 0
        if highest:
            values *= chebvander(points[:, j], highest)[:, indices[:, j]]
    return values


def roots_transform(order: int) -> np.ndarray:
    """Matrix (n+1, n+1) from values at `roots` to coefficients (a DCT-II written as a product)."""
    count = order + 1
    angle = np.pi * (2 * np.arange(count)[::-1] + 1) / (2 * count)  # ascending in x
    matrix = 2.0 / count * np.cos(np.arange(count)[:, None] * angle)
    matrix[0] /= 2
    return matrix


def lobatto_transform(order: int) -> np.ndarray:
    """Matrix (n+1, n+1) from values at `lobatto` to coefficients (a DCT-I as a product)."""
    if order == 0:
        return np.ones((1, 1))
    angle = np.pi * np.arange(order + 1)[::-1] / order
    matrix = 2.0 / order * np.cos(np.arange(order + 1)[:, None] * angle)
    matrix[:, [0, -1]] /= 2
    matrix[[0, -1]] /= 2
    return matrix
