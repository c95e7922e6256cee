"""What lone hinges and coupled joints have in common: gaps that are watched, and impulses summed.

Impulses are summed over a step only in loops in which a probe wants them: the solvers count where
they push bodies; where sums are None nothing is compiled of it.
"""

from fpm.elements.joints.hinge_arrays import (
    ABOUT_ONE,
    ABOUT_TWO,
    COARSE_GAP,
    DP,
    FORCE1,
    FORCE2,
    GAP,
    MOST_GAP,
    MOST_TILT,
    OLD_D2,
    OLD_D3,
    OLD_X,
    ON_ONE,
    ON_TWO,
    TILT,
)
from fpm.elements.joints.joint_arrays import IMPULSE, TURN_IMPULSE
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store, where_negative
from fpm.kernels.layout import D2, D3, X
from fpm.kernels.vectors import add_where, cross, get3, kernel, larger, put3

ALL = -1.0
"""Where impulses count: in all lanes."""


@kernel
def clear(sums):
    """Set the impulses summed over a step to 0, at its start. sums: (rows, fields, lanes), or None
    where impulses are not summed; then nothing is done."""
    if sums is not None:
        for r in range(sums.shape[0]):
            for k in range(sums.shape[1]):
                store(sums, r, k, 0.0)


@kernel
def count_hinge(sums, part, h, condition):
    """Add the impulses last found for hinge h to row h of `sums` (None: nothing is done) in the
    lanes where `condition` is below 0. part: hinge arrays (Hinges)."""
    if sums is not None:
        w, b = part.hinge_scratch, part.body_scratch
        lanes = condition + 0.0 * load(sums, h, 0)
        add_where(sums, h, ON_ONE, get3(w, h, FORCE1), lanes)
        add_where(sums, h, ABOUT_ONE, get3(b, 2 * h, DP), lanes)
        add_where(sums, h, ON_TWO, -1.0 * get3(w, h, FORCE2), lanes)
        add_where(sums, h, ABOUT_TWO, get3(b, 2 * h + 1, DP), lanes)


@kernel
def count_joints(part, condition):
    """Add the impulses last found for all conditions of joints, and for held openings, to their
    sums, in the lanes where `condition` is below 0. part: joint arrays."""
    count_conditions(part.sums, part, condition)
    count_turns(part.turns, part, condition)


@kernel
def count_conditions(sums, part, condition):
    """Add the impulses last found for all conditions to `sums` (None: nothing is done), in the
    lanes where `condition` is below 0. part: joint arrays."""
    if sums is not None:
        for r in range(sums.shape[0]):
            total = load(sums, r, 0)
            lanes = condition + 0.0 * total
            store(sums, r, 0, where_negative(lanes, total + load(part.rows, r, IMPULSE), total))


@kernel
def count_turns(turns, part, condition):
    """Add the impulses last found for all held openings to TURN_IMPULSE of `turns` (None: nothing
    is done), in the lanes where `condition` is below 0. part: joint arrays."""
    if turns is not None:
        sums = turns.state
        for t in range(sums.shape[0]):
            total = load(sums, t, TURN_IMPULSE)
            impulse = load(part.rows, part.pattern.first[part.turn_at[t]], IMPULSE)
            lanes = condition + 0.0 * total
            store(sums, t, TURN_IMPULSE, where_negative(lanes, total + impulse, total))


@kernel
def keep(b, r, state, i, axes):
    """Save the position of particle i and the directors of its frame in row r of the bodies'
    scratch b. state: of the particles; axes: the frame's three."""
    put3(b, r, OLD_X, get3(state, i, X))
    put3(b, r, OLD_D2, axes[1])
    put3(b, r, OLD_D3, axes[2])


@kernel
def restore(b, r, state, i):
    """Bring particle i back to its saved position and directors at the start of the step, from row
    r of the bodies' scratch b; i, r: indices or pairs of them. state: of the particles."""
    put3(state, i, X, get3(b, r, OLD_X))
    put3(state, i, D2, get3(b, r, OLD_D2))
    put3(state, i, D3, get3(b, r, OLD_D3))


@kernel
def turn_little(state, i, turn):
    """Rotate particle i (or a pair) by a rotation vector `turn` (rad, 3, global) so small that its
    square does not show. state: of the particles."""
    for k in (D2, D3):
        axis = get3(state, i, k)
        put3(state, i, k, axis + cross(turn, axis))


@kernel
def coarse(time, size):
    """Factor (1/m): times a gap (m), or with `time` (s) times its rate (m/s), it gives more than 1
    where another round is due. size (m): characteristic length of the scene."""
    return (time / COARSE_GAP) / where_negative(size - 1.0, size, 0.0 * size + 1.0)


@kernel
def watch(part, gap2, tilt2):
    """Raise the watched maxima to the gaps of a hinge or joint, given by their squares; returns gap
    (m) and tilt (sine). part: hinge or joint arrays."""
    gap, tilt = sqrt(gap2), sqrt(tilt2)
    store(part.watched, 0, GAP, larger(load(part.watched, 0, GAP), gap))
    store(part.watched, 0, TILT, larger(load(part.watched, 0, TILT), tilt))
    return gap, tilt


def report_gaps(arrays, find):
    """Register the hooks that report gaps for an element type with these arrays (NamedTuple).
    find(part, state, i): squares of the gaps of element i, of points (m) and directions (sines)."""

    @hook(arrays)
    def record(part, world, row):
        """Record the largest gap (m) and tilt (sine) of all elements in row `row`."""
        gap2 = 0.0 * load(world.state, 0, X)
        tilt2 = gap2
        for i in range(part.names.shape[0]):
            gap, tilt = find(part, world.state, i)
            gap2, tilt2 = larger(gap2, gap), larger(tilt2, tilt)
        gap, tilt = watch(part, gap2, tilt2)
        store(part.gaps, row, GAP, gap)
        store(part.gaps, row, TILT, tilt)

    @hook(arrays)
    def list_excess(part, world):
        """Store for each element the summed squares of gap and tilt as fractions of the allowed."""
        for i in range(part.names.shape[0]):
            gap2, tilt2 = find(part, world.state, i)
            size = MOST_GAP * load(world.size, 0, 0)
            excess = gap2 / (size * size) + tilt2 * (1.0 / MOST_TILT**2)
            store(part.excess, part.names[i], 0, excess)
