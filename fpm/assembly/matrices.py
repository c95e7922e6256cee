"""Matrices by the motions of particles, summed from entries: sparse, or full where these are few.

What makes a matrix takes one of the functions `sparse` and `full` as argument `form`."""

from collections.abc import Callable
from typing import Any

import numpy as np

Form = Callable[[np.ndarray, np.ndarray, np.ndarray, tuple[int, int]], Any]


def sparse(values: np.ndarray, rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]):
    """Return a sparse matrix of a shape, summed from entries: values, rows, columns, of one shape
    each, or of what numpy makes one."""
    from scipy.sparse import coo_array

    entries = [x.ravel() for x in np.broadcast_arrays(values, rows, columns)]
    return coo_array((entries[0], tuple(entries[1:])), shape=shape).tocsc()


def full(
    values: np.ndarray, rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]
) -> np.ndarray:
    """Return an array, as `sparse`: of few particles several times as fast."""
    places = (shape[1] * rows + columns).ravel()
    return np.bincount(places, values.ravel(), shape[0] * shape[1]).reshape(shape)


def dofs_of(pairs: np.ndarray) -> np.ndarray:
    """Return where in a motion (6n,) the entries (e, 12) of pairs of particles (e, 2) stand."""
    return (6 * pairs[:, :, None] + np.arange(6)).reshape(len(pairs), 12)


def pair_matrix(blocks: np.ndarray, pairs: np.ndarray, count: int, form: Form):
    """Return a matrix (6 count, 6 count) by the motions of all particles, summed from blocks (e,
    12, 12), each of a pair. pairs (e, 2): particle indices; count: of all particles."""
    dofs = dofs_of(pairs)
    return form(blocks, dofs[:, :, None], dofs[:, None], (6 * count, 6 * count))


def scale_matrix(matrix, rows: np.ndarray, columns: np.ndarray):
    """Return a copy of a matrix (r, c), sparse or an array, with each row times its factor in
    `rows` (r,), and each column times that in `columns` (c,), to make entries dimensionless."""
    if isinstance(matrix, np.ndarray):
        return matrix * rows[:, None] * columns
    matrix = matrix.tocsc(copy=True)
    matrix.data = matrix.data * rows[matrix.indices] * np.repeat(columns, np.diff(matrix.indptr))
    return matrix


def largest_entry(matrix) -> float:
    """Return the largest absolute value in a matrix, sparse or an array; 0 if it is empty."""
    return float(abs(matrix).max()) if matrix.size else 0.0


def saddle_solver(inner, rows, ease: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a function that solves equations with the symmetric matrix [[inner, rows'], [rows,
    -ease]] for a right-hand side (f + c,), NaN where it is exactly singular. inner (f, f), rows (c,
    f): sparse, or arrays; ease: by which the c conditions give, so that they may be redundant."""
    if isinstance(inner, np.ndarray):
        count = len(inner)
        matrix = -ease * np.eye(count + len(rows))
        matrix[:count, :count] = inner
        matrix[count:, :count], matrix[:count, count:] = rows, rows.T

        def solve(right: np.ndarray) -> np.ndarray:
            try:
                return np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return np.full(len(right), np.nan)

        return solve
    from scipy.sparse import bmat, identity
    from scipy.sparse.linalg import splu

    matrix = bmat([[inner, rows.T], [rows, -ease * identity(rows.shape[0])]], format="csc")
    try:
        return splu(matrix).solve
    except RuntimeError:
        return lambda right: np.full(len(right), np.nan)
