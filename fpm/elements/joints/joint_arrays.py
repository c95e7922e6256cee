"""The arrays of joints that are solved together, and where each quantity stands in them."""

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
HOLDS = 0  # -1 where the opening is held, 1 where it is free
TARGET = 1  # at which opening, at the end of the step (rad)
RATE = 2  # of the opening over the step, as the joints were solved last (rad/s)
TURN_IMPULSE = 3  # of the step, on the hinge's second particle (N m s)
SOLVED_IMPULSE = 4  # the same as the joints were solved last
TURN = 5

GAP, TILT = 0, 1  # watched, and recorded: the same places as of hinges, which share a kernel


class Pattern(NamedTuple):
    """Which blocks of the coupled joints' matrix are not zero, and where, in the order of
    elimination; block (j, k) stands row by row from an `offset` in the matrix. All integers.

    first, count (j,): first constraint equation of each joint, and how many; diagonal (j,): offsets
    of blocks (j, j); meets (m, 5): two joints, side of each at which they share a body, offset of
    the block to which that adds; below_start (j + 1,): where each joint's rows begin in followers
    (b, 2): later joint coupled to it, offset of that block; update_start (j + 1,): the same in
    updates (u, 5): joint, other, offsets of both factors and of the block they change."""

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
    elements that hold. state (t, 5, lanes): -1 held or 1 free, target (rad; m), rate (rad/s; m/s),
    impulse of the step, that of the last solution (N m s; N s); impact (1, 1, lanes): time of an
    impact as a share of this step, below 0 if it came in the step before; 0: none; hinge (t,):
    index of each one's hinge; angles: of all hinges, Openings.angles."""

    state: np.ndarray  # (t, TURN, lanes)
    impact: np.ndarray  # (1, 1, lanes) when an impact comes, in steps from the start of this one
    hinge: np.ndarray  # (t,)
    angles: np.ndarray  # (h, 2, lanes) with whole turns


class Joints(NamedTuple):
    """Arrays of all joints solved together (lanes: samples): j joints in order of elimination, with
    two sides each (2j and 2j + 1), b bodies (particles), r constraint equations ("rows"), t joint
    coordinates that are held.

    types (j,): sums of the constants POINT to SLIDE; names (j,): the joint's index in the scene;
    slots (2j,): body of each side, -1 for none; sides (2j, 10, lanes): arm (m), axis, reference, in
    particles' axes, lead (m/rad); places (j, 3, lanes), m, and fixed_axes (j, 3): where, and along
    which axes, a point is held; particle (b,): particle of each body; is_driven (b,): whether a
    drive moves it; bodies (b, 12, lanes): inverse masses and inertias, their roots, axes about
    which it turns; body_scratch (b, 37, lanes), rows (r, 19, lanes), matrix (entries, 1, lanes):
    working memory; pattern: the matrix's blocks; ease: share added to its diagonal; account: index
    of the drives' work in World.accounts; peaks (1, 2, lanes): largest gap (m) and tilt (sine) so
    far; excess (j, 1, lanes): gap and tilt squared over those allowed, summed, once a run has
    failed; gaps (instants + 1, 2, lanes): gap and tilt at each instant; sums (r, 1, lanes):
    impulses of this step (N s, N m s), forces ((instants + 1) j, 12, lanes): recorded (N, N m),
    None if not read; turns (Turns), turn_of (j,), turn_at (t,): held coordinates, index by joint or
    -1, joints."""

    types: np.ndarray  # (j,)
    names: np.ndarray  # (j,) number of each in the scene
    slots: np.ndarray  # (2j,) bodies of the sides; -1: none
    sides: np.ndarray  # (2j, SIDE, lanes)
    places: np.ndarray  # (j, 3, lanes) where a held point is
    fixed_axes: np.ndarray  # (j, 3) 1 where it is, along a global axis
    particle: np.ndarray  # (b,) particles of the bodies
    is_driven: np.ndarray  # (b,) 1 if another kind moves the body
    bodies: np.ndarray  # (b, BODY, lanes)
    body_scratch: np.ndarray  # (b, BODY_SCRATCH, lanes)
    rows: np.ndarray  # (r, ROW, lanes)
    matrix: np.ndarray  # (entries, 1, lanes)
    pattern: Pattern
    ease: float  # share of the diagonal by which the matrix is eased where conditions are redundant
    account: int  # of the work of what drives bodies
    peaks: np.ndarray  # (1, 2, lanes)
    excess: np.ndarray  # (j, 1, lanes) size of each joint's watched quantity
    gaps: np.ndarray  # (instants + 1, 2, lanes) recorded, the largest gap (m) and tilt (sine)
    turns: Turns  # openings that are held exactly
    turn_of: np.ndarray  # (j,) number of the opening that a joint holds; -1: none
    turn_at: np.ndarray  # (t,) and the joints that hold openings
    sums: np.ndarray | None = None  # (r, 1, lanes) impulses of the conditions in this step
    forces: np.ndarray | None = None  # ((instants + 1) j, SUMS of hinges, lanes) recorded
