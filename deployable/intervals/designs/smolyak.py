"""Sparse grids of nested Lobatto rules (Smolyak)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import chebyshev
from . import multi_indices
from .design import Design, Method, check_terms

MOST_TERMS = 10_000
"""Polynomials that can be fitted together: their matrix is full."""


def _make(orders: np.ndarray, free: np.ndarray, limit: Callable[[int], None]) -> Design:
    count = multi_indices.count_smolyak(orders)
    limit(count)
    check_terms(count, MOST_TERMS)
    indices = multi_indices.smolyak(orders)
    return Design(nested_points(indices), indices)


def nested_points(indices: np.ndarray) -> np.ndarray:
    """Points (M, k) of a downward closed set (M, k) of nested Lobatto rules (1, 3, 5, 9, ...).

    The nodes of one direction are put in the order in which the nested rules add them; a basis
    index then owns the node of the same number, and the points determine the basis.
    """
    highest = int(indices.max()) if indices.size else 0
    nodes = [0.0]
    degree = 2
    while len(nodes) <= highest:
        rule = chebyshev.lobatto(degree)
        nodes.extend(x for x in (rule if degree == 2 else rule[1::2]) if x != 0.0)
        degree *= 2
    return np.array(nodes)[indices]


SMOLYAK = Method(_make)
