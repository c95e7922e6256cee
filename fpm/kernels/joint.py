"""Openings of hinges, and the moments and energies of torsion springs and contact on them."""

import math

from fpm.kernels.lanes import absolute, floor, load, store, where_negative
from fpm.kernels.layout import AXIS, REF, M
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import axpy, cross, dot, get3, kernel, put3, to_global

HALF_PI = math.pi / 2
QUARTER_PI = math.pi / 4
TURN = 2 * math.pi


@kernel
def arctan(x):
    """Arc tangent of lanes in [0, 1], to 2e-16; rational form of Cephes (Moshier 1989)."""
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
    """Angle in (-pi, pi] with sine and cosine in the ratio s : c, without a branch."""
    a, b = absolute(s), absolute(c)
    steep = b - a  # negative beyond 45 degrees
    t = where_negative(steep, b, a) / where_negative(steep, a, b)
    angle = arctan(t)
    angle = where_negative(steep, HALF_PI - angle, angle)
    angle = where_negative(c, math.pi - angle, angle)
    return where_negative(s, -angle, angle)


@kernel
def update_openings(state, ends, bodies, openings):
    """New openings (h, 2, lanes): field 0 now (rad), field 1 at the call before.

    The angle is a function of the configuration; the last value only picks the turn.
    """
    for h in range(openings.shape[0]):
        one, two = ends[2 * h], ends[2 * h + 1]
        axes = frame(state, one)
        axis = to_global(axes, get3(bodies, 2 * h, AXIS))
        first = to_global(axes, get3(bodies, 2 * h, REF))
        second = to_global(frame(state, two), get3(bodies, 2 * h + 1, REF))
        angle = arctan2(dot(axis, cross(first, second)), dot(first, second))
        last = load(openings, h, 0)
        store(openings, h, 1, last)
        turns = floor((last - angle) * (1.0 / TURN) + 0.5)
        store(openings, h, 0, angle + TURN * turns)


@kernel
def turn_hinge(state, ends, bodies, h, moment):
    """Add a moment about the axis of hinge h to its second particle, its opposite to the first."""
    one, two = ends[2 * h], ends[2 * h + 1]
    axis = to_global(frame(state, one), get3(bodies, 2 * h, AXIS))
    put3(state, two, M, axpy(moment, axis, get3(state, two, M)))
    put3(state, one, M, axpy(-1.0 * moment, axis, get3(state, one, M)))


@kernel
def spring_forces(state, ends, bodies, openings, on, springs):
    """Torsion springs; on (n,) hinge indices, springs (n, 2, lanes): stiffness and rest."""
    for i in range(on.shape[0]):
        h = on[i]
        moment = load(springs, i, 0) * (load(springs, i, 1) - load(openings, h, 0))
        turn_hinge(state, ends, bodies, h, moment)


@kernel
def contact_forces(state, ends, bodies, openings, on, contacts):
    """Face-to-face contacts; on (n,) hinge indices, contacts (n, 1, lanes): stiffness."""
    for i in range(on.shape[0]):
        h = on[i]
        psi = load(openings, h, 0)
        overlap = where_negative(psi, -psi, 0.0 * psi)
        turn_hinge(state, ends, bodies, h, load(contacts, i, 0) * overlap)


@kernel
def spring_energy(openings, on, springs, i):
    """Energy of torsion spring i (J)."""
    off = load(openings, on[i], 0) - load(springs, i, 1)
    return 0.5 * load(springs, i, 0) * off * off


@kernel
def contact_energy(openings, on, contacts, i):
    """Energy of contact i (J)."""
    psi = load(openings, on[i], 0)
    overlap = where_negative(psi, psi, 0.0 * psi)
    return 0.5 * load(contacts, i, 0) * overlap * overlap
