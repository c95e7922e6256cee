"""Rotation of rigid particles on SO(3): no drift, no trigonometric functions.

Theory: docs/mechanics.md, "Particles and the step" (implicit midpoint rule for the free rigid body:
Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.5). What the one round leaves is of
third order in the angle turned in a step, like the error of the step itself. Turns beyond
MOST_BY_SERIES, up to several whole ones in a step, take more terms."""

import math

from fpm.kernels.lanes import absolute, any_negative, floor, sqrt, where_negative
from fpm.kernels.layout import D2, D3
from fpm.kernels.vectors import cross, dot, get3, kernel, put3, vector

MOST_BY_SERIES = 0.2
"""Half the angle (rad) of a turn up to which the short series are exact to 2e-9."""


@kernel
def frame(state, i):
    """Return the three axes of particle i, vectors of lanes, global."""
    second, third = get3(state, i, D2), get3(state, i, D3)
    return cross(second, third), second, third


@kernel
def half_turn(body, rate):
    """Return half the rotation vector (rad) of a step, 0.5 step J^-1 p with p at its middle: body +
    body x (rate body). body: p (N m s) at its start; rate: 0.5 step J^-1; along the axes."""
    x, y, z = body.x, body.y, body.z
    a, b, c = rate.x, rate.y, rate.z
    first, second = a * (x + (c - b) * (y * z)), b * (y + (a - c) * (z * x))
    return vector(first, second, c * (z + (b - a) * (x * y)))


@kernel
def turn_frame(state, i, axes, half):
    """Turn the `axes` of particle i by twice `half` (rad, along these), and store them."""
    x, y, z = half.x, half.y, half.z
    xx, yy, zz = x * x, y * y, z * z
    t = (xx + yy) + zz
    # With a the length of half: sin(2a)/a and (1 - cos(2a))/a², to t³.
    sine = 2.0 - t * (4.0 / 3.0 - t * (4.0 / 15.0 - t * (8.0 / 315.0)))
    cosine = 2.0 - t * (2.0 / 3.0 - t * (4.0 / 45.0 - t * (2.0 / 315.0)))
    short = MOST_BY_SERIES**2 - t
    if any_negative(short):  # less whole turns, 2a is at most pi
        share = 1.0 - math.pi * floor(sqrt(t) * (1.0 / math.pi) + 0.5) / sqrt(t)
        s, c, square = 0.0 * t + 1.0, 0.0 * t + 1.0, 4.0 * t * share * share
        for k in range(24, 0, -2):
            s = 1.0 - square * s / (k * (k + 1.0))
            c = 1.0 - square * c / ((k + 1.0) * (k + 2.0))
        sine = where_negative(short, 2.0 * share * s, sine)
        cosine = where_negative(short, 2.0 * share * share * c, cosine)
    xy, xz, yz = cosine * (x * y), cosine * (x * z), cosine * (y * z)
    sx, sy, sz = sine * x, sine * y, sine * z
    a, b, c = axes
    put3(state, i, D2, (xy - sz) * a + ((1.0 - cosine * (xx + zz)) * b + (yz + sx) * c))
    put3(state, i, D3, (xz + sy) * a + ((yz - sx) * b + (1.0 - cosine * (xx + yy)) * c))


@kernel
def normalise(state):
    """Bring the axes of all particles back to length one and right angles by a Newton step:
    rounding, and turns by tenths of a radian in a step, change them."""
    for i in range(state.shape[0]):
        b, c = get3(state, i, D2), get3(state, i, D3)
        skew = -0.5 * dot(b, c)
        put3(state, i, D2, skew * c + (1.5 - 0.5 * dot(b, b)) * b)
        put3(state, i, D3, skew * b + (1.5 - 0.5 * dot(c, c)) * c)


HALF_PI = math.pi / 2
QUARTER_PI = math.pi / 4


@kernel
def arctan(x):
    """Return the arc tangent (rad) of lanes x in [0, 1], to 2e-16; rational form (Moshier 1989)."""
    high = where_negative(0.66 - x, 1.0, 0.0 * x)
    x = where_negative(0.66 - x, (x - 1.0) / (x + 1.0), x)
    z = x * x
    p = -8.750608600031904122785e-1 * z - 1.615753718733365076637e1
    p = p * z - 7.500855792314704667340e1
    p = p * z - 1.228866684490136173410e2
    p = p * z - 6.485021904942025371773e1
    q = z + 2.485846490142306297962e1
    q = q * z + 1.650270098316988542046e2
    q = q * z + 4.328810604912902668951e2
    q = q * z + 4.853903996359136964868e2
    q = q * z + 1.945506571482613964425e2
    return QUARTER_PI * high + (x + x * z * (p / q))


@kernel
def arctan2(s, c):
    """Return the angle (rad, lanes) in (-pi, pi] of sine and cosine in the ratio s : c (lanes)."""
    a, b = absolute(s), absolute(c)
    steep = b - a  # negative beyond 45 degrees
    t = where_negative(steep, b, a) / where_negative(steep, a, b)
    angle = arctan(t)
    angle = where_negative(steep, HALF_PI - angle, angle)
    angle = where_negative(c, math.pi - angle, angle)
    return where_negative(s, -angle, angle)
