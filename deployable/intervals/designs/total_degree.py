"""The fewest runs for all polynomials of a total degree: C(n + k, k) for order n."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from .. import chebyshev
from ..chebyshev import product_basis
from ..errors import IntervalError
from ..points import keys
from . import multi_indices
from .design import Design, Method, check_terms

MAX_CANDIDATES = 20_000
MOST_TERMS = 1000
"""Polynomials for which points are chosen: the work grows with their square."""


def _make(
    orders: np.ndarray,
    free: np.ndarray,
    limit: Callable[[int], None],
    *,
    oversampling: float = 1.0,
) -> Design:
    count = multi_indices.count_total_degree(orders)
    limit(count)
    check_terms(count, MOST_TERMS)
    indices = multi_indices.total_degree(orders)
    points = choose_points(orders, indices, oversampling)
    limit(len(points))
    return Design(points, indices)


def choose_points(order: np.ndarray, indices: np.ndarray, oversampling: float = 1.0) -> np.ndarray:
    """Choose points (N, k) for the basis `indices` (M, k) from Lobatto candidates.

    Pivoted QR of the transposed basis matrix takes, one after the other, the candidate whose row is
    farthest from the span of those taken: approximate Fekete points (Sommariva and Vianello 2009).
    With `oversampling` > 1 there are ceil(oversampling M) points for a least-squares fit.
    """
    from scipy.linalg import qr

    if not (np.isfinite(oversampling) and 1.0 <= oversampling <= 100.0):
        raise IntervalError("oversampling", oversampling, "a number from 1 to 100")
    target = int(np.ceil(oversampling * len(indices) - 1e-9))
    candidates = _candidates(order, target)
    chosen = np.zeros((0, indices.shape[1]))
    while len(chosen) < target:
        candidates = candidates[~_is_in(candidates, chosen)]
        if not len(candidates):  # a box without width has one point
            break
        rows = product_basis(candidates, indices)
        if len(chosen) < len(indices) and len(chosen):
            # what the chosen points already determine is projected out before the next pivots
            span, _ = np.linalg.qr(product_basis(chosen, indices).T)
            rows = rows - (rows @ span) @ span.T
        _, pivot = qr(rows.T, mode="r", pivoting=True, check_finite=False)
        want = len(indices) - len(chosen) if len(chosen) < len(indices) else target - len(chosen)
        want = min(want, len(indices))
        chosen = np.concatenate([chosen, candidates[pivot[:want]]])
    return chosen


def _is_in(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Mask of the `points` (N, k) that are among `others`."""
    known = set(keys(others))
    return np.array([key in known for key in keys(points)], dtype=bool)


def _candidates(order: np.ndarray, target: int) -> np.ndarray:
    """Lobatto grid of the orders, or a fixed-seed subset of it if it is too large.

    The subset keeps the corners and the coordinate axes, where extreme points matter most.
    """
    # the finer rule gives a choice also when the grid of the order itself has hardly more points
    nodes = [chebyshev.lobatto(n) if n else np.zeros(1) for n in order]
    size = np.prod([float(len(x)) for x in nodes])
    if size < 2 * target:
        nodes = [chebyshev.lobatto(2 * n) if n else np.zeros(1) for n in order]
        size = np.prod([float(len(x)) for x in nodes])
    limit = max(MAX_CANDIDATES, 4 * target)
    if size <= limit:
        return np.array(list(itertools.product(*nodes)))
    generator = np.random.default_rng(0)
    ends = np.array(list(itertools.product(*[(-1.0, 1.0) if n else (0.0,) for n in order])))
    axes = []
    for j, line in enumerate(nodes):
        points = np.zeros((len(line), len(nodes)))
        points[:, j] = line
        axes.append(points)
    drawn = np.stack([generator.choice(x, limit) for x in nodes], axis=1)
    return np.unique(np.concatenate([ends, *axes, drawn]), axis=0)


TOTAL_DEGREE = Method(_make, symmetric=False)
