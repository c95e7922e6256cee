"""Products of vectors as building a scene takes them, by the hundred: to the last bit those of
numpy, several times as fast for few vectors."""

import math

import numpy as np

_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


def cross(a, b) -> np.ndarray:
    """Return vector products (..., 3) of a and b, as numpy.cross, only faster."""
    a, b = np.asarray(a), np.asarray(b)
    if a.ndim == 1:
        (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
        return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1], float)
    product = a.take(_NEXT, -1) * b.take(_LAST, -1)
    product = product.astype(np.result_type(product, float), copy=False)
    product -= a.take(_LAST, -1) * b.take(_NEXT, -1)
    return product


def length(vector: np.ndarray) -> float:
    """Return the Euclidean length of a vector (3,): what numpy.linalg.norm returns, faster."""
    vector = np.ascontiguousarray(vector)  # the sum of products may round otherwise
    return math.sqrt(vector.dot(vector))


def columns(*parts) -> np.ndarray:
    """Join k numbers or arrays as columns along a new last axis, (..., k), as numpy.stack(parts,
    axis=-1) does, but faster. parts: the first has the shape (...) of all."""
    array = np.empty((*np.shape(parts[0]), len(parts)), np.result_type(*parts))
    for k, part in enumerate(parts):
        array[..., k] = part
    return array
