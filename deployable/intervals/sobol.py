"""Sobol points in up to 60 dimensions, as `scipy.stats.qmc` makes them, whose import takes more
than a second of processor time."""

import numpy as np

_BITS = 30

_DIRECTIONS = """
3.1 7.1.3 11.1.3.1 13.1.1.1 19.1.1.3.3 25.1.3.5.13 37.1.1.5.5.17 41.1.1.5.5.5 47.1.1.7.11.19
55.1.1.5.1.1 59.1.1.1.3.11 61.1.3.5.5.31 67.1.3.3.9.7.49 91.1.1.1.15.21.21 97.1.3.1.13.27.49
103.1.1.1.15.7.5 109.1.3.1.15.13.25 115.1.1.5.5.19.61 131.1.3.7.11.23.15.103
137.1.3.7.13.13.15.69 143.1.1.3.13.7.35.63 145.1.3.5.9.1.25.53 157.1.3.1.13.9.35.107
167.1.3.1.5.27.61.31 171.1.1.5.11.19.41.61 185.1.3.5.3.3.13.69 191.1.1.7.13.1.19.1
193.1.3.7.5.13.19.59 203.1.1.3.9.25.29.41 211.1.3.5.13.23.1.55 213.1.3.7.3.13.59.17
229.1.3.1.3.5.53.69 239.1.1.5.5.23.33.13 241.1.1.7.7.1.61.123 247.1.1.7.9.13.61.49
253.1.3.3.5.3.55.33 285.1.3.1.15.31.13.49.245 299.1.3.5.15.31.59.63.97
301.1.3.1.11.11.11.77.249 333.1.3.1.11.27.43.71.9 351.1.1.7.15.21.11.81.45
355.1.3.7.3.25.31.65.79 357.1.3.1.1.19.11.3.205 361.1.1.5.9.19.21.29.157
369.1.3.7.11.1.33.89.185 391.1.3.3.3.15.9.79.71 397.1.3.7.11.15.39.119.27
425.1.1.3.1.11.31.97.225 451.1.1.1.3.23.43.57.177 463.1.3.7.7.17.17.37.71
487.1.3.1.5.27.63.123.213 501.1.1.3.5.11.43.53.133 529.1.3.5.5.29.17.47.173.479
539.1.3.3.11.3.1.109.9.69 545.1.1.1.5.17.39.23.5.343 557.1.3.1.5.25.15.31.103.499
563.1.1.1.11.11.17.63.105.183 601.1.1.5.11.9.29.97.231.363 607.1.1.5.15.19.45.41.7.383
"""
"""From the second dimension on: a polynomial modulo 2, by its bits, and the first direction
numbers (Joe and Kuo 2008, doi:10.1137/070709359)."""


def sobol(count: int, dimension: int, seed: int) -> np.ndarray:
    """Return the first `count` points (count, dimension) of a Sobol sequence in [0, 1)^dimension.
    seed: of a random lower triangular matrix and shift of its digits (Matousek 1998)."""
    rng = np.random.default_rng(seed).spawn(1)[0]  # as scipy does
    values = 2 ** np.arange(_BITS, dtype=np.uint32)
    shift = rng.integers(2, size=(dimension, _BITS), dtype=np.uint32) @ values
    matrices = np.tril(rng.integers(2, size=(dimension, _BITS, _BITS), dtype=np.uint32), -1)
    digits = (_directions(dimension)[:, None] & values[::-1, None]) > 0
    directions = values[::-1] @ ((matrices + np.eye(_BITS, dtype=np.uint32)) @ digits % 2)
    numbers = np.arange(1, count)
    steps = directions.T[np.bitwise_count((numbers & -numbers) - 1)]
    return np.bitwise_xor.accumulate(np.concatenate([shift[None], steps])) * 0.5**_BITS


def _directions(dimension: int) -> np.ndarray:
    """Return the direction numbers (dimension, bits) of a sequence, as whole numbers."""
    rows = [[1 << (_BITS - 1 - j) for j in range(_BITS)]]
    for text in _DIRECTIONS.split()[: dimension - 1]:
        polynomial, *first = map(int, text.split("."))
        degree = len(first)
        row = [number << (_BITS - 1 - j) for j, number in enumerate(first)]
        for j in range(degree, _BITS):
            row.append(row[j - degree] ^ (row[j - degree] >> degree))
            for k in range(1, degree):
                row[j] ^= (polynomial >> (degree - k) & 1) * row[j - k]
        rows.append(row)
    return np.array(rows, np.uint32)
