"""The matrix of a revolute hinge: how impulses at the hinge change the rates of its gaps.

Per hinge the unknowns are an impulse (3) at the hinge point, a moment impulse (2) normal to the
axis and, where the point is held, a support impulse (up to 3). Their matrix A = G M^-1 G^T is built
and factorised by blocks at the start of a step: first the moments, then the impulse (its Schur
complement), then the supports. hinge.py uses it. The two particles of hinge h are its bodies, rows
2h and 2h + 1 of the arrays over bodies. The work goes in passes over all bodies or hinges, each
with a short chain of operations, so that the processor works on several at once. Kernels take a
named tuple with `ends`, `bodies`, ... as hinge_kernels.py has it."""

from fpm.elements.joints import hinge_arrays as hinge
from fpm.elements.joints.closure import save_pose
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, KICK, F, M, P, V, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import (
    cross,
    dot,
    get3,
    get6,
    invert,
    kernel,
    opposite,
    put3,
    put6,
    symmetric,
    times,
    to_global,
    to_local,
    vector,
)


@kernel
def solve(w, h, g, ep, eq):
    """Return an impulse (3, N s) and two moment impulses about p and q (N m s) that change the gap
    rate of hinge h by g (3, m/s) and its tilt rates by ep, eq (rad/s). w: part.hinge_scratch."""
    cpp, cqq, cpq = load(w, h, hinge.C), load(w, h, hinge.C + 1), load(w, h, hinge.C + 2)
    rp, rq = get3(w, h, hinge.E), get3(w, h, hinge.E + 3)
    yp, yq = cpp * ep + cpq * eq, cpq * ep + cqq * eq
    rhs = g - (ep * rp + eq * rq)
    force = symmetric(get6(w, h, hinge.S), rhs)
    return force, yp - dot(rp, force), yq - dot(rq, force)


@kernel
def is_held(part, h):
    """Return whether the point of hinge h is held along any axis. part: all hinges (Hinges)."""
    axes = part.fixed_axes
    return axes[h, 0] + axes[h, 1] + axes[h, 2] > 0


@kernel
def entry(i, k):
    """Return the index of element i, k (0 to 2) of a symmetric matrix (xx, yy, zz, xy, xz, yz)."""
    return i if i == k else 2 + i + k


@kernel
def response(b, h, axis):
    """Return the velocity (3, m/s per N s) of the point of hinge h on body 1 by a unit impulse
    there along the global `axis` (0, 1, 2: x, y, z). b: working memory of bodies (body_scratch)."""
    x, y, z = entry(axis, 0), entry(axis, 1), entry(axis, 2)
    row, k = 2 * h, hinge.RESPONSE
    return vector(load(b, row, k + x), load(b, row, k + y), load(b, row, k + z))


@kernel
def speed_of(part, h, axis, force, mp, mq):
    """Return the velocity (m/s) along a global `axis` of the point of hinge h on body 1 by an
    impulse `force` (N s) on body 1 and moment impulses mp, mq (N m s) on body 2 about p and q. By
    symmetry a unit of mp or mq gives also the rate of that tilt by a unit support impulse there."""
    w = part.hinge_scratch
    p, q = load(w, h, hinge.TILTS + 2 * axis), load(w, h, hinge.TILTS + 2 * axis + 1)
    return dot(response(part.body_scratch, h, axis), force) + (p * mp + q * mq)


@kernel
def prepare_supports(part):
    """Build and invert the matrix (a Schur complement) of the impulses that hold hinge points."""
    axes, b, w = part.fixed_axes, part.body_scratch, part.hinge_scratch
    for h in range(w.shape[0]):
        if not is_held(part, h):
            continue
        for k in range(6):  # axes that are free have a unit diagonal and no coupling
            store(w, h, hinge.G + k, 1.0 if k < 3 else 0.0)
        for axis in range(3):
            if axes[h, axis]:
                spin = get3(b, 2 * h, hinge.SPINS + 3 * axis)
                p, q = -dot(get3(w, h, hinge.PA), spin), -dot(get3(w, h, hinge.QA), spin)
                store(w, h, hinge.TILTS + 2 * axis, p)
                store(w, h, hinge.TILTS + 2 * axis + 1, q)
                force, mp, mq = solve(w, h, response(b, h, axis), p, q)
                put3(w, h, hinge.Y + 5 * axis, force)
                store(w, h, hinge.Y + 5 * axis + 3, mp)
                store(w, h, hinge.Y + 5 * axis + 4, mq)
                for axis2 in range(axis + 1):
                    if axes[h, axis2]:
                        k = entry(axis, axis2)
                        change = speed_of(part, h, axis2, force, mp, mq)
                        store(w, h, hinge.G + k, load(b, 2 * h, hinge.RESPONSE + k) - change)
        put6(w, h, hinge.G, invert(get6(w, h, hinge.G)))


@kernel
def hold_point(part, h):
    """Add the impulses that hold the point of hinge h, and correct those that close it."""
    axes, w = part.fixed_axes, part.hinge_scratch
    force, mp, mq = get3(w, h, hinge.FORCE1), load(w, h, hinge.MP), load(w, h, hinge.MP + 1)
    for axis in range(3):
        if axes[h, axis]:
            speed = speed_of(part, h, axis, force, mp, mq)
            store(w, h, hinge.HOLD + axis, load(w, h, hinge.GOAL + 5 + axis) - speed)
    put3(w, h, hinge.HOLD, symmetric(get6(w, h, hinge.G), get3(w, h, hinge.HOLD)))
    for axis in range(3):
        if axes[h, axis]:
            impulse = load(w, h, hinge.HOLD + axis)
            force = force - impulse * get3(w, h, hinge.Y + 5 * axis)
            mp = mp - impulse * load(w, h, hinge.Y + 5 * axis + 3)
            mq = mq - impulse * load(w, h, hinge.Y + 5 * axis + 4)
    put3(w, h, hinge.FORCE2, force)
    put3(w, h, hinge.FORCE1, force + get3(w, h, hinge.HOLD))
    store(w, h, hinge.MP, mp)
    store(w, h, hinge.MP + 1, mq)


@kernel
def world_inverse(axes, j):
    """Return the inverse inertia of a body in global components (xx, yy, zz, xy, xz, yz), 1/(kg
    m²). axes: its three principal axes, global; j: inverse inertias about them (3)."""
    a, b, _ = axes
    # The dyads of the three axes sum to the unit matrix, so that two of them suffice.
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
def spins(j, r):
    """Return J^-1 (r x e), a body's angular velocities (three vectors, rad/s) by unit impulses
    along global axes e at a point. r (m, 3): arm to it; j: J^-1 (xx, yy, zz, xy, xz, yz)."""
    xx, yy, zz, xy, xz, yz = j
    return (
        vector(xy * r.z - xz * r.y, yy * r.z - yz * r.y, yz * r.z - zz * r.y),
        vector(xz * r.x - xx * r.z, yz * r.x - xy * r.z, zz * r.x - xz * r.z),
        vector(xx * r.y - xy * r.x, xy * r.y - yy * r.x, xz * r.y - yz * r.x),
    )


@kernel
def point_response(inverse_mass, spins, r):
    """Return the velocity of a body's point by unit impulses there (1/kg), a symmetric matrix (xx,
    yy, zz, xy, xz, yz). inverse_mass: along global axes (3); spins: from `spins`; r (m, 3): arm."""
    ux, uy, uz = spins
    return (
        inverse_mass.x + (r.z * ux.y - r.y * ux.z),
        inverse_mass.y + (r.x * uy.z - r.z * uy.x),
        inverse_mass.z + (r.y * uz.x - r.x * uz.y),
        r.z * uy.y - r.y * uy.z,
        r.z * uz.y - r.y * uz.z,
        r.x * uz.z - r.z * uz.x,
    )


@kernel
def prepare_bodies(world, part, kick):
    """Kick all hinges' bodies, and store in part.body_scratch positions and axes before, inverse
    inertia, velocity of the hinge's point by unit impulse there (3 by 3, 1/kg), in
    part.hinge_scratch two directions normal to the first body's axis. kick: time (s)."""
    state, bodies, w = world.state, part.bodies, part.body_scratch
    for r in range(part.ends.shape[0]):
        i = part.ends[r]
        x = get3(state, i, X)
        axes = frame(state, i)
        save_pose(w, r, state, i, axes)
        v = load(world.particles, i, KICK) * get3(state, i, F) + get3(state, i, V)
        put3(state, i, V, v)
        put3(state, i, P, kick * get3(state, i, M) + get3(state, i, P))
        for k in range(6):
            store(state, i, F + k, 0.0)
        arm = to_global(axes, get3(bodies, r, hinge.ARM))
        inverse_mass = get3(bodies, r, hinge.AXIS_IM)
        j = world_inverse(axes, get3(world.particles, i, IJ))
        lever = arm
        if r % 2 == 0:
            h, scratch = r // 2, part.hinge_scratch
            put3(scratch, h, hinge.PA, to_global(axes, get3(bodies, r, hinge.REF)))
            put3(scratch, h, hinge.QA, to_global(axes, get3(bodies, r, hinge.NORMAL)))
        else:
            # Both impulses act at the first body's point: they make no moment if the hinge gapes.
            lever = get3(w, r - 1, hinge.OLD_X) + get3(w, r - 1, hinge.GLOBAL_ARM) - x
        put3(w, r, hinge.GLOBAL_ARM, lever)
        put6(w, r, hinge.INVERSE, j)
        columns = spins(j, arm)  # the lever differs by the gap, which the rounds close
        put3(w, r, hinge.SPINS, columns[0])
        put3(w, r, hinge.SPINS + 3, columns[1])
        put3(w, r, hinge.SPINS + 6, columns[2])
        put6(w, r, hinge.RESPONSE, point_response(inverse_mass, columns, arm))


@kernel
def pair_sum(b, h, field):
    """Return the sum over both bodies of hinge h of a symmetric matrix (xx, yy, zz, xy, xz, yz). b:
    body_scratch; field: that of the matrix's first number, as INVERSE."""
    first, second = get6(b, 2 * h, field), get6(b, 2 * h + 1, field)
    return (
        first[0] + second[0],
        first[1] + second[1],
        first[2] + second[2],
        first[3] + second[3],
        first[4] + second[4],
        first[5] + second[5],
    )


@kernel
def prepare_matrices(part):
    """Build and factorise the matrix (5 by 5) by which impulses change gap and tilts."""
    b, w = part.body_scratch, part.hinge_scratch
    for h in range(w.shape[0]):
        row1, row2 = 2 * h, 2 * h + 1
        p, q = get3(w, h, hinge.PA), get3(w, h, hinge.QA)
        j = pair_sum(b, h, hinge.INVERSE)
        jp, jq = symmetric(j, p), symmetric(j, q)
        pp, qq, pq = dot(p, jp), dot(q, jq), dot(p, jq)
        det = 1.0 / (pp * qq - pq * pq)
        cpp, cqq, cpq = det * qq, det * pp, -det * pq
        # Tilts by unit forces between the bodies: these turn them against each other.
        ux = get3(b, row1, hinge.SPINS) + get3(b, row2, hinge.SPINS)
        uy = get3(b, row1, hinge.SPINS + 3) + get3(b, row2, hinge.SPINS + 3)
        uz = get3(b, row1, hinge.SPINS + 6) + get3(b, row2, hinge.SPINS + 6)
        bp = opposite(to_local((ux, uy, uz), p))
        bq = opposite(to_local((ux, uy, uz), q))
        ep = cpp * bp + cpq * bq
        eq = cpq * bp + cqq * bq
        put3(w, h, hinge.C, vector(cpp, cqq, cpq))
        put3(w, h, hinge.E, ep)
        put3(w, h, hinge.E + 3, eq)
        k = pair_sum(b, h, hinge.RESPONSE)
        schur = (
            k[0] - (bp.x * ep.x + bq.x * eq.x),
            k[1] - (bp.y * ep.y + bq.y * eq.y),
            k[2] - (bp.z * ep.z + bq.z * eq.z),
            k[3] - (bp.x * ep.y + bq.x * eq.y),
            k[4] - (bp.x * ep.z + bq.x * eq.z),
            k[5] - (bp.y * ep.z + bq.y * eq.z),
        )
        put6(w, h, hinge.S, invert(schur))


@kernel
def find_impulses(part):
    """Find the impulses FORCE1, FORCE2, MP that change the gap rates of every open hinge by its
    GOAL, and store their changes DV (m/s) and DP (N m s) of its bodies."""
    bodies, b, w, open_ = part.bodies, part.body_scratch, part.hinge_scratch, part.open
    for h in range(w.shape[0]):
        if open_[h]:
            ep, eq = load(w, h, hinge.GOAL + 3), load(w, h, hinge.GOAL + 4)
            force, mp, mq = solve(w, h, get3(w, h, hinge.GOAL), ep, eq)
            put3(w, h, hinge.FORCE1, force)
            put3(w, h, hinge.FORCE2, force)
            store(w, h, hinge.MP, mp)
            store(w, h, hinge.MP + 1, mq)
    if part.has_supports:
        for h in range(w.shape[0]):
            if open_[h] and is_held(part, h):
                hold_point(part, h)
    for h in range(w.shape[0]):
        if open_[h]:
            row1, row2 = 2 * h, 2 * h + 1
            force1, force2 = get3(w, h, hinge.FORCE1), get3(w, h, hinge.FORCE2)
            mp, mq = load(w, h, hinge.MP), load(w, h, hinge.MP + 1)
            moment = mp * get3(w, h, hinge.PA) + mq * get3(w, h, hinge.QA)
            put3(b, row1, hinge.DV, times(get3(bodies, row1, hinge.AXIS_IM), force1))
            put3(b, row1, hinge.DP, cross(get3(b, row1, hinge.GLOBAL_ARM), force1) - moment)
            put3(b, row2, hinge.DV, times(get3(bodies, row2, hinge.AXIS_IM), opposite(force2)))
            put3(b, row2, hinge.DP, moment - cross(get3(b, row2, hinge.GLOBAL_ARM), force2))
