"""Moments, work and accounts of what holds openings exactly (turn.py).

The impulse of a step is known when all else is; its moment is that by the length of the kick. By
the trapezium rule it does half of its work on the way to the positions at which it acts, and half
on the way from there, as all other moments do (losses_kernels.add_loss).

And what coupled joints among which some hold openings do otherwise: `prepare` only kicks the
bodies; `solve` finds the impulses, again where it was decided otherwise, and tells the rates that
the openings would have; `move` begins with the impulses that stand then."""

from fpm.elements.joints import joint_kernels
from fpm.elements.joints.closure import clear, mean_force, report_gaps
from fpm.elements.joints.joint_arrays import (
    AXIS,
    AXIS_IM,
    DIRECTION,
    FORCE,
    HOLDS,
    IMPULSE,
    INVERSE,
    MOMENT,
    RATE,
    RESIDUAL,
    SLIDE,
    SOLVED_IMPULSE,
    SPIN,
    TARGET,
    TURN1,
    TURN2,
    TURN_IMPULSE,
    TURNS,
    TurnedJoints,
)
from fpm.elements.joints.joint_matrix import build, factorise
from fpm.elements.joints.joint_rows import find_gaps, find_rows, place
from fpm.elements.openings.opening_kernels import MOMENT as OPENING_MOMENT
from fpm.elements.openings.opening_kernels import NEW, OLD, WORK
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.layout import ACCOUNTS, P, V, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import (
    add3,
    cross,
    dot,
    get3,
    get6,
    kernel,
    put3,
    symmetric,
    times,
    to_global,
)

# Kept for each element from one step to the next, in this order from a first field.
HOLD_MOMENT, WORK_DUE = 0, 1  # last moment (N m), and work of the half step up to it (J)
HOLD_FIELDS = 2


@kernel
def work_on(openings, h, moment):
    """Return the work (J) of half of a `moment` (N m) on the opening of hinge h over the step that
    ends now. openings: arrays of all joint coordinates (Openings), now and a step ago."""
    return 0.5 * moment * (load(openings.angles, h, NEW) - load(openings.angles, h, OLD))


@kernel
def add_to_account(world, account, work):
    """Add `work` (lanes, J) to the energy account (column) of index `account` in world.accounts."""
    store(world.accounts, 0, account, load(world.accounts, 0, account) + work)


@kernel
def moment_of(turns, t, timing, world):
    """Return the moment (N m, lanes), on the hinge's second particle, that held joint coordinate t
    in this step: its impulse over timing.kick (s). turns: joint coordinates held exactly (Turns);
    t: index among these; timing (StepTime): times of the step (s); world: with its resistance."""
    return mean_force(world, timing) * load(turns.state, t, TURN_IMPULSE)


@kernel
def add_late_moment(moments, openings, h, moment):
    """Add a `moment` (N m) that is known only after its step, and its work (J), to what is recorded
    of joint coordinate h (index) as the part of one element type. moments: Openings.moments;
    openings: arrays of all joint coordinates, as the type takes them."""
    if openings.parts > 0:
        row = h * openings.parts + openings.part
        store(moments, row, OPENING_MOMENT, load(moments, row, OPENING_MOMENT) + moment)
        store(moments, row, WORK, load(moments, row, WORK) + work_on(openings, h, moment))


def register_losses(arrays, first):
    """Register the hooks `work_before` and `work_due` of an element type that loses what its exact
    holds take, and nothing else in `work_before`; called once, where its kernels are defined.
    arrays: its named tuple; first: index of the field HOLD_MOMENT in part.state."""

    @hook(arrays)
    def work_before(part, world, timing):
        """Add half of the loss (J) of the moments of the last step, over the step that ends now, to
        part.account. part: arrays of the elements; world: solver state; timing: not used."""
        for i in range(part.hinge.shape[0]):
            work = work_on(part.openings, part.hinge[i], load(part.state, i, first + HOLD_MOMENT))
            add_to_account(world, part.account, -1.0 * work)

    register_work_due(arrays, first)


def register_work_due(arrays, first):
    """Register the hook `work_due` of an element type that holds joint coordinates exactly; called
    once, where its kernels are defined. arrays: its named tuple; first: index of the field
    HOLD_MOMENT in part.state. Its hook `work_before` counts half of the work of the last step, and
    `work_after` calls `end_work`."""

    @hook(arrays)
    def work_due(part, world, energies, row, timing):
        """Add the work (J) that `end_work` counted after the instant was recorded but is due before
        it, to recorded energies. part: arrays; world, timing: not used; energies (instants,
        columns, lanes): changed in row `row` (the instant's), column ACCOUNTS + part.account."""
        for i in range(part.hinge.shape[0]):
            account = ACCOUNTS + part.account
            total = load(energies, row, account) + load(part.state, i, first + WORK_DUE)
            store(energies, row, account, total)


@kernel
def end_work(part, world, timing, first, sign):
    """Add half of the work (J) of the moments found in this step, over the step that ends now, of
    all elements to account part.account of World. part: arrays of elements; world: World; timing:
    StepTime (s); first: index of HOLD_MOMENT in part.state; sign: 1 for work, -1 for losses."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            moment = moment_of(part.turns, part.turn[i], timing, world)
            add_late_moment(part.openings.moments, part.openings, part.hinge[i], moment)
            end_work_of(part, world, i, moment, first, sign)


@kernel
def end_work_of(part, world, i, moment, first, sign):
    """Add half of the work (J) of the `moment` (N m; on a slide a force, N; lanes) of element i
    over the step that ends now to account part.account of World, and store moment and work in
    part.state. The other half follows in the next step (`work_before`). part: arrays of elements;
    first: index of HOLD_MOMENT in part.state; sign: 1: work given, -1: loss."""
    work = sign * work_on(part.openings, part.hinge[i], moment)
    add_to_account(world, part.account, work)
    store(part.state, i, first + HOLD_MOMENT, moment)
    store(part.state, i, first + WORK_DUE, work)


@hook(TurnedJoints)
def prepare(part, world, timing):
    """Update the momenta of the bodies of all joints by the forces, summed before, over the time
    timing.kick, and set world.undecided: the joints' impulses are found by `solve`. part: arrays of
    all joints (TurnedJoints); world (World): solver state, changed; timing: StepTime (s)."""
    clear(part.sums)
    joint_kernels.kick_bodies(part, world.state, timing.kick)
    world.undecided[0] = 1
    for t in range(part.turn_at.shape[0]):
        store(part.turns.state, t, TURN_IMPULSE, 0.0)


@hook(TurnedJoints)
def solve(part, world, timing):
    """Find the impulses of all joints, with the joint coordinates that are held now, and store the
    rates they would give (`store_rates`); called again where `decide` of an element then holds or
    frees one. part: all joints (TurnedJoints); world: World; timing: StepTime (s)."""
    find_rows(part, world.state)
    build(part)
    factorise(part)
    joint_kernels.find_rates(part, world.state)
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        r, turns = part.pattern.first[j], part.turns
        # By the opening, which counts whole turns: a step may take several.
        gap = load(turns.angles, turns.hinge[t], NEW) - load(turns.state, t, TARGET)
        gap = where_negative(load(turns.state, t, HOLDS), gap, 0.0)
        store(part.rows, r, RESIDUAL, load(part.rows, r, RESIDUAL) + (1.0 / timing.step) * gap)
    joint_kernels.find_impulses(part, -1.0)
    store_rates(part, world.state)


@kernel
def store_rates(part, state):
    """Store in part.turns.state the rates (rad/s, m/s) that joint coordinates will have after the
    impulses (RATE), and the impulses (N m s, N s) that hold them (SOLVED_IMPULSE). part: arrays of
    all joints (TurnedJoints); state: of the particles (World.state)."""
    b = part.body_scratch
    for s in range(part.particle.shape[0]):
        if not part.is_driven[s]:
            rotation = symmetric(get6(b, s, INVERSE), get3(b, s, MOMENT))
            add3(b, s, SPIN, times(get3(part.bodies, s, TURNS), rotation))
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        slot1, slot2 = part.slots[2 * j], part.slots[2 * j + 1]
        axis = to_global(frame(state, part.particle[slot1]), get3(part.sides, 2 * j, AXIS))
        if part.types[j] == SLIDE:
            _, _, end = place(part, state, j, 1)
            change = velocity(part, state, slot2, end) - velocity(part, state, slot1, end)
            rate = dot(axis, change)
        else:
            rate = dot(axis, get3(b, slot2, SPIN) - get3(b, slot1, SPIN))
        store(part.turns.state, t, RATE, rate)
        store(part.turns.state, t, SOLVED_IMPULSE, load(part.rows, part.pattern.first[j], IMPULSE))


@kernel
def velocity(part, state, s, point):
    """Return the velocity (m/s, 3) that a `point` (m, 3, global) moving with body s has after the
    impulses, which are not yet applied. part: all joints (TurnedJoints); state: World.state."""
    b, i = part.body_scratch, part.particle[s]
    v = get3(state, i, V)
    if not part.is_driven[s]:
        v = v + times(get3(part.bodies, s, AXIS_IM), get3(b, s, FORCE))
    return v + cross(get3(b, s, SPIN), point - get3(state, i, X))


@hook(TurnedJoints)
def move(part, world, timing):
    """Apply the impulses to the bodies, move them by a step, and close the joints at its end. part:
    all joints (TurnedJoints); world (World): solver state, changed; timing: StepTime (s)."""
    joint_kernels.push_all(part, world.state)
    joint_kernels.move(part, world, timing)


@hook(TurnedJoints)
def look_back(part, world, timing):
    """Close the joints also one step before the start, in the first step only, by the momenta in
    world.start_state; there, held coordinates are where their motion, at its rate at the start,
    began. part: all joints (TurnedJoints); world (World): solver state; timing: StepTime (s)."""
    state, start, b = world.state, world.start_state, part.body_scratch
    for s in range(part.particle.shape[0]):
        i = part.particle[s]
        total = get3(start, i, P) + get3(state, i, P)  # that at the start
        if not part.is_driven[s]:
            total = times(get3(part.bodies, s, TURNS), symmetric(get6(b, s, INVERSE), total))
        put3(b, s, SPIN, total)
    joint_kernels.move_back(part, start, timing.step)
    for j in range(part.types.shape[0]):
        find_gaps(part, start, j)
    for t in range(part.turn_at.shape[0]):
        j = part.turn_at[t]
        r, slot1, slot2 = part.pattern.first[j], part.slots[2 * j], part.slots[2 * j + 1]
        first, second = part.particle[slot1], part.particle[slot2]
        v = (get3(start, first, V) + get3(state, first, V)) - get3(start, second, V)
        rate = dot(get3(part.rows, r, DIRECTION), v - get3(state, second, V))
        rate = rate + dot(get3(part.rows, r, TURN1), get3(b, slot1, SPIN))
        rate = rate - dot(get3(part.rows, r, TURN2), get3(b, slot2, SPIN))
        store(part.rows, r, RESIDUAL, load(part.rows, r, RESIDUAL) + timing.step * rate)
    joint_kernels.close_before(part, start, timing.step)


for _name in ("work_after", "work_due", "record_step"):
    hook(TurnedJoints, _name)(getattr(joint_kernels, _name))
report_gaps(TurnedJoints, find_gaps)
