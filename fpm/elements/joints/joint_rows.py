"""The conditions of joints: rows of their Jacobian at the start of a step, and gaps at its end."""

import math

from fpm.elements.joints.joint_arrays import (
    ALONG,
    ARM,
    AXIS,
    FIXED,
    HELD,
    HOLDS,
    MISSED,
    OFF,
    PRISMATIC,
    REFERENCE,
    REVOLUTE,
    ROOT,
    ROOT1,
    SLID,
    TARGET,
    TURN1,
    TURNS,
    UNIVERSAL,
)
from fpm.kernels.angles import arctan2
from fpm.kernels.lanes import floor, load, store, where_negative
from fpm.kernels.layout import X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import (
    cross,
    dot,
    get3,
    kernel,
    put3,
    times,
    to_global,
    to_local,
    vector,
)

FULL = 2 * math.pi


@kernel
def put_row(part, state, j, r, along, turn1, turn2):
    """Store condition r of joint j, with the moments of a unit impulse on its bodies."""
    put3(part.rows, r, ALONG, along)
    put_turn(part, state, part.slots[2 * j], r, 0, turn1)
    if part.slots[2 * j + 1] >= 0:
        put_turn(part, state, part.slots[2 * j + 1], r, 3, turn2)


@kernel
def put_turn(part, state, slot, r, k, turn):
    """Store the moment on a body at `k` behind the fields of the first.

    Its products with the inverse inertias come from roots in the body's own axes, so that they form
    a matrix that is not negative, however slender the body.
    """
    turn = times(get3(part.bodies, slot, TURNS), turn)
    own = to_local(frame(state, part.on[slot]), turn)
    put3(part.rows, r, TURN1 + k, turn)
    put3(part.rows, r, ROOT1 + k, times(get3(part.bodies, slot, ROOT), own))


@kernel
def place(part, state, j, side):
    """Position of the particle on a side of joint j, its frame, and its point (3)."""
    i = part.on[part.slots[2 * j + side]]
    axes = frame(state, i)
    x = get3(state, i, X)
    return x, axes, x + to_global(axes, get3(part.sides, 2 * j + side, ARM))


@kernel
def directions(part, j, first):
    """Of the first side of joint j: axis, reference, and the direction normal to both."""
    axis = to_global(first, get3(part.sides, 2 * j, AXIS))
    p = to_global(first, get3(part.sides, 2 * j, REFERENCE))
    return axis, p, cross(axis, p)


@kernel
def unit_vectors(like):
    """The global axes, as vectors of lanes."""
    zero = 0.0 * like
    one = zero + 1.0
    return vector(one, zero, zero), vector(zero, one, zero), vector(zero, zero, one)


@kernel
def find_rows(part, state):
    """Store the conditions of all joints, as their bodies are."""
    for j in range(part.types.shape[0]):
        if put_opening_row(part.turns, part, state, j):
            continue
        kind, r = part.types[j], part.pattern.first[j]
        x1, first, point = place(part, state, j, 0)
        ex, ey, ez = unit_vectors(x1.x)
        if kind == HELD:
            arm = point - x1
            if part.held[j, 0]:
                put_row(part, state, j, r, ex, cross(arm, ex), ex)
                r += 1
            if part.held[j, 1]:
                put_row(part, state, j, r, ey, cross(arm, ey), ey)
                r += 1
            if part.held[j, 2]:
                put_row(part, state, j, r, ez, cross(arm, ez), ez)
            continue
        x2, second, other = place(part, state, j, 1)
        axis, p, q = directions(part, j, first)
        if kind == PRISMATIC:
            # Impulses act where the second's point is, which slides on the first.
            one, two = other - x1, other - x2
            put_row(part, state, j, r, p, cross(one, p), cross(two, p))
            put_row(part, state, j, r + 1, q, cross(one, q), cross(two, q))
            r += 2
        else:
            # Both at the first's point: they make no moment if the joint gapes.
            one, two = point - x1, point - x2
            put_row(part, state, j, r, ex, cross(one, ex), cross(two, ex))
            put_row(part, state, j, r + 1, ey, cross(one, ey), cross(two, ey))
            put_row(part, state, j, r + 2, ez, cross(one, ez), cross(two, ez))
            r += 3
        none = 0.0 * p
        along = to_global(second, get3(part.sides, 2 * j + 1, AXIS))
        if kind == UNIVERSAL:
            turn = cross(axis, along)
            put_row(part, state, j, r, none, turn, turn)
        if kind in (REVOLUTE, FIXED, PRISMATIC):
            about_p, about_q = cross(p, along), cross(q, along)
            put_row(part, state, j, r, none, about_p, about_p)
            put_row(part, state, j, r + 1, none, about_q, about_q)
        if kind in (FIXED, PRISMATIC):
            turn = cross(q, to_global(second, get3(part.sides, 2 * j + 1, REFERENCE)))
            put_row(part, state, j, r + 2, none, turn, turn)


@kernel
def find_gaps(part, state, j):
    """Store the gaps of joint j in OFF, those of points in m, of directions in rad.

    Returns the sums of their squares.
    """
    if is_opening(part.turns, part, j):
        off = opening_gap(part.turns, part, state, j)
        store(part.rows, part.pattern.first[j], OFF, off)
        if part.types[j] == SLID:
            return off * off, 0.0 * off
        return 0.0 * off, off * off
    rows, kind, r = part.rows, part.types[j], part.pattern.first[j]
    _, first, point = place(part, state, j, 0)
    if kind == HELD:
        off = point - get3(part.places, j, 0)
        gap2 = 0.0 * off.x
        if part.held[j, 0]:
            store(rows, r, OFF, off.x)
            gap2 = gap2 + off.x * off.x
            r += 1
        if part.held[j, 1]:
            store(rows, r, OFF, off.y)
            gap2 = gap2 + off.y * off.y
            r += 1
        if part.held[j, 2]:
            store(rows, r, OFF, off.z)
            gap2 = gap2 + off.z * off.z
        return gap2, 0.0 * gap2
    _, second, other = place(part, state, j, 1)
    axis, p, q = directions(part, j, first)
    off = point - other
    if kind == PRISMATIC:
        u, v = dot(p, off), dot(q, off)
        store(rows, r, OFF, u)
        store(rows, r + 1, OFF, v)
        gap2 = u * u + v * v
        r += 2
    else:
        put_gap(rows, r, off)
        gap2 = dot(off, off)
        r += 3
    tilt2 = 0.0 * gap2
    along = to_global(second, get3(part.sides, 2 * j + 1, AXIS))
    if kind == UNIVERSAL:
        tilt = dot(axis, along)
        store(rows, r, OFF, tilt)
        tilt2 = tilt * tilt
    if kind in (REVOLUTE, FIXED, PRISMATIC):
        u, v = dot(p, along), dot(q, along)
        store(rows, r, OFF, u)
        store(rows, r + 1, OFF, v)
        tilt2 = u * u + v * v
    if kind in (FIXED, PRISMATIC):
        tilt = dot(q, to_global(second, get3(part.sides, 2 * j + 1, REFERENCE)))
        store(rows, r + 2, OFF, tilt)
        tilt2 = tilt2 + tilt * tilt
    return gap2, tilt2


@kernel
def put_gap(rows, r, off):
    """Store the three components of a gap in rows r, r + 1, r + 2."""
    store(rows, r, OFF, off.x)
    store(rows, r + 1, OFF, off.y)
    store(rows, r + 2, OFF, off.z)


# -- openings that are held: nothing is compiled of these where none is --------------------------


@kernel
def is_opening(turns, part, j):
    """Whether joint j holds an opening."""
    if turns is None:
        return False
    return part.turn_of[j] >= 0


@kernel
def put_opening_row(turns, part, state, j):
    """Store the condition of joint j if it holds an opening; returns whether it does."""
    if turns is None:
        return False
    return put_held_row(part, state, j)


@kernel
def opening_gap(turns, part, state, j):
    """How far (rad, m) the opening that joint j holds is off; 0 in lanes where it is free."""
    if turns is None:
        return 0.0 * load(state, 0, X)
    return held_gap(part, state, j)


@kernel
def put_held_row(part, state, j):
    """The same where some joints hold openings. No impulse acts on a row where nothing turns."""
    t = part.turn_of[j]
    if t < 0:
        return False
    r = part.pattern.first[j]
    x1, first, _ = place(part, state, j, 0)
    axis, _, _ = directions(part, j, first)
    holds = where_negative(load(part.turns.state, t, HOLDS), 1.0, 0.0)
    turn = (-1.0 * holds) * axis
    if part.types[j] == SLID:
        x2, _, other = place(part, state, j, 1)
        put_row(part, state, j, r, turn, cross(other - x1, turn), cross(other - x2, turn))
    else:
        put_row(part, state, j, r, 0.0 * axis, turn, turn)
    store(part.rows, r, MISSED, holds * load(part.rows, r, MISSED))
    return True


@kernel
def held_gap(part, state, j):
    """The same where some joints hold openings."""
    t = part.turn_of[j]
    _, first, point = place(part, state, j, 0)
    _, second, end = place(part, state, j, 1)
    axis, p, q = directions(part, j, first)
    if part.types[j] == SLID:
        way = dot(axis, end - point) - load(part.turns.state, t, TARGET)
        return where_negative(load(part.turns.state, t, HOLDS), way, 0.0)
    other = to_global(second, get3(part.sides, 2 * j + 1, REFERENCE))
    off = arctan2(dot(q, other), dot(p, other)) - load(part.turns.state, t, TARGET)
    off = off - FULL * floor((1.0 / FULL) * off + 0.5)
    return where_negative(load(part.turns.state, t, HOLDS), off, 0.0)
