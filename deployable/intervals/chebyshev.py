"""Chebyshev points and products on [-1, 1]^k, and the polynomials made of them.

A set of multi-indices has the shape (M, k); row m stands for T_(i_1)(x_1) ... T_(i_k)(x_k). Orders
are given per direction; a direction of order 0 does not enter.

Source: Trefethen, Approximation Theory and Approximation Practice (SIAM 2013), chapters 2-4."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import gcd

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from .errors import IntervalError


def _sine(numerator: np.ndarray, denominator: int) -> np.ndarray:
    """Return sin(pi numerator / (2 denominator)) of the reduced fraction, the same float in all
    grids."""
    points = np.empty(len(numerator))
    for i, top in enumerate(int(t) for t in numerator):
        divisor = gcd(abs(top), 2 * denominator) or 1
        points[i] = np.sin(np.pi * (top // divisor) / (2 * denominator // divisor))
    return points


def roots(order: int) -> np.ndarray:
    """Return the roots (n + 1) in [-1, 1] of the Chebyshev polynomial of degree n + 1, ascending;
    order: n."""
    return _sine(2 * np.arange(order + 1) - order, order + 1)


def lobatto(order: int) -> np.ndarray:
    """Return the n + 1 extreme points of the Chebyshev polynomial of degree n in [-1, 1],
    ascending; order: n; 0 gives the point 0, others contain -1 and 1 and are among those of 2n."""
    return _sine(2 * np.arange(order + 1) - order, order) if order else np.zeros(1)


def grid(lines: Sequence[np.ndarray]) -> np.ndarray:
    """Return all combinations (N, k) of coordinates along k directions. lines: k arrays of
    coordinates, of any lengths. The last direction varies fastest."""
    return np.stack([g.ravel() for g in np.meshgrid(*lines, indexing="ij")], axis=1)


def tensor(order: Sequence[int] | np.ndarray) -> np.ndarray:
    """Multi-indices i (M, k), degrees of Chebyshev products, of a full grid: all i with i_j <=
    order_j, the last direction fastest; order (k): highest degree of each direction."""
    return grid([np.arange(n + 1) for n in order])


def total_degree(order: Sequence[int] | np.ndarray) -> np.ndarray:
    """Multi-indices i (M, k), degrees of Chebyshev products, with sum_j i_j / order_j <= 1, sorted
    by total degree; for equal orders n all of total degree at most n, C(n + k, k) rows: 20 at k =
    3, n = 3. order (k): highest degree of each direction."""
    return _within_budget(order, lambda n: dict(zip(range(n + 1), range(n + 1), strict=True)))


def smolyak(order: Sequence[int] | np.ndarray) -> np.ndarray:
    """Multi-indices i (M, k) of Chebyshev products of a Smolyak sparse grid with slow growth,
    sorted by total degree: all with sum_j c(i_j) / order_j <= 1, c(n) being the least degree whose
    nested rule (1, 3, 5, 9, 17, ... points) has index n: 0, 1, 1, 3, 3, 5, 5, 5, 5, 9, ... order
    (k): 0: constant (Barthelmann, Novak and Ritter 2000 with the growth of Burkardt 2009)."""
    return _within_budget(order, _nested_costs)


def count_smolyak(order: Sequence[int] | np.ndarray) -> int:
    """Number M of multi-indices that `smolyak(order)` has, without making them, to check the size
    of a sparse grid; order (k): of each direction, as there."""
    counts = {0.0: 1}  # rows so far, by the share of the order that they use
    for n in (int(n) for n in order if n):
        new_counts: dict[float, int] = {}
        for (fraction, rows), cost in itertools.product(counts.items(), _nested_costs(n).values()):
            level = round(fraction + cost / n, 9)
            if level <= 1.0:
                new_counts[level] = new_counts.get(level, 0) + rows
        counts = new_counts
    return sum(counts.values())


def _nested_costs(order: int) -> dict[int, int]:
    """Least degree of the rule of 1, 3, 5, 9, 17, ... nested Lobatto points that includes each
    index: 0; 1 for 1 and 2, 3 for 3 and 4, 5 for 5 to 8, 9 for 9 to 16, ..."""
    costs = {0: 0}
    for degree in range(1, order + 1):
        highest = 2 if degree < 3 else 1 << (degree - 1).bit_length()
        costs |= dict.fromkeys(range(len(costs), highest + 1), degree)
    return costs


def _within_budget(
    order: Sequence[int] | np.ndarray, costs: Callable[[int], dict[int, int]]
) -> np.ndarray:
    """Return all i with sum_j cost(i_j) / order_j <= 1, sorted by total degree."""
    rows: list[tuple[tuple[int, ...], float]] = [((), 0.0)]
    # grow direction by direction, so that the full tensor is never built
    for n in (int(n) for n in order):
        steps = [(i, cost / (n or 1)) for i, cost in costs(n).items()]
        new_rows = [((*row, i), fraction + cost) for row, fraction in rows for i, cost in steps]
        rows = [(row, fraction) for row, fraction in new_rows if fraction <= 1.0 + 1e-9]
    indices = sorted((row for row, _ in rows), key=lambda row: (sum(row), tuple(-i for i in row)))
    return np.array(indices, dtype=int).reshape(len(indices), len(order))


def product_basis(points: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """Values (N, M) of Chebyshev products, degrees `indices` (M, k), at points (N, k), |x| <= 1."""
    values, rows = np.ones((len(points), len(indices))), np.arange(len(indices))
    lines = chebvander(points, int(indices.max(initial=0)))
    directions = np.argsort(indices == 0, axis=1, kind="stable").T  # those that enter come first
    for direction in directions[: (indices > 0).sum(axis=1).max(initial=0)]:
        values *= lines[:, direction, indices[rows, direction]]
    return values


@dataclass(frozen=True)
class Surrogate:
    """Polynomial surrogate sum_m coefficients[m] T_(i_m1)(x_1) ... T_(i_mk)(x_k), x in [-1, 1]^k,
    of one or more values at once. coefficients (M, ...): trailing axes are whatever was fitted
    together; multi_indices (M, k): degree i_mj of the Chebyshev polynomial T in each direction."""

    coefficients: np.ndarray
    multi_indices: np.ndarray

    @property
    def dimension(self) -> int:
        """Number k of parameters."""
        return self.multi_indices.shape[1]

    @property
    def degrees(self) -> np.ndarray:
        """Highest degree of the polynomial in each of the k directions (k)."""
        return self.multi_indices.max(axis=0)

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (P, ...) of the polynomial at `points` (P, k) in [-1, 1]^k; raises
        IntervalError for an array of another shape."""
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != self.dimension:
            raise IntervalError("points", points.shape, f"an array of shape (P, {self.dimension})")
        flat = self.coefficients.reshape(len(self.coefficients), -1)
        values = product_basis(points, self.multi_indices) @ flat
        return values.reshape(len(points), *self.coefficients.shape[1:])

    def dense(self) -> np.ndarray:
        """Coefficients as a full tensor (n_1 + 1, ..., n_k + 1, ...) by degree, n_j being the
        highest one in direction j; zeros for products that the polynomial does not have."""
        full = np.zeros((*(self.degrees + 1), *self.coefficients.shape[1:]))
        full[tuple(self.multi_indices.T)] = self.coefficients
        return full

    def restrict(self, direction: int, points: np.ndarray) -> np.ndarray:
        """Chebyshev coefficients (n_j + 1, ...) of the polynomial as a function of one coordinate,
        of index j (`direction`), others held at those of the point `points` (k) in [-1, 1]^k."""
        cross_indices = self.multi_indices.copy()
        cross_indices[:, direction] = 0
        weights = product_basis(np.asarray(points, dtype=float)[None], cross_indices)[0]
        line = np.zeros((int(self.degrees[direction]) + 1, *self.coefficients.shape[1:]))
        terms = weights.reshape(-1, *[1] * (self.coefficients.ndim - 1)) * self.coefficients
        np.add.at(line, self.multi_indices[:, direction], terms)
        return line


def least_squares(basis: np.ndarray, values: np.ndarray, least: float = 1e-10) -> tuple | None:
    """Fit values (N, T), or (N), by the columns of `basis` (N, M), with a QR factorisation: returns
    coefficients (M, T), or (M), and the leverage (N) of each row (diagonal of the hat matrix), or
    None where the smallest pivot is below `least` times the largest (undetermined)."""
    q, r = np.linalg.qr(basis)
    size = np.abs(np.diag(r))
    if size.min() < least * size.max():
        return None
    return np.linalg.solve(r, q.T @ values), (q**2).sum(axis=1)


# -- functions as tables of numbers, which other programs can evaluate -----------------------------


@dataclass(frozen=True)
class Formula:
    """A function of k normalized coordinates x as a table of numbers, which other programs can
    evaluate: sum_m coefficients[m] T_(i_m1)(x_1) ... T_(i_mk)(x_k) + sum_n weights[n]
    kernel(|scales (x - points[n])|), T_i being the Chebyshev polynomial of degree i.

    indices (M, k): degrees i; coefficients (M); points (N, k), weights (N), scales (k): those of
    the kernel; kernel, of a distance d: `cube` d^3, `fading` exp(-d), or `matern` (1 + d + d^2 / 3)
    exp(-d). root: None, or a formula r of the first k - 1 coordinates from which the last one
    follows: 2 sqrt(r / root_scale) - 1, with r / root_scale clipped to [0, 1]."""

    indices: np.ndarray
    coefficients: np.ndarray
    points: np.ndarray
    scales: np.ndarray
    weights: np.ndarray
    kernel: str
    root: "Formula | None" = None
    root_scale: float = 1.0

    def shortfall(self, level: float) -> "Formula":
        """Return the formula of `level` minus this function: above 0 where it is below that."""
        constant = np.zeros((1, self.indices.shape[1]), dtype=int)
        return replace(
            self,
            indices=np.concatenate([self.indices, constant]),
            coefficients=np.append(-self.coefficients, level),
            weights=-self.weights,
        )


def polynomial(surrogate: Surrogate) -> "Formula":
    """Write a polynomial surrogate of one number, coefficients (M, 1), as a `Formula` (a table)."""
    k = surrogate.dimension
    points, coefficients = np.zeros((0, k)), surrogate.coefficients[:, 0]
    return Formula(surrogate.multi_indices, coefficients, points, np.ones(k), np.zeros(0), "cube")


def cubes(
    points: np.ndarray, scales: np.ndarray, weights: np.ndarray, linear: np.ndarray
) -> "Formula":
    """A cubic spline as a table: a linear function plus, for each of N points, its weight times the
    cubed distance from it. points (N, k), weights (N); scales (k): factors of the differences
    before the distance is taken; linear (1 + k): the constant, and the slopes."""
    indices = np.concatenate([np.zeros((1, len(scales)), int), np.eye(len(scales), dtype=int)])
    return Formula(indices, linear, points, scales, weights, "cube")
