"""Sets of multi-indices: which products of Chebyshev polynomials a surrogate is made of.

A set has the shape (M, k); row m stands for T_(i_1)(x_1) ... T_(i_k)(x_k). Orders are given per
direction; a direction of order 0 does not enter.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np


def tensor(order: Sequence[int]) -> np.ndarray:
    """All i with i_j <= order_j, last direction fastest: shape (prod(order + 1), k)."""
    grids = np.meshgrid(*[np.arange(n + 1) for n in order], indexing="ij")
    return np.stack([g.ravel() for g in grids], axis=1)


def total_degree(order: Sequence[int]) -> np.ndarray:
    """All i with sum_j i_j / order_j <= 1; for equal orders n the total degree is at most n.

    Sorted by total degree. C(n + k, k) rows for equal orders: 20 at k = 3, n = 3.
    """
    order = np.asarray(order, dtype=int)
    rows = [()]
    # grow direction by direction, so that the full tensor is never built
    for j, n in enumerate(order):
        grown = []
        for row in rows:
            used = sum(i / m for i, m in zip(row, order[:j], strict=True) if m)
            room = int(np.floor((1.0 - used) * n + 1e-9))
            grown.extend((*row, i) for i in range(room + 1))
        rows = grown
    rows.sort(key=lambda row: (sum(row), tuple(-i for i in row)))
    return np.array(rows, dtype=int).reshape(len(rows), len(order))


def nested_degree(degree: int) -> int:
    """Degree of the smallest rule of 1, 3, 5, 9, 17, ... Lobatto points with this degree."""
    if degree == 0:
        return 0
    nested = 2
    while nested < degree:
        nested *= 2
    return nested


def smolyak(order: Sequence[int]) -> np.ndarray:
    """Smolyak set (M, k) with slow growth.

    The union of the tensor sets of the degrees (nested_degree(i_1), ..., nested_degree(i_k)) over
    the total-degree set, so it contains every polynomial of that total degree (Barthelmann, Novak
    and Ritter 2000 with the growth of Burkardt 2009, where a rule grows only when it must).
    """
    corners = {tuple(nested_degree(int(i)) for i in row) for row in total_degree(order)}
    members = set()
    for corner in corners:
        members.update(itertools.product(*[range(n + 1) for n in corner]))
    rows = sorted(members, key=lambda row: (sum(row), tuple(-i for i in row)))
    return np.array(rows, dtype=int)


def count_smolyak(order: Sequence[int]) -> int:
    """Number of rows of `smolyak`, without making them.

    A row belongs to it if the least degrees whose nested rules have its indices add up to no more
    than the order: 0 for index 0, 1 for 1 and 2, 3 for 3 and 4, 5 for 5 to 8, 9 for 9 to 16, ...
    """
    counts = {0.0: 1}  # rows so far, by the share of the order that they use
    for n in (int(n) for n in order if n):
        least = {d: nested_degree(d) - nested_degree(d - 1) for d in range(1, n + 1)}
        steps = {0: 1} | {d: new for d, new in least.items() if new}
        grown: dict[float, int] = {}
        for used, rows in counts.items():
            for degree, new in steps.items():
                share = round(used + degree / n, 9)
                if share <= 1.0 + 1e-9:
                    grown[share] = grown.get(share, 0) + rows * new
        counts = grown
    return sum(counts.values())


def count_total_degree(order: Sequence[int]) -> int:
    """Number of rows of `total_degree`, without making them when the orders are equal."""
    from math import comb

    order = [int(n) for n in order if n]
    if not order:
        return 1
    if len(set(order)) == 1:
        return comb(order[0] + len(order), len(order))
    return len(total_degree(order))
