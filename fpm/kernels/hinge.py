"""Revolute hinges: impulses that close every hinge at the end of the step (elements/hinge.py).

Per hinge the unknowns are an impulse (3) at the hinge point, a moment impulse (2) normal to the
axis and, where the point is held, a support impulse (up to 3). Their matrix A = G M^-1 G^T is built
and factorised at the start of the step, with first impulses from a second order Taylor series of
the motion (`prepare`). Once the particles have moved, quasi-Newton rounds (`close`) bring the point
and the axis together. The matrix changes by the angle turned in a step only, so each round gains
three digits or more. A sample whose gaps are small enough is left alone in the rounds that other
samples need: its numbers do not depend on theirs.
"""

from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.layout import ARM, AXIS, HELD, HIJ, HIM, PLACE, REF, D, F, M, P, Q, V, X
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

ROUNDS = 4
"""Most rounds in a step; a fast impact takes two, smooth motion one."""

GAP2 = 2e-11**2
"""Square of the gap (m) of the hinge point above which a sample gets another round."""

TILT2 = 2e-10**2
"""The same for the angle between the axes (rad)."""

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
G = 86  # inverse of the support's Schur complement (6); SCRATCH fields in all, see layout.py


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
def impulses(w, h, hinges, held_point, point, gap, ep, eq, rate):
    """Impulses that close the gaps: force on particle 1 and on 2 (3 each), moment on 2 (3).

    point, gap (3), ep, eq: as from `gaps`; rate: minus one over the time they have to act.
    """
    force, mp, mq = solve(w, h, scale(rate, gap), rate * ep, rate * eq)
    on_one = force
    if held_point:
        off = scale(rate, sub(point, get3(hinges, h, PLACE)))
        reached = symmetric(get6(w, h, K1), force)
        turning = axpy(mp, get3(w, h, B1), scale(mq, get3(w, h, B1 + 3)))
        held = get3(hinges, h, HELD)
        missing = times(held, sub(off, add(reached, turning)))
        x, y, z = times(held, symmetric(get6(w, h, G), missing))
        less = axpy(x, get3(w, h, Y), axpy(y, get3(w, h, Y + 3), scale(z, get3(w, h, Y + 6))))
        force = sub(force, less)
        px, qx, py, qy, pz, qz = get6(w, h, Y + 9)
        mp = mp - (x * px + y * py + z * pz)
        mq = mq - (x * qx + y * qy + z * qz)
        on_one = (force[0] + x, force[1] + y, force[2] + z)
    moment = axpy(mp, get3(w, h, PA), scale(mq, get3(w, h, QA)))
    return on_one, scale(-1.0, force), moment


@inlined
def add_impulse(state, i, inverse_mass, arm, impulse, moment):
    """Change the momenta of particle i by an impulse at `arm` and a moment impulse."""
    put3(state, i, V, add(get3(state, i, V), times(inverse_mass, impulse)))
    put3(state, i, P, add(get3(state, i, P), add(cross(arm, impulse), moment)))


@inlined
def kicked(state, i, inverse_mass, kick):
    """Velocity and angular momentum of particle i after its kick, which uses up its forces."""
    v = add(get3(state, i, V), scale(kick, times(inverse_mass, get3(state, i, F))))
    p = axpy(kick, get3(state, i, M), get3(state, i, P))
    for k in range(6):
        store(state, i, F + k, 0.0)
    return v, p


@inlined
def midpoint_spin(j, p, step):
    """Spin at the middle of the coming step, to second order; j: inverse inertia (6)."""
    spin = symmetric(j, p)
    return axpy(0.5 * step, symmetric(j, cross(p, spin)), spin)


@inlined
def swung(spin, arm, step):
    """Change of an arm over a step, to second order."""
    first = scale(step, cross(spin, arm))
    return axpy(0.5 * step, cross(spin, first), first)


@inlined
def predict(state, h, one, two, hinges, held_point, w, j1, j2, kick, step):
    """Kick both particles, with first impulses from the motion that they would make freely."""
    him1, him2 = get3(hinges, h, HIM), get3(hinges, h, HIM + 3)
    r1, r2, p, q = get3(w, h, ARM1), get3(w, h, ARM2), get3(w, h, PA), get3(w, h, QA)
    v1, p1 = kicked(state, one, him1, kick)
    v2, p2 = kicked(state, two, him2, kick)
    spin1, spin2 = midpoint_spin(j1, p1, step), midpoint_spin(j2, p2, step)
    point = add(axpy(step, v1, add(get3(state, one, X), r1)), swung(spin1, r1, step))
    other = add(axpy(step, v2, add(get3(state, two, X), r2)), swung(spin2, r2, step))
    axis = to_global(state, two, D, get3(hinges, h, AXIS + 3))
    axis = add(axis, swung(spin2, axis, step))
    ep = -dot(add(q, swung(spin1, q, step)), axis)
    eq = dot(add(p, swung(spin1, p, step)), axis)
    on_one, on_two, moment = impulses(
        w, h, hinges, held_point, point, sub(point, other), ep, eq, -1.0 / step
    )
    put3(state, one, V, add(v1, times(him1, on_one)))
    put3(state, two, V, add(v2, times(him2, on_two)))
    put3(state, one, P, add(p1, sub(cross(r1, on_one), moment)))
    put3(state, two, P, add(p2, add(cross(r2, on_two), moment)))


@inlined
def move_from_start(state, i, w, h, k, j, step):
    """Move particle k of a hinge from the start of the step, with its present momenta."""
    put3(state, i, X, axpy(step, get3(state, i, V), get3(w, h, OLD_X + 3 * k)))
    half = half_turn(to_local(w, h, OLD_D + 9 * k, get3(state, i, P)), j, step)
    put_rotation(state, i, turned(get4(w, h, OLD_Q + 4 * k), half))


@kernel
def prepare(state, pairs, hinges, supported, w, kick, step):
    """Factorise the hinges' matrices, keep their particles' state, and kick them for `kick` s.

    All forces must be summed; they are used up. The coming move takes `step` s.

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
        predict(state, h, one, two, hinges, supported[h], w, j1, j2, kick, step)


@kernel
def close(state, pairs, hinges, supported, w, step):
    """Move the particles of all hinges by a step, and close the hinges at its end."""
    for h in range(pairs.shape[0]):
        one, two = pairs[h, 0], pairs[h, 1]
        for _ in range(ROUNDS):
            move_from_start(state, one, w, h, 0, get3(hinges, h, HIJ), step)
            move_from_start(state, two, w, h, 1, get3(hinges, h, HIJ + 3), step)
            point, gap, ep, eq = gaps(state, one, two, hinges, h)
            good = (GAP2 - dot(gap, gap)) / GAP2
            tilt = (TILT2 - (ep * ep + eq * eq)) / TILT2
            good = where_negative(tilt, tilt, good)
            if not any_negative(good):
                break
            on_one, on_two, moment = impulses(
                w, h, hinges, supported[h], point, gap, ep, eq, -1.0 / step
            )
            wanted = where_negative(good, 1.0, 0.0 * good)
            on_one, on_two = scale(wanted, on_one), scale(wanted, on_two)
            moment = scale(wanted, moment)
            him1, him2 = get3(hinges, h, HIM), get3(hinges, h, HIM + 3)
            add_impulse(state, one, him1, get3(w, h, ARM1), on_one, scale(-1.0, moment))
            add_impulse(state, two, him2, get3(w, h, ARM2), on_two, moment)
