"""Points of a plain scan and of the held-out runs: corners and space-filling sequences."""

from __future__ import annotations

import itertools

import numpy as np

from .exceptions import check_choice, check_integer

SEQUENCES = ("sobol", "latin_hypercube")


def scan_points(
    free: np.ndarray,
    *,
    samples: int = 1024,
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


def corner_points(free: np.ndarray) -> np.ndarray:
    """Corners (2^f, k), opposite ones next to each other, so that the first few are spread out."""
    free = np.asarray(free, dtype=bool)
    dimension = int(free.sum())
    if dimension == 0:
        return np.zeros((1, len(free)))
    half = [(-1.0, *rest) for rest in itertools.product((-1.0, 1.0), repeat=dimension - 1)]
    signs = np.array([s for corner in half for s in (corner, tuple(-c for c in corner))])
    points = np.zeros((len(signs), len(free)))
    points[:, free] = signs
    return points


def held_out_points(free: np.ndarray, count: int, avoid: np.ndarray | None = None) -> np.ndarray:
    """Points (count, k) for the runs that test a surrogate and do not enter it.

    Corners come first, for at most half of the points, because a surrogate is worst at the edges;
    then an R-sequence (Roberts 2018: additive recurrence with the generalised golden ratio), whose
    first points are those of any longer sequence. Points that are in `avoid` (R, k) are skipped:
    a node tells nothing about the error.
    """
    free = np.asarray(free, dtype=bool)
    count = check_integer("held_out", count, 0, 100_000)
    dimension = int(free.sum())
    if dimension == 0 or count == 0:
        return np.zeros((0, len(free)))
    taken = [] if avoid is None else [tuple(p) for p in np.round(avoid, 12) + 0.0]
    taken = set(taken)
    chosen = [p for p in corner_points(free) if tuple(p + 0.0) not in taken][: (count + 1) // 2]
    ratio = 2.0
    for _ in range(60):  # fixed point of x^(d+1) = x + 1
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    i = 0
    while len(chosen) < count:
        i += 1
        point = np.zeros(len(free))
        point[free] = 2 * np.mod(0.5 + i * steps, 1.0) - 1
        if tuple(np.round(point, 12) + 0.0) not in taken:
            chosen.append(point)
    return np.array(chosen)
