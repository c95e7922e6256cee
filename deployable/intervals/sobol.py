"""Scrambled Sobol points, to the last bit those of `scipy.stats.qmc.Sobol`, whose import takes
longer than all else that is to be done before a campaign's runs.

Direction numbers: Joe and Kuo, SIAM J. Sci. Comput. 30 (2008) 2635 (criterion 6). Scrambled by
random lower triangular matrices of bits and a random shift: Matousek, J. Complexity 14 (1998) 527.
"""

from __future__ import annotations

import numpy as np

from .errors import IntervalError

# Of each dimension beyond the first: the inner coefficients of a primitive polynomial, as the bits
# of a number, and as many first direction numbers as its degree.
_PRIMITIVE = (
    (0, (1,)), (1, (1, 3)), (1, (1, 3, 1)), (2, (1, 1, 1)), (1, (1, 1, 3, 3)), (4, (1, 3, 5, 13)),
    (2, (1, 1, 5, 5, 17)),
)  # fmt: skip

MOST_DIMENSIONS = len(_PRIMITIVE) + 1

_BITS = 30


def sobol_points(dimension: int, count: int, seed: int) -> np.ndarray:
    """The first points (count, dimension) of a sequence in the unit cube [0, 1).

    Sequences of one seed are the same as far as they go. IntervalError beyond `MOST_DIMENSIONS`.
    """
    if dimension > MOST_DIMENSIONS:
        raise IntervalError("dimension", dimension, f"at most {MOST_DIMENSIONS} for sobol")
    (random,) = np.random.default_rng(seed).spawn(1)  # as scipy does
    bit = np.arange(_BITS, dtype=np.uint32)
    shift = random.integers(2, size=(dimension, _BITS), dtype=np.uint32) @ (1 << bit)
    mixed = np.tril(random.integers(2, size=(dimension, _BITS, _BITS), dtype=np.uint32))
    mixed[:, bit, bit] = 1
    # The first bit is the most significant one.
    digits = _directions(dimension)[:, None, :] >> bit[::-1, None] & 1
    numbers = ((mixed @ digits & 1) << bit[::-1, None]).sum(axis=1, dtype=np.uint32)
    points = shift[None]
    for number in numbers.T[: max(0, count - 1).bit_length()]:
        # In the order of Gray's code the second half is the first one backwards, with one bit more.
        points = np.concatenate([points, points[::-1] ^ number])
    return points[:count] * 2.0**-_BITS


def _directions(dimension: int) -> np.ndarray:
    """Direction numbers (dimension, bits), as far to the left as bits go."""
    found = np.ones((dimension, _BITS), dtype=np.uint32)
    for row, (inner, first) in zip(found[1:], _PRIMITIVE, strict=False):
        degree = len(first)
        row[:degree] = first
        for i in range(degree, _BITS):
            row[i] = row[i - degree] ^ row[i - degree] << degree
            for k in range(1, degree):
                if inner >> degree - 1 - k & 1:
                    row[i] ^= row[i - k] << k
    return found << np.arange(_BITS, dtype=np.uint32)[::-1]
