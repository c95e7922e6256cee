"""Revolute hinges: impulses that close every hinge at the end of the step (elements/hinge.py).

Per hinge the unknowns are an impulse (3) at the hinge point, a moment impulse (2) normal to the
axis and, where the point is held, a support impulse (up to 3). Their matrix A = G M^-1 G^T is built
and factorised at the start of the step (`prepare`), the particles move freely, and two quasi-Newton
rounds (`close`) bring the point and the axis together at the end of the step. The matrix changes by
the angle turned in a step only, so each round gains three digits or more.
"""

from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ARM, AXIS, HELD, HIJ, HIM, PLACE, REF, D, P, Q, V, X
from fpm.kernels.rotation import get4, half_turn, put_rotation, turned
from fpm.kernels.vectors import (
    add,
    axpy,
    cross,
    dot,
    get3,
    inlined,
    invert,
    kernel,
    put3,
    scale,
    sub,
    symmetric,
    times,
    to_global,
    to_local,
)

ROUNDS = 2

# Scratch of a hinge (rows, SCRATCH, lanes).
OLD_X = 0  # positions at the start of the step (3, 3)
OLD_Q = 6  # quaternions (4, 4)
OLD_D = 14  # directors (9, 9)
ARM1, ARM2 = 32, 35  # global arms
PA, QA = 38, 41  # the two directions normal to the axis
C = 44  # inverse of the 2 by 2 rotation block (pp, qq, pq)
E = 47  # that inverse times the coupling: rows p (3) and q (3)
S = 53  # inverse of the Schur complement of the translation block (6)
K1 = 59  # response of particle 1's hinge point to a force there (6)
B1 = 65  # its coupling to the rotation rows p (3) and q (3)
Y = 71  # A^-1 times the support columns: three times (3 + 2)
G = 86  # inverse of the support's Schur complement (6)
SCRATCH = 92


@inlined
def world_inverse(state, i, j):
    """Inverse inertia of particle i in global components (xx, yy, zz, xy, xz, yz)."""
    a, b, c = get3(state, i, D), get3(state, i, D + 3), get3(state, i, D + 6)
    ja, jb, jc = scale(j[0], a), scale(j[1], b), scale(j[2], c)
    return (
        ja[0] * a[0] + jb[0] * b[0] + jc[0] * c[0],
        ja[1] * a[1] + jb[1] * b[1] + jc[1] * c[1],
        ja[2] * a[2] + jb[2] * b[2] + jc[2] * c[2],
        ja[0] * a[1] + jb[0] * b[1] + jc[0] * c[1],
        ja[0] * a[2] + jb[0] * b[2] + jc[0] * c[2],
        ja[1] * a[2] + jb[1] * b[2] + jc[1] * c[2],
    )


@inlined
def point_response(inverse_mass, j, r):
    """Velocity of a point at arm r per unit impulse there: M^-1 - [r] J^-1 [r] (6)."""
    zero = 0.0 * r[0]
    tx, ty, tz = (zero, r[2], -r[1]), (-r[2], zero, r[0]), (r[1], -r[0], zero)
    ux, uy, uz = symmetric(j, tx), symmetric(j, ty), symmetric(j, tz)
    return (
        inverse_mass[0] + dot(tx, ux),
        inverse_mass[1] + dot(ty, uy),
        inverse_mass[2] + dot(tz, uz),
        dot(tx, uy),
        dot(tx, uz),
        dot(ty, uz),
    )


@inlined
def get6(a, i, k):
    """The six lanes in fields k .. k+5 of row i."""
    x, y = get3(a, i, k), get3(a, i, k + 3)
    return x[0], x[1], x[2], y[0], y[1], y[2]


@inlined
def put6(a, i, k, s):
    """Write six lanes to fields k .. k+5 of row i."""
    put3(a, i, k, (s[0], s[1], s[2]))
    put3(a, i, k + 3, (s[3], s[4], s[5]))


@inlined
def solve(w, h, g, ep, eq):
    """Impulse (3) and moment impulses about p and q that change the gap rates by g, ep, eq."""
    cpp, cqq, cpq = get3(w, h, C)
    rp, rq = get3(w, h, E), get3(w, h, E + 3)
    yp, yq = cpp * ep + cpq * eq, cpq * ep + cqq * eq
    rhs = sub(g, axpy(ep, rp, scale(eq, rq)))
    force = symmetric(get6(w, h, S), rhs)
    return force, yp - dot(rp, force), yq - dot(rq, force)


@kernel
def prepare(state, pairs, hinges, supported, w):
    """Factorise the hinges' matrices and keep their particles' state at the start of the step.

    pairs (h, 2) particles; hinges (h, HINGE, lanes); supported (h,) whether the point is held;
    w (h, SCRATCH, lanes) scratch.
    """
    for h in range(pairs.shape[0]):
        one, two = pairs[h, 0], pairs[h, 1]
        for k in range(2):
            i = pairs[h, k]
            put3(w, h, OLD_X + 3 * k, get3(state, i, X))
            for m in range(4):
                store(w, h, OLD_Q + 4 * k + m, load(state, i, Q + m))
            for m in range(9):
                store(w, h, OLD_D + 9 * k + m, load(state, i, D + m))
        r1 = to_global(state, one, D, get3(hinges, h, ARM))
        r2 = to_global(state, two, D, get3(hinges, h, ARM + 3))
        p = to_global(state, one, D, get3(hinges, h, REF))
        q = cross(to_global(state, one, D, get3(hinges, h, AXIS)), p)
        put3(w, h, ARM1, r1)
        put3(w, h, ARM2, r2)
        put3(w, h, PA, p)
        put3(w, h, QA, q)
        j1 = world_inverse(state, one, get3(hinges, h, HIJ))
        j2 = world_inverse(state, two, get3(hinges, h, HIJ + 3))
        k1 = point_response(get3(hinges, h, HIM), j1, r1)
        k2 = point_response(get3(hinges, h, HIM + 3), j2, r2)
        p1, q1, p2, q2 = symmetric(j1, p), symmetric(j1, q), symmetric(j2, p), symmetric(j2, q)
        # Rotation block and its coupling to the translations.
        pp, qq, pq = dot(p, add(p1, p2)), dot(q, add(q1, q2)), dot(p, add(q1, q2))
        det = 1.0 / (pp * qq - pq * pq)
        cpp, cqq, cpq = det * qq, det * pp, -det * pq
        b1p, b1q = cross(r1, p1), cross(r1, q1)
        bp, bq = add(b1p, cross(r2, p2)), add(b1q, cross(r2, q2))
        ep = axpy(cpp, bp, scale(cpq, bq))
        eq = axpy(cpq, bp, scale(cqq, bq))
        put3(w, h, C, (cpp, cqq, cpq))
        put3(w, h, E, ep)
        put3(w, h, E + 3, eq)
        schur = (
            k1[0] + k2[0] - bp[0] * ep[0] - bq[0] * eq[0],
            k1[1] + k2[1] - bp[1] * ep[1] - bq[1] * eq[1],
            k1[2] + k2[2] - bp[2] * ep[2] - bq[2] * eq[2],
            k1[3] + k2[3] - bp[0] * ep[1] - bq[0] * eq[1],
            k1[4] + k2[4] - bp[0] * ep[2] - bq[0] * eq[2],
            k1[5] + k2[5] - bp[1] * ep[2] - bq[1] * eq[2],
        )
        put6(w, h, S, invert(schur))
        if supported[h]:
            support_prepare(hinges, h, w, k1, b1p, b1q)


@inlined
def support_prepare(hinges, h, w, k1, b1p, b1q):
    """Schur complement of the support impulses on particle 1's hinge point."""
    put6(w, h, K1, k1)
    put3(w, h, B1, b1p)
    put3(w, h, B1 + 3, b1q)
    xx, yy, zz, xy, xz, yz = k1
    held = get3(hinges, h, HELD)
    columns = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    f0, p0, q0 = solve(w, h, columns[0], b1p[0], b1q[0])
    f1, p1, q1 = solve(w, h, columns[1], b1p[1], b1q[1])
    f2, p2, q2 = solve(w, h, columns[2], b1p[2], b1q[2])
    put3(w, h, Y, f0)
    put3(w, h, Y + 3, f1)
    put3(w, h, Y + 6, f2)
    put6(w, h, Y + 9, (p0, q0, p1, q1, p2, q2))
    s00 = xx - dot(columns[0], f0) - b1p[0] * p0 - b1q[0] * q0
    s11 = yy - dot(columns[1], f1) - b1p[1] * p1 - b1q[1] * q1
    s22 = zz - dot(columns[2], f2) - b1p[2] * p2 - b1q[2] * q2
    s01 = xy - dot(columns[0], f1) - b1p[0] * p1 - b1q[0] * q1
    s02 = xz - dot(columns[0], f2) - b1p[0] * p2 - b1q[0] * q2
    s12 = yz - dot(columns[1], f2) - b1p[1] * p2 - b1q[1] * q2
    # Directions that are free get a unit diagonal and no coupling.
    a, b, c = held
    inverse = invert(
        (
            a * s00 + (1.0 - a),
            b * s11 + (1.0 - b),
            c * s22 + (1.0 - c),
            a * b * s01,
            a * c * s02,
            b * c * s12,
        )
    )
    put6(w, h, G, inverse)


@inlined
def gaps(state, one, two, hinges, h):
    """Hinge point of particle 1, its gap (3) to that of 2, and the axis gap about p and q (rad)."""
    arm = to_global(state, one, D, get3(hinges, h, ARM))
    point = add(get3(state, one, X), arm)
    other = add(get3(state, two, X), to_global(state, two, D, get3(hinges, h, ARM + 3)))
    p = to_global(state, one, D, get3(hinges, h, REF))
    q = cross(to_global(state, one, D, get3(hinges, h, AXIS)), p)
    axis = to_global(state, two, D, get3(hinges, h, AXIS + 3))
    return point, sub(point, other), -dot(q, axis), dot(p, axis)


@inlined
def push(state, i, w, h, k, inverse_mass, j, impulse, twist, step):
    """Apply an impulse and a moment impulse to particle k of a hinge and redo its step."""
    v = add(get3(state, i, V), times(inverse_mass, impulse))
    put3(state, i, V, v)
    put3(state, i, X, axpy(step, v, get3(w, h, OLD_X + 3 * k)))
    p = add(get3(state, i, P), twist)
    put3(state, i, P, p)
    half = half_turn(to_local(w, h, OLD_D + 9 * k, p), j, step)
    put_rotation(state, i, turned(get4(w, h, OLD_Q + 4 * k), half))


@kernel
def close(state, pairs, hinges, supported, w, step):
    """Close all hinges at the end of the step."""
    rate = -1.0 / step
    for h in range(pairs.shape[0]):
        one, two = pairs[h, 0], pairs[h, 1]
        r1, r2 = get3(w, h, ARM1), get3(w, h, ARM2)
        for _ in range(ROUNDS):
            point, gap, ep, eq = gaps(state, one, two, hinges, h)
            force, mp, mq = solve(w, h, scale(rate, gap), rate * ep, rate * eq)
            extra = scale(0.0, gap)
            if supported[h]:
                held = get3(hinges, h, HELD)
                off = scale(rate, sub(point, get3(hinges, h, PLACE)))
                reached = symmetric(get6(w, h, K1), force)
                turning = axpy(mp, get3(w, h, B1), scale(mq, get3(w, h, B1 + 3)))
                missing = times(held, sub(off, add(reached, turning)))
                extra = times(held, symmetric(get6(w, h, G), missing))
                x, y, z = extra
                less = axpy(
                    x,
                    get3(w, h, Y),
                    axpy(y, get3(w, h, Y + 3), scale(z, get3(w, h, Y + 6))),
                )
                force = sub(force, less)
                px, qx, py, qy, pz, qz = get6(w, h, Y + 9)
                mp = mp - (x * px + y * py + z * pz)
                mq = mq - (x * qx + y * qy + z * qz)
            moment = axpy(mp, get3(w, h, PA), scale(mq, get3(w, h, QA)))
            both = add(force, extra)
            him, hij = get3(hinges, h, HIM), get3(hinges, h, HIJ)
            push(state, one, w, h, 0, him, hij, both, sub(cross(r1, both), moment), step)
            him, hij = get3(hinges, h, HIM + 3), get3(hinges, h, HIJ + 3)
            back = scale(-1.0, force)
            push(state, two, w, h, 1, him, hij, back, add(cross(r2, back), moment), step)
