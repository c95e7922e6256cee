"""The conditions of joints: rows of their Jacobian at the start of a step, and gaps at its end."""

import math

from fpm.elements.joints import joint_arrays as joint
from fpm.kernels.lanes import floor, load, store, where_negative
from fpm.kernels.layout import X
from fpm.kernels.rotation import arctan2, frame
from fpm.kernels.vectors import cross, dot, get3, kernel, put3, times, to_global, to_local, vector

FULL = 2 * math.pi
PLANES = joint.ACROSS_X, joint.ACROSS_Y, joint.ACROSS_AXIS


@kernel
def put_row(part, state, j, r, linear, turn1, turn2):
    """Store constraint equation r of joint j: the unit direction `linear` (0 if none) and the
    moments turn1, turn2 (3, global) of its unit impulse on the joint's bodies."""
    put3(part.rows, r, joint.DIRECTION, linear)
    put_turn(part, state, part.slots[2 * j], r, 0, turn1)
    if part.slots[2 * j + 1] >= 0:
        put_turn(part, state, part.slots[2 * j + 1], r, 3, turn2)


@kernel
def put_turn(part, state, slot, r, k, turn):
    """Store in row r the moment `turn` (m, 3, global) of a unit impulse on body `slot`, and its
    product with the root of the body's inverse inertia, in the body's own axes, so that the matrix
    of these is never negative. k: 0 for the joint's first side, 3 for its second."""
    turn = times(get3(part.bodies, slot, joint.TURNS), turn)
    local_turn = to_local(frame(state, part.particle[slot]), turn)
    put3(part.rows, r, joint.TURN1 + k, turn)
    put3(part.rows, r, joint.ROOT1 + k, times(get3(part.bodies, slot, joint.ROOT), local_turn))


@kernel
def place(part, state, j, side):
    """Return position (m), axes, and joint's point (m) on one `side` (0, 1) of joint j, global."""
    i = part.particle[part.slots[2 * j + side]]
    axes = frame(state, i)
    x = get3(state, i, X)
    return x, axes, x + to_global(axes, get3(part.sides, 2 * j + side, joint.ARM))


@kernel
def directions(part, j, first):
    """Return the axis of joint j, its reference direction (normal to it), and the direction normal
    to both: global unit vectors on its first side. part: Joints; first: axes of that particle."""
    axis = to_global(first, get3(part.sides, 2 * j, joint.AXIS))
    p = to_global(first, get3(part.sides, 2 * j, joint.REFERENCE))
    return axis, p, cross(axis, p)


@kernel
def unit_vectors(number):
    """Return the unit vectors along global x, y, z, of the type of `number` (lanes)."""
    zero = 0.0 * number
    unity = zero + 1.0
    return vector(unity, zero, zero), vector(zero, unity, zero), vector(zero, zero, unity)


@kernel
def find_rows(part, state):
    """Store all joints' constraint equations: how motions of bodies change the gaps (Jacobian)."""
    for j in range(part.types.shape[0]):
        if part.turn_of[j] >= 0:
            put_held_row(part, state, j)
            continue
        kind, r = part.types[j], part.pattern.first[j]
        x1, first, point = place(part, state, j, 0)
        units = unit_vectors(x1.x)
        if kind == joint.SUPPORT:
            arm = point - x1
            for k in range(3):
                if part.fixed_axes[j, k]:
                    put_row(part, state, j, r, units[k], cross(arm, units[k]), 0.0 * units[k])
                    r += 1
            continue
        x2, second, x3 = place(part, state, j, 1)
        axis, p, q = directions(part, j, first)
        if kind & joint.POINT:
            # Both at the first's point: they make no moment if the joint gapes.
            arm1, arm2 = point - x1, point - x2
            for e in units:
                put_row(part, state, j, r, e, cross(arm1, e), cross(arm2, e))
                r += 1
        # Impulses act where the second's point is, which slides on the first.
        arm1, arm2 = x3 - x1, x3 - x2
        normals = p, q, axis
        for k in range(3):
            if kind & PLANES[k]:
                normal = normals[k]
                put_row(part, state, j, r, normal, cross(arm1, normal), cross(arm2, normal))
                r += 1
        zero = 0.0 * p
        axis2 = to_global(second, get3(part.sides, 2 * j + 1, joint.AXIS))
        if kind & joint.CROSS:
            turn = cross(axis, axis2)
            put_row(part, state, j, r, zero, turn, turn)
        if kind & joint.PARALLEL:
            about_p, about_q = cross(p, axis2), cross(q, axis2)
            put_row(part, state, j, r, zero, about_p, about_p)
            put_row(part, state, j, r + 1, zero, about_q, about_q)
            r += 2
        if kind & joint.TWIST:
            turn = cross(q, to_global(second, get3(part.sides, 2 * j + 1, joint.REFERENCE)))
            put_row(part, state, j, r, zero, turn, turn)
        if kind & joint.THREAD:
            turn = load(part.sides, 2 * j, joint.LEAD) * axis
            put_row(part, state, j, r, axis, cross(arm1, axis) - turn, cross(arm2, axis) - turn)


@kernel
def find_gaps(part, state, j):
    """Store the gaps of joint j in RESIDUAL of its rows, between points (m) and directions (sines);
    return the sums of squares of the former (m²) and of the latter."""
    if part.turn_of[j] >= 0:
        gap = find_lock_gap(part, state, j)
        store(part.rows, part.pattern.first[j], joint.RESIDUAL, gap)
        if part.types[j] == joint.SLIDE:
            return gap * gap, 0.0 * gap
        return 0.0 * gap, gap * gap
    rows, kind, r = part.rows, part.types[j], part.pattern.first[j]
    _, first, point = place(part, state, j, 0)
    if kind == joint.SUPPORT:
        if part.slots[2 * j + 1] >= 0:
            gap = point - place(part, state, j, 1)[2]
        else:
            gap = point - get3(part.places, j, 0)
        gap2, components = 0.0 * gap.x, (gap.x, gap.y, gap.z)
        for k in range(3):
            if part.fixed_axes[j, k]:
                store(rows, r, joint.RESIDUAL, components[k])
                gap2 = gap2 + components[k] * components[k]
                r += 1
        return gap2, 0.0 * gap2
    _, second, point2 = place(part, state, j, 1)
    axis, p, q = directions(part, j, first)
    gap = point - point2
    gap2 = 0.0 * gap.x
    if kind & joint.POINT:
        store(rows, r, joint.RESIDUAL, gap.x)
        store(rows, r + 1, joint.RESIDUAL, gap.y)
        store(rows, r + 2, joint.RESIDUAL, gap.z)
        gap2 = dot(gap, gap)
        r += 3
    normals = p, q, axis
    for k in range(3):
        if kind & PLANES[k]:
            u = dot(normals[k], gap)
            store(rows, r, joint.RESIDUAL, u)
            gap2 = gap2 + u * u
            r += 1
    tilt2 = 0.0 * gap2
    axis2 = to_global(second, get3(part.sides, 2 * j + 1, joint.AXIS))
    if kind & joint.CROSS:
        tilt = dot(axis, axis2)
        store(rows, r, joint.RESIDUAL, tilt)
        tilt2 = tilt * tilt
    if kind & joint.PARALLEL:
        u, v = dot(p, axis2), dot(q, axis2)
        store(rows, r, joint.RESIDUAL, u)
        store(rows, r + 1, joint.RESIDUAL, v)
        tilt2 = u * u + v * v
        r += 2
    if kind & joint.TWIST:
        tilt = dot(q, to_global(second, get3(part.sides, 2 * j + 1, joint.REFERENCE)))
        store(rows, r, joint.RESIDUAL, tilt)
        tilt2 = tilt2 + tilt * tilt
    if kind & joint.THREAD:
        lead = load(part.sides, 2 * j, joint.LEAD)
        reference = to_global(second, get3(part.sides, 2 * j + 1, joint.REFERENCE))
        u = dot(axis, gap) + lead * arctan2(dot(q, reference), dot(p, reference))
        u = u - FULL * lead * floor(u / (FULL * lead) + 0.5)  # all turns of a thread are alike
        store(rows, r, joint.RESIDUAL, u)
        gap2 = gap2 + u * u
    return gap2, tilt2


@kernel
def put_held_row(part, state, j):
    """Store the constraint equation of joint j, which holds a joint coordinate. The row is zero in
    samples where the coordinate is free. part: all joints (Joints); state: World.state."""
    t, r = part.turn_of[j], part.pattern.first[j]
    x1, first, _ = place(part, state, j, 0)
    axis, _, _ = directions(part, j, first)
    holds = where_negative(load(part.turns.state, t, joint.HOLDS), 1.0, 0.0)
    turn = (-1.0 * holds) * axis
    if part.types[j] == joint.SLIDE:
        x2, _, point2 = place(part, state, j, 1)
        put_row(part, state, j, r, turn, cross(point2 - x1, turn), cross(point2 - x2, turn))
    else:
        put_row(part, state, j, r, 0.0 * axis, turn, turn)
    store(part.rows, r, joint.MISS, holds * load(part.rows, r, joint.MISS))


@kernel
def find_lock_gap(part, state, j):
    """Return by how much (m; rad, within ±pi; lanes) the joint coordinate that joint j holds misses
    its TARGET at the end of the step; 0 in lanes where it is free."""
    t = part.turn_of[j]
    _, first, point = place(part, state, j, 0)
    _, second, end = place(part, state, j, 1)
    axis, p, q = directions(part, j, first)
    if part.types[j] == joint.SLIDE:
        gap = dot(axis, end - point) - load(part.turns.state, t, joint.TARGET)
        return where_negative(load(part.turns.state, t, joint.HOLDS), gap, 0.0)
    reference = to_global(second, get3(part.sides, 2 * j + 1, joint.REFERENCE))
    angle = arctan2(dot(q, reference), dot(p, reference)) - load(part.turns.state, t, joint.TARGET)
    angle = angle - FULL * floor((1.0 / FULL) * angle + 0.5)
    return where_negative(load(part.turns.state, t, joint.HOLDS), angle, 0.0)
