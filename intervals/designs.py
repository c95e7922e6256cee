"""Designs of experiments: where in the box the runs are, and which polynomials they determine.

`make_design` is the one entry. All points are in unit coordinates [-1, 1]^k; an interval of zero
width contributes one point (0) in its direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from . import chebyshev, multi_indices, scans, subsets
from .box import MAX_DIMENSION, Box
from .exceptions import IntervalError, check_choice, check_integer

METHODS = ("tensor_roots", "tensor_lobatto", "total_degree", "smolyak", "scan")
MAX_ORDER = 64
MAX_RUNS = 100_000


@dataclass(frozen=True)
class Design:
    """Points (N, k) in unit coordinates and the basis that they determine.

    Attributes
    ----------
    points
        Unit coordinates (N, k).
    multi_indices
        Basis (M, k) of Chebyshev products, M <= N; (0, k) for a plain scan without surrogate.
    method
        One of `METHODS`.
    order
        Order of each direction (k); 0 where the interval has no width.
    options
        What else made the design (seed, samples, ...).
    """

    points: np.ndarray
    multi_indices: np.ndarray
    method: str
    order: tuple[int, ...]
    options: dict = field(default_factory=dict)

    @property
    def dimension(self) -> int:
        """Number of directions k."""
        return self.points.shape[1]

    @property
    def runs(self) -> int:
        """Number of points N."""
        return self.points.shape[0]

    @property
    def is_tensor(self) -> bool:
        """True where the points are a full tensor grid in the order of `multi_indices`."""
        return self.method in ("tensor_roots", "tensor_lobatto")


def make_design(
    method: str,
    box: Box | int,
    order: int | Sequence[int] | None = None,
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
        ``oversampling`` (total_degree: points per coefficient, >= 1), ``existing`` (total_degree:
        unit points (R, k) that are already run and are to be used first), ``samples``, ``seed``,
        ``sequence`` ("sobol" or "latin_hypercube") and ``corners`` (scan), ``max_runs``.

    Raises
    ------
    IntervalError
        for a wrong method, order or option, or more than ``max_runs`` points.
    """
    check_choice("method", method, METHODS)
    free = _free_mask(box)
    max_runs = check_integer("max_runs", options.pop("max_runs", MAX_RUNS), 1, 10**7)
    if method == "scan" and order is None:
        orders = np.zeros(len(free), dtype=int)
        no_surrogate = True
    else:
        orders = _orders(order, free)
        no_surrogate = False
    if method in ("tensor_roots", "tensor_lobatto"):
        _refuse_options(method, options)
        _check_runs(method, order, int(np.prod(orders.astype(float) + 1)), max_runs)
        rule = chebyshev.roots if method == "tensor_roots" else chebyshev.lobatto
        points, indices = _grid([rule(n) for n in orders]), multi_indices.tensor(orders)
    elif method == "smolyak":
        _refuse_options(method, options)
        indices, _ = multi_indices.smolyak(orders)
        _check_runs(method, order, len(indices), max_runs)
        points = subsets.nested_points(indices)
    elif method == "total_degree":
        _check_runs(method, order, multi_indices.count_total_degree(orders), max_runs)
        indices = multi_indices.total_degree(orders)
        points = subsets.choose_points(orders, indices, **_known(subsets.choose_points, options))
        _check_runs(method, order, len(points), max_runs)
    else:
        points = scans.scan_points(free, **_known(scans.scan_points, options))
        _check_runs(method, order, len(points), max_runs)
        indices = np.zeros((0, len(free)), dtype=int)
        if not no_surrogate:
            indices = multi_indices.total_degree(orders)
            if len(indices) > len(points):
                raise IntervalError(
                    "samples", len(points), f"at least {len(indices)} for order {order}"
                )
    kept = {k: v for k, v in options.items() if k != "existing"}
    return Design(points, indices, method, tuple(int(n) for n in orders), kept)


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


def _check_runs(method: str, order, runs: int, max_runs: int) -> None:
    if runs > max_runs:
        raise IntervalError(
            "order", order, f"an order for which {method} needs at most {max_runs} runs, not {runs}"
        )


def _known(function, options: dict) -> dict:
    """The options, after refusing those that `function` does not take."""
    code = function.__code__
    allowed = code.co_varnames[code.co_argcount : code.co_argcount + code.co_kwonlyargcount]
    for key in options:
        if key not in allowed:
            raise IntervalError("design option", key, "one of " + ", ".join(allowed))
    return options


def _refuse_options(method: str, options: dict) -> None:
    for key in options:
        raise IntervalError("design option", key, f"none for {method}")


def _grid(nodes: list[np.ndarray]) -> np.ndarray:
    """Tensor grid (N, k) of one-dimensional nodes, last direction fastest."""
    return np.stack([g.ravel() for g in np.meshgrid(*nodes, indexing="ij")], axis=1)
