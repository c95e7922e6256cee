"""Three-vectors of lanes as tuples: what the kernels are written in."""

from numba import njit

from fpm.kernels.lanes import load, store

OPTIONS = {"error_model": "numpy", "boundscheck": False, "nogil": True}
"""Compiler options of every kernel: no branches for division by zero, no GIL."""

kernel = njit(forceinline=True, **OPTIONS)
"""Compile a kernel into its callers. A call would spill all vector registers; and a kernel that
stood alone as well could be rounded otherwise there than in the cached time loop.
"""


@kernel
def get3(a, i, k):
    """The vector in fields k, k+1, k+2 of row i."""
    return load(a, i, k), load(a, i, k + 1), load(a, i, k + 2)


@kernel
def put3(a, i, k, v):
    """Write a vector to fields k, k+1, k+2 of row i."""
    store(a, i, k, v[0])
    store(a, i, k + 1, v[1])
    store(a, i, k + 2, v[2])


@kernel
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """Vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@kernel
def add(a, b):
    """Sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def sub(a, b):
    """Difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scale(c, a):
    """Scalar times vector."""
    return c * a[0], c * a[1], c * a[2]


@kernel
def axpy(c, a, b):
    """c a + b."""
    return c * a[0] + b[0], c * a[1] + b[1], c * a[2] + b[2]


@kernel
def times(a, b):
    """Component by component."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@kernel
def to_global(frame, v):
    """Global components of the vector v given along the three axes of a frame (three vectors)."""
    return axpy(v[0], frame[0], axpy(v[1], frame[1], scale(v[2], frame[2])))


@kernel
def to_local(frame, v):
    """Components of v along the three axes of a frame (three vectors)."""
    return dot(frame[0], v), dot(frame[1], v), dot(frame[2], v)


@kernel
def symmetric(s, v):
    """Product of a symmetric matrix (xx, yy, zz, xy, xz, yz) and a vector."""
    return (
        s[0] * v[0] + s[3] * v[1] + s[4] * v[2],
        s[3] * v[0] + s[1] * v[1] + s[5] * v[2],
        s[4] * v[0] + s[5] * v[1] + s[2] * v[2],
    )


@kernel
def invert(s):
    """Inverse of a symmetric 3 by 3 matrix (xx, yy, zz, xy, xz, yz), by cofactors."""
    xx = s[1] * s[2] - s[5] * s[5]
    xy = s[4] * s[5] - s[3] * s[2]
    xz = s[3] * s[5] - s[4] * s[1]
    r = 1.0 / (s[0] * xx + s[3] * xy + s[4] * xz)
    return (
        r * xx,
        r * (s[0] * s[2] - s[4] * s[4]),
        r * (s[0] * s[1] - s[3] * s[3]),
        r * xy,
        r * xz,
        r * (s[3] * s[4] - s[0] * s[5]),
    )
