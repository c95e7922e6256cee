"""Functions of unit coordinates as tables of numbers, which other programs can evaluate."""

from dataclasses import dataclass, replace

import numpy as np

from .chebyshev import Surrogate


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
