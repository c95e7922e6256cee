"""What a design is: points in the box, and the polynomials that they determine."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import IntervalError


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
    transform
        For a full tensor grid in the order of `multi_indices`: from an order n to the matrix
        (n + 1, n + 1) from values at the points of one direction to coefficients.
    """

    points: np.ndarray
    multi_indices: np.ndarray
    method: str = ""
    order: tuple[int, ...] = ()
    transform: Callable[[int], np.ndarray] | None = None

    @property
    def dimension(self) -> int:
        """Number of directions k."""
        return self.points.shape[1]

    @property
    def runs(self) -> int:
        """Number of points N."""
        return self.points.shape[0]


@dataclass(frozen=True)
class Method:
    """A kind of design.

    Attributes
    ----------
    make
        ``make(orders, free, limit, **options)`` gives the points and the basis of a `Design` for
        orders (k), 0 where a direction is not `free` (k), that is has no width; for no order if
        `needs_order` is false. It calls `limit` with the number of its points as soon as that is
        known; its keyword-only arguments are the options that a user has.
    needs_order
        Whether a user must give an order.
    symmetric
        Whether directions in another order have the same points, in that order. Directions of a
        sequence are not alike, nor are of points of which either does as well the one that comes
        first; such a design is always made in one order of the parameters, a campaign's in the
        structure's.
    """

    make: Callable[..., Design]
    needs_order: bool = True
    symmetric: bool = True

    @property
    def options(self) -> tuple[str, ...]:
        """Names of the options that a user has."""
        parameters = inspect.signature(self.make).parameters.values()
        return tuple(p.name for p in parameters if p.kind is p.KEYWORD_ONLY)


def check_terms(count: int, most: int) -> None:
    """IntervalError where a basis has more polynomials than can be handled."""
    if count > most:
        raise IntervalError(
            "order", f"{count} polynomials", f"an order with at most {most} of them"
        )
