"""Impulses that hold a hinge point along global axes, beside those that close the hinge."""

from fpm.elements.joints.hinge_arrays import (
    ASKED,
    HOLD,
    MP,
    ONE,
    PA,
    QA,
    RESPONSE,
    SPINS,
    TILTS,
    TWO,
    C,
    E,
    G,
    S,
    Y,
    get6,
    put6,
)
from fpm.kernels.lanes import load, store
from fpm.kernels.vectors import dot, get3, invert, kernel, put3, symmetric, vector


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
def is_held(part, h):
    """Whether the point of hinge h is held along any axis."""
    held = part.held
    return held[h, 0] + held[h, 1] + held[h, 2] > 0


@kernel
def entry(i, k):
    """Where element i, k of a symmetric matrix (xx, yy, zz, xy, xz, yz) stands."""
    return i if i == k else 2 + i + k


@kernel
def response(b, h, axis):
    """Velocity of the point of hinge h on body 1 by a unit impulse there along a global axis."""
    x, y, z = entry(axis, 0), entry(axis, 1), entry(axis, 2)
    one, k = 2 * h, RESPONSE
    return vector(load(b, one, k + x), load(b, one, k + y), load(b, one, k + z))


@kernel
def moved(part, h, axis, force, mp, mq):
    """Velocity along an axis of the held point of hinge h by impulses at the hinge: those of a
    force on body 1, and by symmetry what a support along that axis does to the tilts.
    """
    w = part.hinge_scratch
    p, q = load(w, h, TILTS + 2 * axis), load(w, h, TILTS + 2 * axis + 1)
    return dot(response(part.body_scratch, h, axis), force) + (p * mp + q * mq)


@kernel
def prepare_supports(part):
    """Schur complement of the support impulses."""
    held, b, w = part.held, part.body_scratch, part.hinge_scratch
    for h in range(w.shape[0]):
        if not is_held(part, h):
            continue
        for k in range(6):  # axes that are free have a unit diagonal and no coupling
            store(w, h, G + k, 1.0 if k < 3 else 0.0)
        for axis in range(3):
            if held[h, axis]:
                spin = get3(b, 2 * h, SPINS + 3 * axis)
                p, q = -dot(get3(w, h, PA), spin), -dot(get3(w, h, QA), spin)
                store(w, h, TILTS + 2 * axis, p)
                store(w, h, TILTS + 2 * axis + 1, q)
                force, mp, mq = solve(w, h, response(b, h, axis), p, q)
                put3(w, h, Y + 5 * axis, force)
                store(w, h, Y + 5 * axis + 3, mp)
                store(w, h, Y + 5 * axis + 4, mq)
                for other in range(axis + 1):
                    if held[h, other]:
                        k = entry(axis, other)
                        less = moved(part, h, other, force, mp, mq)
                        store(w, h, G + k, load(b, 2 * h, RESPONSE + k) - less)
        put6(w, h, G, invert(get6(w, h, G)))


@kernel
def hold_point(part, h):
    """Add the support impulses of hinge h to the impulses that close it."""
    held, w = part.held, part.hinge_scratch
    force, mp, mq = get3(w, h, ONE), load(w, h, MP), load(w, h, MP + 1)
    for axis in range(3):
        if held[h, axis]:
            reached = moved(part, h, axis, force, mp, mq)
            store(w, h, HOLD + axis, load(w, h, ASKED + 5 + axis) - reached)
    put3(w, h, HOLD, symmetric(get6(w, h, G), get3(w, h, HOLD)))
    for axis in range(3):
        if held[h, axis]:
            impulse = load(w, h, HOLD + axis)
            force = force - impulse * get3(w, h, Y + 5 * axis)
            mp = mp - impulse * load(w, h, Y + 5 * axis + 3)
            mq = mq - impulse * load(w, h, Y + 5 * axis + 4)
    put3(w, h, TWO, force)
    put3(w, h, ONE, force + get3(w, h, HOLD))
    store(w, h, MP, mp)
    store(w, h, MP + 1, mq)
