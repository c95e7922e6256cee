"""What lone hinges and coupled joints have in common: gaps that are watched, and impulses summed.
Impulses are summed over a step only where a probe wants them: the solvers count where they push
bodies; where sums are None nothing of it is compiled."""

from fpm.elements.joints import hinge_arrays as hinge
from fpm.elements.joints.joint_arrays import IMPULSE, TURN_IMPULSE
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store, where_negative
from fpm.kernels.layout import D2, D3, X
from fpm.kernels.vectors import add_where, cross, get3, kernel, larger, put3

ALL = -1.0
"""Where impulses count: in all lanes."""


@kernel
def mean_force(world, timing):
    """Return the force (N, N m; lanes) in a step for each unit of an impulse (N s, N m s) by which
    joints act. world: with its resistance, by damping; timing (StepTime): times of the step (s)."""
    return (1.0 / timing.kick) * load(world.resistance, 0, 0)


@kernel
def clear(sums):
    """Set impulses (rows, fields, lanes), summed over a step, to 0; None: nothing is done."""
    if sums is not None:
        for r in range(sums.shape[0]):
            for k in range(sums.shape[1]):
                store(sums, r, k, 0.0)


@kernel
def count_hinge(sums, part, h, condition):
    """Add the impulses last found for hinge h, on both bodies, to its row of `sums` (None: not
    counted), in samples where `condition` (lanes) is below 0."""
    if sums is not None:
        w, b = part.hinge_scratch, part.body_scratch
        lanes = condition + 0.0 * load(sums, h, 0)
        add_where(sums, h, hinge.SIDE_FORCE1, get3(w, h, hinge.FORCE1), lanes)
        add_where(sums, h, hinge.SIDE_MOMENT1, get3(b, 2 * h, hinge.DP), lanes)
        add_where(sums, h, hinge.SIDE_FORCE2, -1.0 * get3(w, h, hinge.FORCE2), lanes)
        add_where(sums, h, hinge.SIDE_MOMENT2, get3(b, 2 * h + 1, hinge.DP), lanes)


@kernel
def count_joints(part, condition):
    """Add the impulses (N s, N m s) last found for all constraint equations of joints to part.sums,
    and of those that hold joint coordinates to part.turns.state, in samples where `condition`
    (lanes) is below 0: after each round of a step. part: arrays of all joints (Joints)."""
    count_conditions(part.sums, part, condition)
    sums = part.turns.state
    for t in range(sums.shape[0]):
        total = load(sums, t, TURN_IMPULSE)
        impulse = load(part.rows, part.pattern.first[part.turn_at[t]], IMPULSE)
        lanes = condition + 0.0 * total
        store(sums, t, TURN_IMPULSE, where_negative(lanes, total + impulse, total))


@kernel
def count_conditions(sums, part, condition):
    """Add the impulses last found to `sums` (Joints.sums; None: not counted), in samples where
    `condition` (lanes) is below 0: slack of the gaps, or ALL (-1)."""
    if sums is not None:
        for r in range(sums.shape[0]):
            total = load(sums, r, 0)
            lanes = condition + 0.0 * total
            store(sums, r, 0, where_negative(lanes, total + load(part.rows, r, IMPULSE), total))


@kernel
def save_pose(b, r, state, i, axes):
    """Save position (m) and axes 2 and 3 of particle i in row r of `b` (body_scratch)."""
    put3(b, r, hinge.OLD_X, get3(state, i, X))
    put3(b, r, hinge.OLD_D2, axes[1])
    put3(b, r, hinge.OLD_D3, axes[2])


@kernel
def restore_pose(b, r, state, i):
    """Set particle i back to what `save_pose` saved in row r of `b`."""
    put3(state, i, X, get3(b, r, hinge.OLD_X))
    put3(state, i, D2, get3(b, r, hinge.OLD_D2))
    put3(state, i, D3, get3(b, r, hinge.OLD_D3))


@kernel
def turn_little(state, i, turn):
    """Rotate the axes of particle i by a vector `turn` (rad, global) whose square does not show."""
    for k in (D2, D3):
        axis = get3(state, i, k)
        put3(state, i, k, axis + cross(turn, axis))


@kernel
def coarse(time, size):
    """Return the factor by which a joint's gap is multiplied to judge it: above 1 the step needs
    another round. It is time over the allowed gap, 5e-9 times size or 1 m, the smaller. time: 1.0
    for a gap (m), the time step (s) for its rate (m/s); size: scene's characteristic length (m)."""
    return (time / hinge.COARSE_GAP) / where_negative(size - 1.0, size, 0.0 * size + 1.0)


@kernel
def watch(part, gap2, tilt2):
    """Raise part.peaks to the roots of gap2 (m²) and tilt2 (squared sine); return these."""
    gap, tilt = sqrt(gap2), sqrt(tilt2)
    store(part.peaks, 0, hinge.GAP, larger(load(part.peaks, 0, hinge.GAP), gap))
    store(part.peaks, 0, hinge.TILT, larger(load(part.peaks, 0, hinge.TILT), tilt))
    return gap, tilt


def report_gaps(arrays, find):
    """Register the hooks `record` and `list_excess` for a type `arrays` (Hinges or Joints).
    find(part, state, i): kernel that returns the squares of the distance of element i's points
    (m²), and of the sine of the angle between its axes."""

    @hook(arrays)
    def record(part, world, row):
        """Store the largest gap (m) and tilt (sine) of all hinges or joints in part.gaps."""
        gap2 = 0.0 * load(world.state, 0, X)
        tilt2 = gap2
        for i in range(part.names.shape[0]):
            gap, tilt = find(part, world.state, i)
            gap2, tilt2 = larger(gap2, gap), larger(tilt2, tilt)
        gap, tilt = watch(part, gap2, tilt2)
        store(part.gaps, row, hinge.GAP, gap)
        store(part.gaps, row, hinge.TILT, tilt)

    @hook(arrays)
    def list_excess(part, world):
        """Store in part.excess squared gap and tilt of each over the allowed ones, summed."""
        for i in range(part.names.shape[0]):
            gap2, tilt2 = find(part, world.state, i)
            size = hinge.MOST_GAP * load(world.size, 0, 0)
            excess = gap2 / (size * size) + tilt2 * (1.0 / hinge.MOST_TILT**2)
            store(part.excess, part.names[i], 0, excess)
