"""The matrix of a revolute hinge: how impulses at the hinge change the rates of its gaps.

Per hinge the unknowns are an impulse (3) at the hinge point, a moment impulse (2) normal to the
axis and, where the point is held, a support impulse (up to 3). Their matrix A = G M^-1 G^T is built
and factorised by blocks at the start of a step: first the moments, then the impulse (its Schur
complement), then the supports. hinge.py uses it. The two particles of hinge h are its bodies, rows
2h and 2h + 1 of the arrays over bodies. The work goes in passes over all bodies or hinges, each
with a short chain of operations, so that the processor works on several at once. Kernels take a
named tuple with `ends`, `bodies`, ... as hinge_kernels.py has it.
"""

from fpm.kernels.lanes import load, store
from fpm.kernels.layout import F, M, P, V, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import (
    cross,
    dot,
    get3,
    invert,
    kernel,
    put3,
    symmetric,
    times,
    to_global,
    vector,
)

# Constants of a body of a hinge; vectors in the particle's frame.
ARM = 0  # virtual beam (3)
AXIS = 3  # axis (3)
REF = 6  # reference direction (3)
HIM = 9  # inverse masses along the global axes (3)
HIJ = 12  # inverse principal inertias (3)
BODY = 15

# Constants of a hinge.
HELD = 0  # 1 where the hinge point is held along a global axis (3)
PLACE = 3  # where it is held (3)
HINGE = 6

# Scratch of a body (rows, BODY_SCRATCH, lanes).
OLD_X = 0  # position at the start of the step (3)
OLD_D2, OLD_D3 = 3, 6  # directors (3 each)
GLOBAL_ARM = 9  # arm in global components (3)
INVERSE = 12  # inverse inertia in global components (6)
RESPONSE = 18  # velocity of the hinge point per unit impulse there (6)
DV, DP = 24, 27  # change of velocity (3) and of angular momentum (3) by the hinge's impulses
BODY_SCRATCH = 30

# Scratch of a hinge (rows, HINGE_SCRATCH, lanes).
PA, QA = 0, 3  # the two directions normal to the axis
C = 6  # inverse of the 2 by 2 rotation block (pp, qq, pq)
E = 9  # that inverse times the coupling: rows p (3) and q (3)
S = 15  # inverse of the Schur complement of the translation block (6)
B1 = 21  # coupling of a force on body 1 to the rotation rows p (3) and q (3)
Y = 27  # A^-1 times the columns of the supports x, y, z: each 3 + 2
G = 42  # inverse of the supports' Schur complement (6)
MISSED = 48  # rates that `aim` has to add for what it missed before, like OFF
OFF = 56  # what is to be closed: gap (3), tilts about p and q, distance from where it is held (3)
ONE, TWO, MP = 64, 67, 70  # impulses: force on body 1, against body 2 (3 each), moments p, q on 2
HINGE_SCRATCH = 72


@kernel
def get6(a, i, k):
    """The six lanes in fields k .. k+5 of row i."""
    return (
        load(a, i, k),
        load(a, i, k + 1),
        load(a, i, k + 2),
        load(a, i, k + 3),
        load(a, i, k + 4),
        load(a, i, k + 5),
    )


@kernel
def put6(a, i, k, s):
    """Write six lanes to fields k .. k+5 of row i."""
    put3(a, i, k, vector(s[0], s[1], s[2]))
    put3(a, i, k + 3, vector(s[3], s[4], s[5]))


@kernel
def world_inverse(axes, j):
    """Inverse inertia in global components (xx, yy, zz, xy, xz, yz); j: along the three axes."""
    a, b, _ = axes
    # The dyads of the three axes add up to the unit matrix, which spares the third.
    ja, jb = (j.x - j.z) * a, (j.y - j.z) * b
    return (
        (ja.x * a.x + j.z) + jb.x * b.x,
        (ja.y * a.y + j.z) + jb.y * b.y,
        (ja.z * a.z + j.z) + jb.z * b.z,
        ja.x * a.y + jb.x * b.y,
        ja.x * a.z + jb.x * b.z,
        ja.y * a.z + jb.y * b.z,
    )


@kernel
def point_response(inverse_mass, j, r):
    """Velocity of a point at arm r per unit impulse there: M^-1 - [r] J^-1 [r] (6)."""
    xx, yy, zz, xy, xz, yz = j
    # Columns of J^-1 [r]^T, i.e. J^-1 (r x e).
    ux = vector(xy * r.z - xz * r.y, yy * r.z - yz * r.y, yz * r.z - zz * r.y)
    uy = vector(xz * r.x - xx * r.z, yz * r.x - xy * r.z, zz * r.x - xz * r.z)
    uz = vector(xx * r.y - xy * r.x, xy * r.y - yy * r.x, xz * r.y - yz * r.x)
    return (
        inverse_mass.x + (r.z * ux.y - r.y * ux.z),
        inverse_mass.y + (r.x * uy.z - r.z * uy.x),
        inverse_mass.z + (r.y * uz.x - r.x * uz.y),
        r.z * uy.y - r.y * uy.z,
        r.z * uz.y - r.y * uz.z,
        r.x * uz.z - r.z * uz.x,
    )


@kernel
def prepare_directions(state, part):
    """The two directions normal to every hinge's axis."""
    bodies, w = part.bodies, part.hinge_scratch
    for h in range(w.shape[0]):
        axes = frame(state, part.ends[2 * h])
        p = to_global(axes, get3(bodies, 2 * h, REF))
        put3(w, h, PA, p)
        put3(w, h, QA, cross(to_global(axes, get3(bodies, 2 * h, AXIS)), p))


@kernel
def prepare_bodies(state, part, kick):
    """Keep each body's state, kick it, and find its response."""
    bodies, w = part.bodies, part.body_scratch
    for r in range(part.ends.shape[0]):
        i = part.ends[r]
        x = get3(state, i, X)
        put3(w, r, OLD_X, x)
        axes = frame(state, i)
        put3(w, r, OLD_D2, axes[1])
        put3(w, r, OLD_D3, axes[2])
        arm = to_global(axes, get3(bodies, r, ARM))
        inverse_mass = get3(bodies, r, HIM)
        j = world_inverse(axes, get3(bodies, r, HIJ))
        lever = arm
        if r % 2 == 1:
            # Both impulses act at the first body's point: they make no moment if the hinge gapes.
            lever = get3(w, r - 1, OLD_X) + get3(w, r - 1, GLOBAL_ARM) - x
        put3(w, r, GLOBAL_ARM, lever)
        put6(w, r, INVERSE, j)
        put6(w, r, RESPONSE, point_response(inverse_mass, j, arm))
        v = get3(state, i, V) + kick * times(inverse_mass, get3(state, i, F))
        put3(state, i, V, v)
        put3(state, i, P, kick * get3(state, i, M) + get3(state, i, P))
        for k in range(6):
            store(state, i, F + k, 0.0)


@kernel
def prepare_matrices(part):
    """Build and factorise the matrix of every hinge."""
    b, w = part.body_scratch, part.hinge_scratch
    for h in range(w.shape[0]):
        one, two = 2 * h, 2 * h + 1
        p, q = get3(w, h, PA), get3(w, h, QA)
        j1, j2 = get6(b, one, INVERSE), get6(b, two, INVERSE)
        r1, r2 = get3(b, one, GLOBAL_ARM), get3(b, two, GLOBAL_ARM)
        p1, q1, p2, q2 = symmetric(j1, p), symmetric(j1, q), symmetric(j2, p), symmetric(j2, q)
        pp, qq, pq = dot(p, p1 + p2), dot(q, q1 + q2), dot(p, q1 + q2)
        det = 1.0 / (pp * qq - pq * pq)
        cpp, cqq, cpq = det * qq, det * pp, -det * pq
        b1p, b1q = cross(r1, p1), cross(r1, q1)
        bp, bq = b1p + cross(r2, p2), b1q + cross(r2, q2)
        ep = cpp * bp + cpq * bq
        eq = cpq * bp + cqq * bq
        put3(w, h, C, vector(cpp, cqq, cpq))
        put3(w, h, E, ep)
        put3(w, h, E + 3, eq)
        put3(w, h, B1, b1p)
        put3(w, h, B1 + 3, b1q)
        k1, k2 = get6(b, one, RESPONSE), get6(b, two, RESPONSE)
        schur = (
            (k1[0] + k2[0]) - (bp.x * ep.x + bq.x * eq.x),
            (k1[1] + k2[1]) - (bp.y * ep.y + bq.y * eq.y),
            (k1[2] + k2[2]) - (bp.z * ep.z + bq.z * eq.z),
            (k1[3] + k2[3]) - (bp.x * ep.y + bq.x * eq.y),
            (k1[4] + k2[4]) - (bp.x * ep.z + bq.x * eq.z),
            (k1[5] + k2[5]) - (bp.y * ep.z + bq.y * eq.z),
        )
        put6(w, h, S, invert(schur))


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
def find_impulses(part, factor):
    """Impulses that change what is in OFF of every open hinge, or rates of it, by `factor` times
    what it is. They go into ONE, TWO and MP, what they do to the bodies into DV and DP.
    """
    bodies, b, w, open_ = part.bodies, part.body_scratch, part.hinge_scratch, part.open
    for h in range(w.shape[0]):
        if open_[h]:
            ep, eq = factor * load(w, h, OFF + 3), factor * load(w, h, OFF + 4)
            force, mp, mq = solve(w, h, factor * get3(w, h, OFF), ep, eq)
            put3(w, h, ONE, force)
            put3(w, h, TWO, force)
            store(w, h, MP, mp)
            store(w, h, MP + 1, mq)
    if part.supported:
        held = part.held
        for h in range(w.shape[0]):
            if open_[h] and held[h, 0] + held[h, 1] + held[h, 2] > 0:
                hold_point(part, h, factor)
    for h in range(w.shape[0]):
        if open_[h]:
            one, two = 2 * h, 2 * h + 1
            on_one, against_two = get3(w, h, ONE), get3(w, h, TWO)
            mp, mq = load(w, h, MP), load(w, h, MP + 1)
            moment = mp * get3(w, h, PA) + mq * get3(w, h, QA)
            put3(b, one, DV, times(get3(bodies, one, HIM), on_one))
            put3(b, one, DP, cross(get3(b, one, GLOBAL_ARM), on_one) - moment)
            put3(b, two, DV, -1.0 * times(get3(bodies, two, HIM), against_two))
            put3(b, two, DP, moment - cross(get3(b, two, GLOBAL_ARM), against_two))


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
