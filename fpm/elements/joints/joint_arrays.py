"""The arrays of joints that are solved together, and where each quantity stands in them.

Joints are coupled when they share a body that can move. Elimination by least degree (Tinney and
Walker, Proc. IEEE 55 (1967) 1801) keeps what it fills in small: a chain or a tree of joints fills
nothing, a loop one block a joint. Found once for all scenes of a topology."""

from collections.abc import Sequence
from itertools import chain, product
from typing import NamedTuple

import numpy as np

# What a joint keeps together of two bodies; its type is the sum of these.
POINT = 1  # a point
ACROSS_AXIS, ACROSS_X, ACROSS_Y = 2, 4, 8  # a point in planes of the first, by their normals
CROSS = 16  # an axis of the one stays normal to an axis of the other
PARALLEL = 32  # the axes
TWIST = 64  # directions normal to the axes
THREAD = 128  # the way along the axis by the turn about it
SUPPORT = 256  # a point of the first, along global axes, where it was at the start
OPENING = 512  # the opening of a hinge, where something holds it (turn.py)
SLIDE = 1024  # the same of a slide
SCALARS = ACROSS_AXIS, ACROSS_X, ACROSS_Y, CROSS, TWIST, THREAD, OPENING, SLIDE
CONDITIONS = {POINT: 3, PARALLEL: 2, **dict.fromkeys(SCALARS, 1)}
"""Numbers of scalar constraint equations."""

# Constants of a body: a particle that joints act on.
AXIS_IM = 0  # inverse masses along the global axes (3)
HIJ = 3  # inverse principal inertias (3)
ROOT = 6  # roots of HIJ (3)
TURNS = 9  # 1 where it may turn about a global axis, 0 where not (3)
BODY = 12

# Scratch of a body; OLD_X, OLD_D2, OLD_D3 (0 to 8) are those of lone hinges (hinge_arrays.py).
INVERSE = 9  # inverse inertia in global components (6), of what may turn
SPIN = 15  # angular velocity (3)
FORCE, MOMENT = 18, 21  # impulse of a round on the body, about its particle (3 each)
ALL_FORCE, ALL_MOMENT = 24, 27  # of all rounds of the step (3 each)
LAST_V, LAST_SPIN = 30, 33  # of a driven body, in the step before (3 each)
WORK_DUE = 36  # work of the impulses of the step up to its start
BODY_SCRATCH = 37

# Constants of a side of a joint; vectors in its particle's frame.
ARM = 0  # virtual beam (3)
AXIS = 3  # axis (3)
REFERENCE = 6  # a direction normal to it (3)
LEAD = 9  # of a thread (m/rad)
SIDE = 10

# A row: one condition. Its rate is f (v1 - v2) + m1 w1 - m2 w2 of the two bodies.
DIRECTION = 0  # f (3)
TURN1, TURN2 = 3, 6  # m1, m2 (3 each)
ROOT1, ROOT2 = 9, 12  # J^-1/2 m1 and J^-1/2 m2 along the bodies' axes (3 each)
RESIDUAL = 15  # what is to be closed
MISS = 16  # rate that `aim` has to add for what it missed before
PIVOT = 17  # inverse of the diagonal of the factor
IMPULSE = 18
ROW = 19

# Of an opening that is held exactly (turn.py).
HOLDS = 0  # -1 where the opening is held, -2 by a latch, for good; 1 where it is free
TARGET = 1  # at which opening, at the end of the step (rad)
RATE = 2  # of the opening over the step, as the joints were solved last (rad/s)
TURN_IMPULSE = 3  # of the step, on the hinge's second particle (N m s)
SOLVED_IMPULSE = 4  # the same as the joints were solved last
FREE_RATE = 5  # RATE as the joints were solved first in this step
IS_NEW_STEP = 6  # 1 until then
BRAKE = 7  # moment (N m) with which friction slips or, where it turned in this step, will slip
STOPPED_RATE = 8  # at which a latch has just caught in this step (rad/s); 0: none
STOP_IMPULSE = 9  # the impulse that takes it away (N m s)
FIRST_CHANGE = 10  # of the rate in the first step, in which the opening stops (rad/s); 0: none
FIRST_IMPULSE = 11  # and the impulse for that (N m s)
TURN = 12

GAP, TILT = 0, 1  # watched, and recorded: the same places as of hinges, which share a kernel


class Pattern(NamedTuple):
    """Which blocks of the coupled joints' matrix are not zero, and where, in the order of
    elimination; block (j, k) stands row by row from an `offset` in the matrix. All integers."""

    first: np.ndarray  # (j,) first row of each joint
    count: np.ndarray  # type: ignore[assignment]  # not tuple.count; (j,) and how many it has
    diagonal: np.ndarray  # (j,) offsets of the blocks (j, j)
    meets: np.ndarray  # (m, 5) joint, other, side of either, offset: blocks and what adds to them
    below_start: np.ndarray  # (j + 1,) of each joint, where in `below` its blocks begin
    followers: np.ndarray  # (b, 2) joint further down that it is coupled to, offset of that block
    update_start: np.ndarray  # (j + 1,) of each joint, where in `updates` those begin
    updates: np.ndarray  # (u, 5) joint, other, offsets of both blocks and of the one they change


class Turns(NamedTuple):
    """Openings (joint coordinates) held exactly, t of them: shared by the joints' solver and the
    elements that hold."""

    state: np.ndarray  # (t, TURN, lanes); of slides m, m/s, N s
    impact: np.ndarray  # (1, 1, lanes) when an impact comes, as a share of this step; 0: none
    hinge: np.ndarray  # (t,) index of each one's hinge
    angles: np.ndarray  # (h, 2, lanes) of all hinges, as of Openings


class Joints(NamedTuple):
    """Arrays of all joints solved together (lanes: samples): j joints in order of elimination, with
    two sides each (2j and 2j + 1), b bodies (particles), r constraint equations ("rows"), t joint
    coordinates that are held."""

    types: np.ndarray  # (j,) sums of the constants POINT to SLIDE
    names: np.ndarray  # (j,) number of each in the scene
    slots: np.ndarray  # (2j,) bodies of the sides; -1: none
    sides: np.ndarray  # (2j, SIDE, lanes)
    places: np.ndarray  # (j, 3, lanes) where a held point is (m)
    fixed_axes: np.ndarray  # (j, 3) 1 where it is, along a global axis
    particle: np.ndarray  # (b,) particles of the bodies
    is_driven: np.ndarray  # (b,) 1 if another kind moves the body
    bodies: np.ndarray  # (b, BODY, lanes)
    body_scratch: np.ndarray  # (b, BODY_SCRATCH, lanes)
    rows: np.ndarray  # (r, ROW, lanes)
    matrix: np.ndarray  # (entries, 1, lanes) in blocks
    pattern: Pattern
    ease: float  # share of the diagonal by which the matrix is eased where conditions are redundant
    account: int  # of the drives' work, in World.accounts
    peaks: np.ndarray  # (1, 2, lanes) largest gap (m) and tilt (sine) so far
    excess: np.ndarray  # (j, 1, lanes) gap and tilt squared, as shares of those allowed, summed
    gaps: np.ndarray  # (instants + 1, 2, lanes) recorded, the largest gap (m) and tilt (sine)
    turns: Turns  # openings that are held exactly
    turn_of: np.ndarray  # (j,) number of the opening that a joint holds; -1: none
    turn_at: np.ndarray  # (t,) and the joints that hold openings
    sums: np.ndarray | None = None  # (r, 1, lanes) impulses of the step, if read
    forces: np.ndarray | None = None  # ((instants + 1) j, SUMS of hinges, lanes), N, N m


def neighbours(slots: np.ndarray, movable: np.ndarray) -> list[set[int]]:
    """Return for each joint the indices of the joints that share a movable body with it. slots (j,
    2): indices of the bodies at its sides, -1 for none; movable (b,): whether a body can move."""
    by_slot: dict[int, list[int]] = {}
    for joint, sides in enumerate(slots):
        for slot in {int(s) for s in sides if s >= 0 and movable[s]}:
            by_slot.setdefault(slot, []).append(joint)
    sets: list[set[int]] = [set() for _ in slots]
    for joints in by_slot.values():
        for joint in joints:
            sets[joint].update(joints)
    for joint, members in enumerate(sets):
        members.discard(joint)
    return sets


def elimination(graph: Sequence[set[int]]) -> tuple[list[int], list[list[int]]]:
    """Return the order in which to eliminate joints from their equations (indices), and for each
    place in it the sorted later places that it is then coupled to. graph: from `neighbours`."""
    active = {joint: set(members) for joint, members in enumerate(graph)}
    by_degree: dict[int, set[int]] = {}
    for joint, members in active.items():
        by_degree.setdefault(len(members), set()).add(joint)
    order, followers = [], []
    while active:
        degree = min(d for d, joints in by_degree.items() if joints)
        joint = min(by_degree[degree])
        by_degree[degree].discard(joint)
        members = active.pop(joint)
        for member in members:
            by_degree[len(active[member])].discard(member)
            active[member] |= members
            active[member] -= {joint, member}
            by_degree.setdefault(len(active[member]), set()).add(member)
        order.append(joint)
        followers.append(members)
    place = {joint: i for i, joint in enumerate(order)}
    return order, [sorted(place[member] for member in members) for members in followers]


def pattern(counts, slots, movable, followers: list[list[int]]) -> tuple[Pattern, int]:
    """Return the layout of the joints' matrix (Pattern), and its number of entries. counts (j,):
    constraints of each joint; slots (j, 2): bodies at its sides, -1: none; both in order of
    elimination; movable (b,): of bodies; followers: second result of `elimination`."""
    count = np.asarray(counts, np.int64)
    offsets: dict[tuple[int, int], int] = {}
    entries = 0
    for j in range(len(count)):
        for k in (j, *followers[j]):
            offsets[k, j] = entries
            entries += int(count[k] * count[j])
    meets = [
        (k, j, side1, side2, offset)
        for ((k, j), offset), side1, side2 in product(offsets.items(), range(2), range(2))
        if slots[k][side1] == slots[j][side2] >= 0 and movable[slots[k][side1]]
    ]
    updates = [
        [
            (i, k, offsets[i, j], offsets[k, j], offsets[i, k])
            for i, k in product(members, members)
            if k <= i
        ]
        for j, members in enumerate(followers)
    ]
    blocks = [[(k, offsets[k, j]) for k in members] for j, members in enumerate(followers)]
    result = Pattern(
        first=np.cumsum([0, *count[:-1]]),
        count=count,
        diagonal=_table([offsets[j, j] for j in range(len(count))]),
        meets=_table(meets, 5),
        below_start=np.cumsum([0, *map(len, blocks)]),
        followers=_table([*chain(*blocks)], 2),
        update_start=np.cumsum([0, *map(len, updates)]),
        updates=_table([*chain(*updates)], 5),
    )
    return result, entries


def _table(values, columns: int | None = None) -> np.ndarray:
    shape = (-1,) if columns is None else (-1, columns)
    return np.array(values, np.int64).reshape(shape)
