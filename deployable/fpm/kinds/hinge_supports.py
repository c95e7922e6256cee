"""Impulses that hold a hinge point along global axes, beside those that close the hinge."""

from deployable.fpm.kernels.lanes import load, store
from deployable.fpm.kernels.vectors import dot, get3, invert, kernel, put3, symmetric, times, vector
from deployable.fpm.kinds.hinge_arrays import (
    B1,
    HELD,
    MP,
    OFF,
    ONE,
    RESPONSE,
    TWO,
    C,
    E,
    G,
    S,
    Y,
    get6,
    put6,
)


@kernel
def solve(w, h, g, ep, eq):
    """Impulse (3) and moment impulses about p and q that change the gap rates by g, ep, eq."""
    cpp, cqq, cpq = load(w, h, C), load(w, h, C + 1), load(w, h, C + 2)
    rp, rq = get3(w, h, E), get3(w, h, E + 3)
    yp, yq = cpp * ep + cpq * eq, cpq * ep + cqq * eq
    rhs = g - (ep * rp + eq * rq)
    force = symmetric(get6(w, h, S), rhs)
    return force, yp - dot(rp, force), yq - dot(rq, force)


@kernel
def column(k1, b1, axis):
    """Effect of a unit impulse along a global axis on body 1's hinge point: point (3), p, q."""
    xx, yy, zz, xy, xz, yz = k1
    if axis == 0:
        point = vector(xx, xy, xz)
    elif axis == 1:
        point = vector(xy, yy, yz)
    else:
        point = vector(xz, yz, zz)
    return point, b1[axis], b1[axis + 3]


@kernel
def prepare_supports(part):
    """Schur complement of the support impulses."""
    held, b, w = part.held, part.body_scratch, part.hinge_scratch
    for h in range(w.shape[0]):
        if held[h, 0] + held[h, 1] + held[h, 2] == 0:
            continue
        k1, b1 = get6(b, 2 * h, RESPONSE), get6(w, h, B1)
        for axis in range(3):
            if held[h, axis]:
                point, p, q = column(k1, b1, axis)
                force, mp, mq = solve(w, h, point, p, q)
                put3(w, h, Y + 5 * axis, force)
                store(w, h, Y + 5 * axis + 3, mp)
                store(w, h, Y + 5 * axis + 4, mq)
        # Directions that are free get a unit diagonal and no coupling (their Y is zero).
        free = get3(part.hinges, h, HELD)
        x, y, z = free.x, free.y, free.z
        c0, p0, q0 = column(k1, b1, 0)
        c1, p1, q1 = column(k1, b1, 1)
        c2, p2, q2 = column(k1, b1, 2)
        y0, y1, y2 = get3(w, h, Y), get3(w, h, Y + 5), get3(w, h, Y + 10)
        m0, n0 = load(w, h, Y + 3), load(w, h, Y + 4)
        m1, n1 = load(w, h, Y + 8), load(w, h, Y + 9)
        m2, n2 = load(w, h, Y + 13), load(w, h, Y + 14)
        s00 = c0.x - dot(c0, y0) - (p0 * m0 + q0 * n0)
        s11 = c1.y - dot(c1, y1) - (p1 * m1 + q1 * n1)
        s22 = c2.z - dot(c2, y2) - (p2 * m2 + q2 * n2)
        s01 = c0.y - dot(c0, y1) - (p0 * m1 + q0 * n1)
        s02 = c0.z - dot(c0, y2) - (p0 * m2 + q0 * n2)
        s12 = c1.z - dot(c1, y2) - (p1 * m2 + q1 * n2)
        inverse = invert(
            (
                x * s00 + (1.0 - x),
                y * s11 + (1.0 - y),
                z * s22 + (1.0 - z),
                x * y * s01,
                x * z * s02,
                y * z * s12,
            )
        )
        put6(w, h, G, inverse)


@kernel
def hold_point(part, h, factor):
    """Add the support impulses of hinge h to the impulses that close it."""
    b, w = part.body_scratch, part.hinge_scratch
    force, mp, mq = get3(w, h, ONE), load(w, h, MP), load(w, h, MP + 1)
    reached = symmetric(get6(b, 2 * h, RESPONSE), force)
    turning = mp * get3(w, h, B1) + mq * get3(w, h, B1 + 3)
    free = get3(part.hinges, h, HELD)
    missing = times(free, factor * get3(w, h, OFF + 5) - (reached + turning))
    held = times(free, symmetric(get6(w, h, G), missing))
    x, y, z = held.x, held.y, held.z
    less = x * get3(w, h, Y) + (y * get3(w, h, Y + 5) + z * get3(w, h, Y + 10))
    force = force - less
    put3(w, h, TWO, force)
    put3(w, h, ONE, force + held)
    store(w, h, MP, mp - (x * load(w, h, Y + 3) + y * load(w, h, Y + 8) + z * load(w, h, Y + 13)))
    less = x * load(w, h, Y + 4) + y * load(w, h, Y + 9) + z * load(w, h, Y + 14)
    store(w, h, MP + 1, mq - less)
