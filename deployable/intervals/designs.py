"""Designs of experiments: where in the box the runs are, and which polynomials they determine.

`make_design` is the one entry, `fit` gives the polynomials. All points are in unit coordinates
[-1, 1]^k; an interval of zero width contributes one point (0) in its direction. A new design is a
function that makes it, and a line in `METHODS`."""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from . import chebyshev
from .box import MAX_DIMENSION, MOST_FULL, Box, axis_points, corner_points, match_points
from .chebyshev import Surrogate, least_squares, product_basis
from .errors import IntervalError, check_choice, check_integer, check_options
from .sobol import sobol
from .splines import predict_runs

MAX_ORDER = 64
MAX_RUNS = 100_000
MAX_TERMS = 10_000  # polynomials that can be fitted together on a sparse grid: their matrix is full


@dataclass(frozen=True)
class Design:
    """Points at which the model is run, and the polynomials they determine; made by `make_design`.
    points (N, k) in [-1, 1]; multi_indices (M, k): degrees of the Chebyshev products, (0, k) for a
    scan; method: a name in `METHODS`, "adaptive" or "own" (a user's); order (k): by direction;
    lines: k arrays (n_j + 1) of coordinates of a full tensor grid in the order of `multi_indices`,
    else None."""

    points: np.ndarray
    multi_indices: np.ndarray
    method: str = ""
    order: tuple[int, ...] = ()
    lines: tuple[np.ndarray, ...] | None = None

    @property
    def dimension(self) -> int:
        """Number k of parameters."""
        return self.points.shape[1]

    @property
    def run_count(self) -> int:
        """Number N of points, at each of which the model is run."""
        return self.points.shape[0]


@dataclass(frozen=True)
class Method:
    """A type of design of experiments (entry of `METHODS`): how it is made, what a user must give.

    make: ``make(orders, free, limit, **options)`` returns a `Design`. orders (k): polynomial
    orders, 0 in directions without a width, None where a user gave none; free (k): mask of the
    directions with a width; limit: function that it calls with the number of its points as soon as
    that is known, and that raises if there are too many; options: its keyword-only arguments, for
    users. needs_order: whether a user must give an order. most: directions at most."""

    make: Callable[..., Design]
    needs_order: bool = True
    most: int = MOST_FULL

    @property
    def options(self) -> tuple[str, ...]:
        """Names of the options that a user has: the keyword-only arguments of `make`."""
        parameters = inspect.signature(self.make).parameters.values()
        return tuple(p.name for p in parameters if p.kind is p.KEYWORD_ONLY)


def make_design(
    method: str,
    box: Box | int,
    order: int | Sequence[int] | None = None,
    *,
    max_runs: int = MAX_RUNS,
    **options,
) -> Design:
    """Make a design of experiments: points of the box at which the model is to be run.
    Raises `IntervalError` for a wrong method, order or option, or more than ``max_runs`` points.

    Parameters
    ----------
    method: ``tensor_roots`` (full grid of (n + 1)^k Chebyshev roots), ``tensor_lobatto`` (full grid
        of extreme points; nested when the order doubles, corners included), ``smolyak`` (sparse
        grid of nested Lobatto rules), ``sobol`` (corners and a Sobol sequence), each in up to 8
        directions; ``screening`` (centre, ends one at a time, a two-level design with its
        fold-over) in up to 60.
    box: a Box, or a number of directions that all have a width.
    order: polynomial order n >= 1, or one for each direction (0 keeps a direction constant).
        ``sobol`` may have none: then there is no surrogate, only the least and largest sample. With
        one, the polynomials of that total degree are fitted by least squares. ``screening`` takes
        none: its polynomials are sums of quadratic ones of one parameter each.
    max_runs: largest number of points that is allowed.
    options: of ``sobol``: ``samples``, the number of points (1024), and ``seed`` of the sequence
        (0). Of ``screening``: ``samples``, the most points that are allowed (1024)."""
    kind = METHODS[check_choice("method", method, METHODS)]
    if isinstance(box, Box):
        free = box.free
    else:
        free = np.ones(check_integer("box dimension", box, 1, MAX_DIMENSION), dtype=bool)
    if free.sum() > kind.most:
        allowed = f"up to {kind.most} intervals, or method screening for up to {MAX_DIMENSION}"
        raise IntervalError("method", f"{method} of {free.sum()} intervals", allowed)
    max_runs = check_integer("max_runs", max_runs, 1, 10**7)
    orders = None if order is None and not kind.needs_order else _orders(order, free)
    check_options("design option", kind.make, options)

    def limit(runs: int) -> None:
        if runs > max_runs:
            allowed = f"an order for which {method} needs at most {max_runs} runs, not {runs}"
            raise IntervalError("order", order, allowed)

    design = kind.make(orders, free, limit, **options)
    degrees = (0,) * len(free) if orders is None else tuple(int(n) for n in orders)
    return replace(design, method=method, order=degrees)


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


def _tensor(rule, orders: np.ndarray, free: np.ndarray, limit: Callable[[int], None]) -> Design:
    """Full grid of Chebyshev points by a rule in one direction: (n + 1)^k runs for order n."""
    limit(int(np.prod(orders.astype(float) + 1)))
    lines = tuple(rule(int(n)) for n in orders)
    return Design(chebyshev.grid(lines), chebyshev.tensor(orders), lines=lines)


def _smolyak(orders: np.ndarray, free: np.ndarray, limit: Callable[[int], None]) -> Design:
    """Sparse grid of nested Lobatto rules; a basis index owns the node of the same number."""
    count = chebyshev.count_smolyak(orders)
    limit(count)
    if count > MAX_TERMS:
        allowed = f"an order with at most {MAX_TERMS} of them"
        raise IntervalError("order", f"{count} polynomials", allowed)
    indices = chebyshev.smolyak(orders)
    nodes, degree = [0.0, -1.0, 1.0], 2
    while len(nodes) <= indices.max():
        degree *= 2
        nodes.extend(chebyshev.lobatto(degree)[1::2])
    return Design(np.array(nodes)[indices], indices)


def _sobol(
    orders: np.ndarray | None,
    free: np.ndarray,
    limit: Callable[[int], None],
    *,
    samples: int = 1024,
    seed: int = 0,
) -> Design:
    """Return the corners of the box, then a space-filling sequence."""
    points = scan_points(free, samples, seed=seed)
    limit(len(points))
    if orders is None:  # no surrogate, only the least and the largest sample
        return Design(points, np.zeros((0, len(free)), dtype=int))
    indices = chebyshev.total_degree(orders)
    if len(indices) > len(points):
        allowed = f"at least {len(indices)} for order {orders.tolist()}"
        raise IntervalError("samples", len(points), allowed)
    return Design(points, indices)


def _screening(
    orders: None, free: np.ndarray, limit: Callable[[int], None], *, samples: int = 1024
) -> Design:
    """Return the centre, the ends of each interval alone, and a two-level orthogonal array with its
    fold-over, which keeps main effects clear of interactions of two parameters (Box and Wilson
    1951). The array is Paley's Hadamard matrix of order q + 1, q prime (Plackett and Burman 1946):
    products of its columns are no columns, so that pairs can be told apart."""
    if orders is not None:
        raise IntervalError("order", orders.tolist(), "none with screening")
    count = int(free.sum())
    size = next(q for q in (3, 7, 11, 19, 23, 31, 43, 47, 59) if q >= count - 1)
    numbers = np.arange(size)
    squares = np.isin(np.subtract.outer(numbers, numbers) % size, numbers**2 % size)
    array = np.ones((size + 1, size + 1))
    array[1:] = np.column_stack([-np.ones(size), np.where(squares, 1.0, -1.0)])
    corners = np.zeros((2 * len(array), len(free)))
    corners[::2, free], corners[1::2, free] = array[:, :count], -array[:, :count]
    centre = np.zeros((1, len(free)))
    points = np.concatenate([centre, axis_points(free), corners]) if count else centre
    limit(len(points))
    if len(points) > samples:
        raise IntervalError("samples", samples, f"at least {len(points)} of {count} intervals")
    degrees = np.eye(len(free), dtype=int)[free]
    return Design(points, np.concatenate([centre.astype(int), degrees, 2 * degrees]))


def complete_runs(
    design: Design, points: np.ndarray, values: np.ndarray, failed_points: np.ndarray
) -> tuple[np.ndarray, np.ndarray | float]:
    """Return the values (N, ...) of runs at the N points of a design, in their order, where runs
    that failed are predicted by a spline through others, and the error (...) of that, 0 if none
    failed. points (R, k), values (R, ...): of the runs; failed_points (F, k): of those that failed.
    Raises IntervalError if a point has no run, or too few runs are left for a spline."""
    rows = match_points(design.points, np.concatenate([points, failed_points]))
    is_lost = rows >= len(points)
    if not is_lost.any():
        return values[rows], 0.0
    run_values = values[np.where(is_lost, 0, rows)]
    run_values[is_lost], error = predict_runs(points, values, design.points[is_lost])
    return run_values, error


METHODS: dict[str, Method] = {
    "tensor_roots": Method(partial(_tensor, chebyshev.roots)),
    "tensor_lobatto": Method(partial(_tensor, chebyshev.lobatto)),
    "smolyak": Method(_smolyak),
    "sobol": Method(_sobol, needs_order=False),
    "screening": Method(_screening, needs_order=False, most=MAX_DIMENSION),
}


def scan_points(
    free: np.ndarray, samples: int = 1024, *, seed: int = 0, corners: bool = True
) -> np.ndarray:
    """Points (samples, k) of [-1, 1]^k: the corners (if wanted, and no more than half), then a
    Sobol sequence; a single 0 where no direction has a width. free (k): mask; seed: of the
    scrambling. A longer sample with the same seed contains the shorter one, unless only it has
    corners."""
    samples = check_integer("samples", samples, 1, 10_000_000)
    seed = check_integer("seed", seed, 0, 2**32 - 1)
    free = np.asarray(free, dtype=bool)
    points = np.zeros((samples, len(free)))
    if not free.any():
        return points[:1]
    first = 2 ** int(free.sum()) if corners else 0
    if 2 * first > max(samples, 2):
        first = 0
    points[:first] = corner_points(free)[:first]
    rest = samples - first
    if rest > 0:
        points[first:, free] = 2 * sobol(rest, int(free.sum()), seed) - 1
    return points


def is_plain_scan(design: Design) -> bool:
    """Return whether a design is of points alone, to which no polynomial belongs."""
    return not len(design.multi_indices) and design.method not in ("adaptive", "own")


def spread_points(free: np.ndarray, count: int, seed: int = 1) -> np.ndarray:
    """Points (about `count`, k) in [-1, 1]^k from which extremes are sought: corners and a Sobol
    sequence, half of it pushed to faces; along a line if one direction has a width, a point if none
    has. free (k): mask of the directions with a width, 0 in the others; seed: of the sequence."""
    dimension = int(np.sum(free))
    if dimension == 0:
        return np.zeros((1, len(free)))
    if dimension == 1:
        points = np.zeros((max(count, 3), len(free)))
        points[:, free] = np.linspace(-1.0, 1.0, len(points))[:, None]
        return points
    points = scan_points(free, samples=count, seed=seed, corners=False)
    half = points[: count // 2]
    outer = np.abs(half) > 0.7
    half[outer] = np.sign(half[outer])
    return np.unique(np.concatenate([corner_points(free), points]), axis=0)


def fit(design: Design, values: np.ndarray) -> Surrogate:
    """Fit the polynomials of `design` to `values` (N, ...) of runs at its points, in order.
    IntervalError for values that are not finite, no order, or undetermined coefficients. Tensor
    grids take one small matrix for each direction; others least squares by QR factorisation."""
    values = np.asarray(values, dtype=float)
    if values.shape[:1] != (design.run_count,):
        raise IntervalError("values", values.shape, f"{design.run_count} rows, one for each point")
    if not len(design.multi_indices):
        raise IntervalError("design", design.method, "a design with an order, to fit a surrogate")
    if not np.isfinite(values).all():
        raise IntervalError("values", "not finite", "finite numbers at every point and instant")
    if design.lines is not None:
        coefficients = values.reshape(*(len(line) for line in design.lines), -1)
        for j, line in enumerate(design.lines):
            matrix = np.linalg.inv(chebvander(line, len(line) - 1))
            coefficients = np.moveaxis(np.tensordot(matrix, coefficients, axes=(1, j)), 0, j)
        coefficients = np.ascontiguousarray(coefficients)
    else:
        basis = product_basis(design.points, design.multi_indices)
        solution = least_squares(basis, values.reshape(design.run_count, -1))
        if solution is None:
            allowed = "points that determine every coefficient"
            raise IntervalError("points", f"{design.run_count} of them", allowed)
        coefficients = solution[0]
    shape = len(design.multi_indices), *values.shape[1:]
    return Surrogate(coefficients.reshape(shape), design.multi_indices)
