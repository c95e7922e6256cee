"""Rotation of rigid particles on SO(3): no drift, no trigonometric functions.

The spatial angular momentum p is the variable; it changes only through moments, so it is kept to
rounding. Over a step the particle turns with the body rates of the midpoint, W = J^-1 R_mid^T p,
found by one fixed-point round from the start of the step (isotropic particles: exact at once; the
gyroscopic term of the others is the change of R_mid^T p). What the round leaves is of third order
in the angle turned in a step, like the error of the step itself. The turn is applied as a
quaternion by its sine and cosine series. Sources: implicit midpoint rule for the free rigid body,
e.g. Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.5; quaternions: Altmann 1986.
"""

from fpm.kernels.lanes import load, store
from fpm.kernels.layout import D, Q
from fpm.kernels.vectors import add, cross, dot, kernel, put3, scale, times


@kernel
def half_turn(body, inverse_inertia, step):
    """Half the rotation vector of a step, in body axes: 0.5 step J^-1 p at the midpoint.

    body: angular momentum in the axes of the start of the step.
    """
    rate = scale(0.5 * step, inverse_inertia)
    turn = times(rate, body)
    return times(rate, add(body, cross(body, turn)))


@kernel
def turned(q, half):
    """Quaternion q (4 lanes) after the body-fixed turn with half the rotation vector `half`."""
    t = dot(half, half)
    cosine = (1.0 - 0.5 * t) + (t * t) * (1.0 / 24.0 - t * (1.0 / 720.0))
    x, y, z = scale(1.0 + t * (-1.0 / 6.0 + t * (1.0 / 120.0)), half)
    # Sums of two products each: shorter chains than sums of four.
    a = (q[0] * cosine - q[1] * x) - (q[2] * y + q[3] * z)
    b = (q[0] * x + q[1] * cosine) + (q[2] * z - q[3] * y)
    c = (q[0] * y - q[1] * z) + (q[2] * cosine + q[3] * x)
    d = (q[0] * z + q[1] * y) - (q[2] * x - q[3] * cosine)
    return a, b, c, d


@kernel
def normalise(state):
    """Bring all quaternions back to length one by a Newton step.

    They lose it by rounding only, so the time loop calls this now and then.
    """
    for i in range(state.shape[0]):
        a, b, c, d = get4(state, i, Q)
        length = 1.5 - 0.5 * ((a * a + b * b) + (c * c + d * d))
        put_rotation(state, i, (a * length, b * length, c * length, d * length))


@kernel
def get4(a, i, k):
    """The four lanes in fields k .. k+3 of row i."""
    return load(a, i, k), load(a, i, k + 1), load(a, i, k + 2), load(a, i, k + 3)


@kernel
def put_rotation(state, i, q):
    """Store the quaternion of particle i and the directors that follow from it."""
    w, x, y, z = q
    store(state, i, Q, w)
    store(state, i, Q + 1, x)
    store(state, i, Q + 2, y)
    store(state, i, Q + 3, z)
    x2, y2, z2 = x + x, y + y, z + z
    xx, xy, xz, yy, yz, zz = x * x2, x * y2, x * z2, y * y2, y * z2, z * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    put3(state, i, D, (1.0 - (yy + zz), xy + wz, xz - wy))
    put3(state, i, D + 3, (xy - wz, 1.0 - (xx + zz), yz + wx))
    put3(state, i, D + 6, (xz + wy, yz - wx, 1.0 - (xx + yy)))
