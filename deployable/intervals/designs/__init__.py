"""Designs of experiments: where in the box the runs are, and which polynomials they determine.

`make_design` is the one entry. All points are in unit coordinates [-1, 1]^k; an interval of zero
width contributes one point (0) in its direction. A new design is a file with a `Method`, and a line
in `METHODS`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..box import MAX_DIMENSION, Box
from ..errors import IntervalError, check_choice, check_integer, check_options
from .design import Design, Method
from .scan import SCAN
from .smolyak import SMOLYAK
from .tensor import LOBATTO, ROOTS
from .total_degree import TOTAL_DEGREE

__all__ = ["METHODS", "Design", "make_design"]

METHODS: dict[str, Method] = {
    "tensor_roots": ROOTS,
    "tensor_lobatto": LOBATTO,
    "total_degree": TOTAL_DEGREE,
    "smolyak": SMOLYAK,
    "scan": SCAN,
}
MAX_ORDER = 64
MAX_RUNS = 100_000


def make_design(
    method: str,
    box: Box | int,
    order: int | Sequence[int] | None = None,
    *,
    max_runs: int = MAX_RUNS,
    **options,
) -> Design:
    """Make a design.

    Parameters
    ----------
    method
        ``tensor_roots`` (the paper: (n+1)^k roots), ``tensor_lobatto`` (extreme points; nested when
        the order doubles, corners included), ``total_degree`` (C(n+k, k) points chosen from the
        Lobatto grid), ``smolyak`` (sparse grid of nested Lobatto rules), ``scan`` (corners and a
        space-filling sequence).
    box
        A Box, or a number of directions that all have a width.
    order
        Polynomial order n >= 1, or one for each direction (0 keeps a direction constant). A scan
        may have none: then there is no surrogate, only the least and largest sample.
    options
        ``oversampling`` (total_degree: points per coefficient, >= 1), ``samples``, ``seed``
        and ``sequence`` ("sobol" or "latin_hypercube", scan).

    Raises
    ------
    IntervalError
        for a wrong method, order or option, or more than ``max_runs`` points.
    """
    kind = METHODS[check_choice("method", method, METHODS)]
    free = _free_mask(box)
    max_runs = check_integer("max_runs", max_runs, 1, 10**7)
    orders = None if order is None and not kind.needs_order else _orders(order, free)
    check_options("design option", kind.make, options)

    def limit(runs: int) -> None:
        if runs > max_runs:
            told = f"an order for which {method} needs at most {max_runs} runs, not {runs}"
            raise IntervalError("order", order, told)

    made = kind.make(orders, free, limit, **options)
    settled = (0,) * len(free) if orders is None else tuple(int(n) for n in orders)
    return replace(made, method=method, order=settled)


def _free_mask(box: Box | int) -> np.ndarray:
    if isinstance(box, Box):
        return box.free
    return np.ones(check_integer("box dimension", box, 1, MAX_DIMENSION), dtype=bool)


def _orders(order: int | Sequence[int] | None, free: np.ndarray) -> np.ndarray:
    """Order per direction, 0 where there is no width."""
    if isinstance(order, (list, tuple, np.ndarray)):
        if len(order) != len(free):
            raise IntervalError("order", order, f"one number, or {len(free)} of them")
        orders = np.array([check_integer("order", n, 0, MAX_ORDER) for n in order])
        if not orders.any():
            raise IntervalError("order", order, "at least one order above 0")
    else:
        orders = np.full(len(free), check_integer("order", order, 1, MAX_ORDER))
    return np.where(free, orders, 0)
