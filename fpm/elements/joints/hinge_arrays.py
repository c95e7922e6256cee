"""The arrays of hinges and where each quantity stands in them."""

from typing import NamedTuple

import numpy as np

# Constants of a body of a hinge; vectors in the particle's frame.
ARM = 0  # virtual beam (3)
AXIS = 3  # axis (3)
REF = 6  # reference direction (3)
NORMAL = 9  # axis x reference (3)
AXIS_IM = 12  # inverse masses along the global axes (3)
BODY = 15

# Constants of a hinge.
SUPPORTS = 0  # 1 where the hinge point is held along a global axis (3)
PLACE = 3  # where it is held (3)
HINGE = 6

# Scratch of a body (rows, BODY_SCRATCH, lanes).
OLD_X = 0  # position at the start of the step (3)
OLD_D2, OLD_D3 = 3, 6  # directors (3 each)
GLOBAL_ARM = 9  # arm in global components (3)
INVERSE = 12  # inverse inertia in global components (6)
RESPONSE = 18  # velocity of the hinge point per unit impulse there (6)
SPINS = 24  # spins by unit impulses there along the three global axes (3 each)
DV, DP = 33, 36  # change of velocity (3) and of angular momentum (3) by the hinge's impulses
BODY_SCRATCH = 39

# Scratch of a hinge (rows, HINGE_SCRATCH, lanes).
PA, QA = 0, 3  # the two directions normal to the axis
C = 6  # inverse of the 2 by 2 rotation block (pp, qq, pq)
E = 9  # that inverse times the coupling: rows p (3) and q (3)
S = 15  # inverse of the Schur complement of the translation block (6)
TILTS = 21  # rates of the tilts p and q by unit supports x, y, z: each 2
Y = 27  # A^-1 times the columns of the supports x, y, z: each 3 + 2
G = 42  # inverse of the supports' Schur complement (6)
HOLD = 48  # impulses of the supports (3); zero along axes that are free
MISS = 51  # what `aim` asks for besides, as it missed it before, like GOAL
# Rates to be had by impulses: of the gap (3), of the tilts about p and q, of the held point (3).
GOAL = 59
FORCE1, FORCE2, MP = 67, 70, 73  # force on body 1, against 2 (3 each), moments p, q on 2
HINGE_SCRATCH = 75

GAP, TILT = 0, 1  # watched, and recorded


class Hinges(NamedTuple):
    """Arrays of the h hinges solved alone, with movable bodies in no other joint (lanes: samples).
    Hinge i has the bodies 2 i and 2 i + 1."""

    ends: np.ndarray  # (2h,) particles of the bodies
    bodies: np.ndarray  # (2h, BODY, lanes) arm, axis, reference, normal, inverse masses
    hinges: np.ndarray  # (h, HINGE, lanes) held axes, place of the point
    fixed_axes: np.ndarray  # (h, 3) 1 where the hinge point is held along a global axis
    has_supports: bool  # whether any is
    body_scratch: np.ndarray  # (2h, BODY_SCRATCH, lanes)
    hinge_scratch: np.ndarray  # (h, HINGE_SCRATCH, lanes)
    open: np.ndarray  # (h,) whether it needs another round of this step
    peaks: np.ndarray  # (1, 2, lanes) largest gap (m) and tilt (sine) so far
    names: np.ndarray  # (h,) row of each in `excess`
    excess: np.ndarray  # (h, 1, lanes) gap and tilt squared, as shares of those allowed, summed
    gaps: np.ndarray  # (instants + 1, 2, lanes) recorded, the largest gap (m) and tilt (sine)
    sums: np.ndarray | None = None  # (h, SUMS, lanes) impulses of the step, if read
    forces: np.ndarray | None = None  # ((instants + 1) h, SUMS, lanes), N, N m


SIDE_FORCE1, SIDE_MOMENT1, SIDE_FORCE2, SIDE_MOMENT2 = 0, 3, 6, 9
SUMS = 12
"""Impulses of a joint over a step: force on a body and moment about it, of both (3 each). Divided
by the length of the kick they are its constraint forces."""

# From which gaps a hinge or joint gets another round, and counts as open. Those in lengths are
# shares of the scene's size, World.size (m).

MOST_GAP = 1e-6
"""Gap of a hinge point from which a hinge counts as open; it is below 1e-11 as a rule. It gapes
when its particles turn too far in a step for its rounds."""

MOST_TILT = 1e-5
"""Sine of the angle between the axes of a hinge from which it counts as open."""

ROUNDS = 4
"""Most rounds in a step; smooth motion takes one, a fast impact two."""

COARSE_GAP = 5e-9
"""Gap of the hinge point above which a sample gets another round, as a share of the scene's size,
of a metre at most: more than that on light bodies grows from step to step."""

COARSE_TILT = 5e-8
"""Sine of the angle between the axes of a hinge above which a sample gets another round."""
