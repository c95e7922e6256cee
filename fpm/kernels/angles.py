"""Inverse trigonometric functions of lanes."""

import math

from fpm.kernels.lanes import absolute, where_negative
from fpm.kernels.vectors import kernel

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
