"""Guaranteed outer enclosures of polynomials in several variables.

`effects_enclosure` and `grid_enclosure` need no subdivision. `tighten` takes the Bernstein form: a
polynomial on a patch lies between its least and its largest coefficient. Halving patches is sharp
at a quadratic rate, and a patch that cannot beat the best value known is dropped (Garloff 1985;
Smith 2009)."""

from functools import cache
from math import comb

import numpy as np

from .chebyshev import grid, lobatto, product_basis
from .line_range import improve, line_range

_MAX_GRID = 20_000
_CHUNK = 1 << 23


def effects_enclosure(c: np.ndarray, indices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bound T polynomials on [-1, 1]^k, lower and upper (T), by exact ranges of the main effects
    and |coefficients| of the interactions. c (M, T): coefficients; indices (M, k): degrees of the
    Chebyshev products. Sharp where interactions are small, and cheap."""
    active = (indices > 0).sum(axis=1)
    rest = np.abs(c[active > 1]).sum(axis=0)
    lower, upper = c[active == 0].sum(axis=0), c[active == 0].sum(axis=0)
    for j in range(indices.shape[1]):
        rows = np.flatnonzero((active == 1) & (indices[:, j] > 0))
        if len(rows):
            line = np.zeros((int(indices[rows, j].max()) + 1, c.shape[1]))
            line[indices[rows, j]] = c[rows]
            low, high, _, _, rounding_error = line_range(line)
            lower, upper = lower + low - rounding_error, upper + high + rounding_error
    return lower - rest, upper + rest


def grid_enclosure(
    c: np.ndarray, indices: np.ndarray, density: int = 8
) -> tuple[np.ndarray, np.ndarray]:
    """Bound T polynomials on [-1, 1]^k: returns lower and upper bounds (T), inflated extremes on a
    grid. c (M, T): coefficients; indices (M, k): degrees of the Chebyshev products; density: grid
    points (extreme points of T_m) per degree, fewer if too many; without one, bounds are infinite.

    Two inflations are valid, and the smaller one is taken for each polynomial:

    - Ehlich and Zeller (1964): on the m roots of T_m a polynomial of degree n < m has max |p| <=
      max_grid |p| / cos(n pi / (2 m)) in each direction; applied to p minus the middle of its grid
      values.
    - with x_j = cos t_j, between the nodes of a grid of spacing h_j in t_j a function exceeds its
      multilinear interpolant by at most sum_j h_j^2 / 8 max |d^2 p / d t_j^2|, and |d^2 p / d
      t_j^2| <= sum i_j^2 |c_i|. Sharper where the coefficients decay."""
    degrees = indices.max(axis=0)
    total = c.shape[1]
    while density > 1 and np.prod(density * degrees + 1.0) > _MAX_GRID:
        density -= 1
    if np.prod(density * degrees + 1.0) > _MAX_GRID or density < 2:
        return np.full(total, -np.inf), np.full(total, np.inf)
    counts = density * degrees
    basis = product_basis(grid([lobatto(int(m)) for m in counts]), indices)
    low, high = np.empty(total), np.empty(total)
    step = max(_CHUNK // len(basis), 1)
    for start in range(0, total, step):
        values = basis @ c[:, start : start + step]
        low[start : start + step] = values.min(axis=0)
        high[start : start + step] = values.max(axis=0)
    active = degrees > 0
    # the factor also holds for the extreme points of T_m, which resolve cos(n t) as finely
    factor = np.prod(1.0 / np.cos(np.pi * degrees[active] / (2 * counts[active])))
    ehlich_zeller = (factor - 1.0) * (high - low) / 2
    curvature = np.zeros(total)
    for j in np.flatnonzero(active):
        curvature += (np.pi / counts[j]) ** 2 / 8 * ((indices[:, j] ** 2.0) @ np.abs(c))
    rounding = 8 * np.finfo(float).eps * (degrees.sum() + 2) * np.abs(c).sum(axis=0)
    inflation = np.minimum(ehlich_zeller, curvature) + rounding
    return low - inflation, high + inflation


MAX_DEGREE = 12  # beyond, the change of basis loses too many digits
MAX_TENSOR = 70_000  # coefficients of one patch
_MEMORY = 1 << 22  # most numbers in the patches of one chunk of instants
_CHUNK_SIZE = 256  # instants; more while their first patches stay in a processor's cache:
_CACHE_SIZE = 1 << 16  # numbers
_WORK = 60_000  # numbers in all the patches that an instant may use on average


def tighten(
    dense: np.ndarray, inner: np.ndarray, outer: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tighten upper bounds of T polynomials over [-1, 1]^k by subdivision. dense (n_1 + 1, ..., n_k
    + 1, T): coefficients by degree; inner, outer (T): attained, upper bounds; tolerance (T): gap at
    which to stop. Returns upper bounds (T), largest values at vertices (T), -inf where none exceeds
    `inner`, and where (T, k). Degrees above 12, or too many coefficients, keep their bounds."""
    degrees = np.array(dense.shape[:-1]) - 1
    size = int(np.prod(degrees + 1))
    outer = outer.copy()
    value = np.full(len(inner), -np.inf)
    argument = np.zeros((len(inner), len(degrees)))
    if degrees.max() > MAX_DEGREE or size > MAX_TENSOR:
        return outer, value, argument
    todo = np.flatnonzero(outer - inner > tolerance)
    step = min(max(_CACHE_SIZE // (8 * size), _CHUNK_SIZE), max(_MEMORY // (8 * size), 1))
    for start in range(0, len(todo), step):
        part = todo[start : start + step]
        enclosure = _subdivide(dense[..., part], inner[part], tolerance[part], degrees)
        outer[part] = np.minimum(outer[part], enclosure[0])
        value[part], argument[part] = enclosure[1], enclosure[2]
    return outer, value, argument


def _subdivide(dense, inner, tolerance, degrees):
    """Branch and bound over patches (..., P); `owner` (P) is the instant of each."""
    k, total = len(degrees), dense.shape[-1]
    patches, size = dense, np.abs(dense)
    for j, n in enumerate(degrees):
        patches = _apply(_from_chebyshev(int(n)), patches, j)
        size = _apply(np.abs(_from_chebyshev(int(n))), size, j)
    rounding = 4 * np.finfo(float).eps * (degrees + 1).sum()
    rounding_error = rounding * size.reshape(-1, total).max(axis=0)
    best, argument = inner.copy(), np.zeros((total, k))
    is_improved = np.zeros(total, dtype=bool)
    closed_bound = np.full(total, -np.inf)
    owner = np.arange(total)
    centre, half = np.zeros((total, k)), np.ones((total, k))
    budget = max(_WORK // int(np.prod(degrees + 1)), 2) * max(total, 16)
    vertices = np.ix_(*[[0, -1] if n else [0] for n in degrees])
    grids = np.meshgrid(*[[-1, 1] if n else [0] for n in degrees], indexing="ij")
    signs = np.stack([grid.ravel() for grid in grids]).T
    while len(owner):
        corner = patches[vertices].reshape(len(signs), -1)
        vertex = corner.argmax(axis=0)
        top = corner[vertex, np.arange(len(owner))]
        is_improved[improve(best, argument, owner, top, centre + half * signs[vertex])] = True
        bound = patches.reshape(-1, len(owner)).max(axis=0)
        is_open = bound > best[owner] + tolerance[owner]
        budget -= len(owner)
        if budget <= 0 or not is_open.any():
            np.maximum.at(closed_bound, owner, bound)
            break
        np.maximum.at(closed_bound, owner[~is_open], bound[~is_open])
        patches, owner, bound = patches[..., is_open], owner[is_open], bound[is_open]
        centre, half = centre[is_open], half[is_open]
        room = max(_MEMORY // (2 * len(patches.reshape(-1, len(owner)))), 1)
        if len(owner) > room:
            # too many to hold: those that promise least are closed with the bound they have
            order = np.argsort(best[owner] - bound, kind="stable")
            np.maximum.at(closed_bound, owner[order[room:]], bound[order[room:]])
            keep = np.sort(order[:room])
            patches, owner = patches[..., keep], owner[keep]
            centre, half = centre[keep], half[keep]
        patches, owner, centre, half = _halve(patches, owner, centre, half, degrees)
    outer = np.maximum(np.maximum(closed_bound, best), inner) + rounding_error
    return outer, np.where(is_improved, best, -np.inf), argument


def _halve(patches, owner, centre, half, degrees):
    """Halve each patch in the direction in which its coefficients differ most."""
    count = len(owner)
    spread = np.zeros((len(degrees), count))
    for j, n in enumerate(degrees):
        if n:
            spread[j] = np.abs(np.diff(patches, axis=j)).reshape(-1, count).max(axis=0) * n
    direction = spread.argmax(axis=0)
    parts = []
    for j in np.unique(direction):
        columns = np.flatnonzero(direction == j)
        block, middle, width = patches[..., columns], centre[columns], half[columns].copy()
        width[:, j] /= 2
        for matrix, sign in zip(_halves(int(degrees[j])), (-1, 1), strict=True):
            new_middle = middle.copy()
            new_middle[:, j] += sign * width[:, j]
            parts.append((_apply(matrix, block, j), owner[columns], new_middle, width))
    return tuple(np.concatenate([p[i] for p in parts], axis=-1 if i == 0 else 0) for i in range(4))


def _apply(matrix: np.ndarray, tensor: np.ndarray, axis: int) -> np.ndarray:
    """Multiply `tensor` along `axis` by `matrix` (m, n)."""
    shape = tensor.shape
    rows = int(np.prod(shape[:axis], dtype=int))
    blocks = tensor.reshape(rows, shape[axis], -1)
    return np.matmul(matrix, blocks).reshape(*shape[:axis], len(matrix), *shape[axis + 1 :])


@cache
def _from_chebyshev(n: int) -> np.ndarray:
    """Matrix (n+1, n+1) from Chebyshev to Bernstein coefficients of degree n on [-1, 1]: (-1)^(i-l)
    C(2i, 2l) / C(i, l) of degree i for T_i (Rababah 2003), raised to degree n."""
    matrix = np.zeros((n + 1, n + 1))
    for i in range(n + 1):
        column = [(-1) ** (i - m) * comb(2 * i, 2 * m) / comb(i, m) for m in range(i + 1)]
        for row in range(n + 1):
            matrix[row, i] = sum(
                comb(i, m) * comb(n - i, row - m) / comb(n, row) * column[m]
                for m in range(max(0, row - n + i), min(i, row) + 1)
            )
    return matrix


@cache
def _halves(n: int) -> tuple[np.ndarray, np.ndarray]:
    """De Casteljau matrices (n+1, n+1) of the left and the right half of a patch."""
    left_half = np.array([[comb(i, j) / 2**i for j in range(n + 1)] for i in range(n + 1)])
    return left_half, np.ascontiguousarray(left_half[::-1, ::-1])
