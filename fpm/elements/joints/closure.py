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
    """Set impulses (N s, N m s), which are summed over a step, to 0 at its start. sums (rows,
    fields, lanes): those of hinges or joints; None, where nothing reads them: nothing is done."""
    if sums is not None:
        for r in range(sums.shape[0]):
            for k in range(sums.shape[1]):
                store(sums, r, k, 0.0)


@kernel
def count_hinge(sums, part, h, condition):
    """Add the impulses (N s, N m s) last found for hinge h, an index, on both bodies to row h of
    `sums` (Hinges.sums; None: nothing is done), in samples where `condition` (lanes) is below 0,
    for recorded forces. part: arrays of all hinges (Hinges)."""
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
    """Add the impulses (N s, N m s) last found for all constraint equations to `sums` (Joints.sums,
    over a step; None: nothing is done), in samples where `condition` (lanes) is below 0: slack of
    the gaps, below 0 where bodies are pushed again, or ALL (-1). part: all joints (Joints)."""
    if sums is not None:
        for r in range(sums.shape[0]):
            total = load(sums, r, 0)
            lanes = condition + 0.0 * total
            store(sums, r, 0, where_negative(lanes, total + load(part.rows, r, IMPULSE), total))


@kernel
def save_pose(b, r, state, i, axes):
    """Save the position (m) and the axes 2 and 3 of particle i in row r of `b`, the working memory
    of bodies (body_scratch), at the start of a step, for `restore_pose`. state: of the particles
    (World.state); axes: the particle's three unit vectors, global."""
    put3(b, r, hinge.OLD_X, get3(state, i, X))
    put3(b, r, hinge.OLD_D2, axes[1])
    put3(b, r, hinge.OLD_D3, axes[2])


@kernel
def restore_pose(b, r, state, i):
    """Set particle i back to the position and axes that `save_pose` saved in row r of `b`, bodies'
    working memory. state: World.state, changed."""
    put3(state, i, X, get3(b, r, hinge.OLD_X))
    put3(state, i, D2, get3(b, r, hinge.OLD_D2))
    put3(state, i, D3, get3(b, r, hinge.OLD_D3))


@kernel
def turn_little(state, i, turn):
    """Rotate the axes of a particle by a rotation vector `turn` (rad, 3, global) so small that its
    square does not show, to close small tilts. state: World.state, changed; i: the particle's."""
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
    """Raise the largest gap and tilt so far, in part.peaks, to the roots of gap2 (m²) and tilt2
    (squared sine of the axes' angle), both lanes (a number for each sample); returns these roots
    (m, sine). part: arrays of elements (Hinges or Joints)."""
    gap, tilt = sqrt(gap2), sqrt(tilt2)
    store(part.peaks, 0, hinge.GAP, larger(load(part.peaks, 0, hinge.GAP), gap))
    store(part.peaks, 0, hinge.TILT, larger(load(part.peaks, 0, hinge.TILT), tilt))
    return gap, tilt


def report_gaps(arrays, find):
    """Register the hooks `record` (of the largest gap and tilt) and `list_excess` (of how far each
    gapes) for a type `arrays` of kernel arrays (Hinges or Joints). find(part, state,
    i): kernel that returns two squares for element i: of the distance of its points (m²), and of
    the sine of the angle between its axes."""

    @hook(arrays)
    def record(part, world, row):
        """Store the largest gap (m) and tilt (sine) of all hinges or joints in part.gaps, at index
        `row`, that of the recorded instant. part: their arrays; world: state of the solver."""
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
        """After a failure, store in part.excess how far each hinge or joint gapes: squared gap and
        tilt over the allowed, summed, to name the worst. part: their arrays; world: state."""
        for i in range(part.names.shape[0]):
            gap2, tilt2 = find(part, world.state, i)
            size = hinge.MOST_GAP * load(world.size, 0, 0)
            excess = gap2 / (size * size) + tilt2 * (1.0 / hinge.MOST_TILT**2)
            store(part.excess, part.names[i], 0, excess)
