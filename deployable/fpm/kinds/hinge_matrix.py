"""The matrix of a revolute hinge: how impulses at the hinge change the rates of its gaps.

Per hinge the unknowns are an impulse (3) at the hinge point, a moment impulse (2) normal to the
axis and, where the point is held, a support impulse (up to 3). Their matrix A = G M^-1 G^T is built
and factorised by blocks at the start of a step: first the moments, then the impulse (its Schur
complement), then the supports. hinge.py uses it. The two particles of hinge h are its bodies, rows
2h and 2h + 1 of the arrays over bodies. The work goes in passes over all bodies or hinges, each
with a short chain of operations, so that the processor works on several at once. Kernels take a
named tuple with `ends`, `bodies`, ... as hinge_kernels.py has it.
"""

from deployable.fpm.kernels.lanes import load, store
from deployable.fpm.kernels.layout import F, M, P, V, X
from deployable.fpm.kernels.rotation import frame
from deployable.fpm.kernels.vectors import (
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
from deployable.fpm.kinds.hinge_arrays import (
    ARM,
    AXIS,
    B1,
    DP,
    DV,
    GLOBAL_ARM,
    HIJ,
    HIM,
    INVERSE,
    MP,
    OFF,
    OLD_D2,
    OLD_D3,
    OLD_X,
    ONE,
    PA,
    QA,
    REF,
    RESPONSE,
    TWO,
    C,
    E,
    S,
    get6,
    put6,
)
from deployable.fpm.kinds.hinge_supports import hold_point, solve


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
