"""Full tensor grids of Chebyshev points: (n + 1)^k runs for order n."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import chebyshev
from . import multi_indices
from .design import Design, Method


def _roots(orders: np.ndarray, free: np.ndarray, limit: Callable[[int], None]) -> Design:
    """The roots of the Chebyshev polynomials, as in the paper."""
    return _grid(orders, limit, chebyshev.roots, chebyshev.roots_transform)


def _lobatto(orders: np.ndarray, free: np.ndarray, limit: Callable[[int], None]) -> Design:
    """The extreme points: nested when the order doubles, corners included."""
    return _grid(orders, limit, chebyshev.lobatto, chebyshev.lobatto_transform)


def _grid(orders, limit, rule, transform) -> Design:
    """Tensor grid of one-dimensional points, last direction fastest."""
    limit(int(np.prod(orders.astype(float) + 1)))
    nodes = np.meshgrid(*[rule(n) for n in orders], indexing="ij")
    points = np.stack([g.ravel() for g in nodes], axis=1)
    return Design(points, multi_indices.tensor(orders), transform=transform)


ROOTS = Method(_roots)
LOBATTO = Method(_lobatto)
