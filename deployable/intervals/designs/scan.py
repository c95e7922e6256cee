"""A scan: the corners of the box, then a space-filling sequence."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import IntervalError, check_choice, check_integer
from ..points import corner_points
from . import multi_indices
from .design import Design, Method

SEQUENCES = ("sobol", "latin_hypercube")


def _make(
    orders: np.ndarray | None,
    free: np.ndarray,
    limit: Callable[[int], None],
    *,
    samples: int = 1024,
    seed: int = 0,
    sequence: str = "sobol",
) -> Design:
    points = scan_points(free, samples, seed=seed, sequence=sequence)
    limit(len(points))
    if orders is None:  # no surrogate, only the least and the largest sample
        return Design(points, np.zeros((0, len(free)), dtype=int))
    indices = multi_indices.total_degree(orders)
    if len(indices) > len(points):
        told = f"at least {len(indices)} for order {orders.tolist()}"
        raise IntervalError("samples", len(points), told)
    return Design(points, indices)


def scan_points(
    free: np.ndarray,
    samples: int = 1024,
    *,
    seed: int = 0,
    sequence: str = "sobol",
    corners: bool = True,
) -> np.ndarray:
    """Points (samples, k) of a scan: the corners of the box, then a space-filling sequence.

    `free` (k) marks the directions with a width; the others stay at 0. The corners are left out
    when they would take more than half of the samples. A Sobol scan with more samples contains the
    smaller one with the same seed, so that its runs are reused; a Latin hypercube does not.
    """
    samples = check_integer("samples", samples, 1, 10_000_000)
    seed = check_integer("seed", seed, 0, 2**32 - 1)
    check_choice("sequence", sequence, SEQUENCES)
    free = np.asarray(free, dtype=bool)
    points = np.zeros((samples, len(free)))
    if not free.any():
        return points[:1]
    vertices = corner_points(free) if corners else np.zeros((0, len(free)))
    if 2 * len(vertices) > max(samples, 2):
        vertices = vertices[:0]
    vertices = vertices[:samples]
    points[: len(vertices)] = vertices
    rest = samples - len(vertices)
    if rest:
        points[len(vertices) :, free] = 2 * _sequence(int(free.sum()), rest, seed, sequence) - 1
    return points


def _sequence(dimension: int, count: int, seed: int, sequence: str) -> np.ndarray:
    """Points (count, dimension) in the unit cube [0, 1]."""
    from scipy.stats import qmc  # slow to import, needed only here

    if sequence == "latin_hypercube":
        return qmc.LatinHypercube(dimension, rng=seed).random(count)
    sampler = qmc.Sobol(dimension, scramble=True, rng=seed)
    power = max(int(np.ceil(np.log2(count))), 0)
    return sampler.random_base2(power)[:count]


SCAN = Method(_make, needs_order=False, symmetric=False)
