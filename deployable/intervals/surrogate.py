"""Chebyshev surrogates: polynomials of the parameters, one for each instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from .chebyshev import product_basis
from .designs import Design
from .errors import IntervalError


@dataclass(frozen=True)
class Surrogate:
    """sum_m coefficients[m] T_(i_m1)(x_1) ... T_(i_mk)(x_k) with x in [-1, 1]^k.

    Attributes
    ----------
    coefficients
        (M, ...); the trailing axes are instants, responses or whatever was fitted together.
    multi_indices
        (M, k).
    """

    coefficients: np.ndarray
    multi_indices: np.ndarray

    @property
    def dimension(self) -> int:
        """Number of directions k."""
        return self.multi_indices.shape[1]

    @property
    def degrees(self) -> np.ndarray:
        """Highest degree in each direction, (k)."""
        return self.multi_indices.max(axis=0)

    def evaluate(self, unit: np.ndarray) -> np.ndarray:
        """Values (P, ...) at unit coordinates (P, k)."""
        unit = np.asarray(unit, dtype=float)
        if unit.ndim != 2 or unit.shape[1] != self.dimension:
            raise IntervalError("unit", unit.shape, f"an array of shape (P, {self.dimension})")
        flat = self.coefficients.reshape(len(self.coefficients), -1)
        values = product_basis(unit, self.multi_indices) @ flat
        return values.reshape(len(unit), *self.coefficients.shape[1:])

    def dense(self) -> np.ndarray:
        """Coefficients as a full tensor (n_1 + 1, ..., n_k + 1, ...), zeros where absent."""
        shape = tuple(int(n) + 1 for n in self.degrees)
        full = np.zeros((*shape, *self.coefficients.shape[1:]))
        full[tuple(self.multi_indices.T)] = self.coefficients
        return full

    def restrict(self, direction: int, unit: np.ndarray) -> np.ndarray:
        """Coefficients (n_j + 1, ...) along one direction, the others held at `unit` (k)."""
        others = np.array(unit, dtype=float)
        weights = np.ones(len(self.multi_indices))
        for j, x in enumerate(others):
            if j != direction:
                values = chebvander(x, int(self.multi_indices[:, j].max()))[0]
                weights *= values[self.multi_indices[:, j]]
        line = np.zeros((int(self.degrees[direction]) + 1, *self.coefficients.shape[1:]))
        scaled = weights.reshape(-1, *[1] * (self.coefficients.ndim - 1)) * self.coefficients
        np.add.at(line, self.multi_indices[:, direction], scaled)
        return line


def fit(design: Design, values: np.ndarray) -> Surrogate:
    """Fit the polynomial of `design` to `values` (N, ...) at its points.

    Tensor grids use the discrete orthogonality of the Chebyshev polynomials (one small matrix
    product for each direction); the other designs use a QR factorisation, which is a solve where
    there are as many points as coefficients and least squares where there are more.
    """
    values = np.asarray(values, dtype=float)
    if values.shape[:1] != (design.runs,):
        raise IntervalError("values", values.shape, f"{design.runs} rows, one for each point")
    if not len(design.multi_indices):
        raise IntervalError("design", design.method, "a design with an order, to fit a surrogate")
    if not np.isfinite(values).all():
        raise IntervalError("values", "not finite", "finite numbers at every point and instant")
    if design.transform is not None:
        coefficients = _tensor_coefficients(design, values)
    else:
        coefficients = _solve(design.points, design.multi_indices, values)
    return Surrogate(coefficients, design.multi_indices)


def _tensor_coefficients(design: Design, values: np.ndarray) -> np.ndarray:
    shape = tuple(n + 1 for n in design.order)
    grid = values.reshape(*shape, -1)
    for j, n in enumerate(design.order):
        if n:
            grid = np.moveaxis(np.tensordot(design.transform(n), grid, axes=(1, j)), 0, j)
    return np.ascontiguousarray(grid).reshape(values.shape)


def _solve(points: np.ndarray, indices: np.ndarray, values: np.ndarray) -> np.ndarray:
    if len(points) < len(indices):
        raise IntervalError("points", len(points), f"at least {len(indices)}, one a coefficient")
    matrix = product_basis(points, indices)
    q, r = np.linalg.qr(matrix)
    size = np.abs(np.diag(r))
    if size.min() < 1e-10 * size.max():
        raise IntervalError(
            "points", f"{len(points)} of them", "points that determine every coefficient"
        )
    flat = np.linalg.solve(r, q.T @ values.reshape(len(points), -1))
    return flat.reshape(len(indices), *values.shape[1:])
