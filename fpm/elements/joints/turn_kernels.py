"""Moments, work and accounts of what holds openings exactly (turn.py).

The impulse of a step is known when all else is; its moment is that by the length of the kick. By
the trapezium rule it does half of its work on the way to the positions at which it acts, and half
on the way from there, as all other moments do (losses_kernels.add_loss)."""

from fpm.elements.joints.closure import mean_force
from fpm.elements.joints.joint_arrays import FIRST_CHANGE, FIRST_IMPULSE, HOLDS, RATE, TURN_IMPULSE
from fpm.elements.openings.losses_kernels import RATE as START_RATE
from fpm.elements.openings.opening_kernels import MOMENT as OPENING_MOMENT
from fpm.elements.openings.opening_kernels import NEW, OLD, WORK
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, load, store, where_negative
from fpm.kernels.layout import ACCOUNTS, KINETIC
from fpm.kernels.vectors import kernel

# Kept for each element from one step to the next, in this order from a first field.
HOLD_MOMENT, WORK_DUE = 0, 1  # last moment (N m), and work of the half step up to it (J);
# at the start the loss that belongs to no half step (`begin_loss`)
HOLD_FIELDS = 2


@kernel
def work_on(openings, h, moment):
    """Return the work (J) of half of a `moment` (N m) on the opening of hinge h over the step."""
    return 0.5 * moment * (load(openings.angles, h, NEW) - load(openings.angles, h, OLD))


@kernel
def add_to_account(world, account, work):
    """Add `work` (lanes, J) to the energy account (column) of index `account` in world.accounts."""
    store(world.accounts, 0, account, load(world.accounts, 0, account) + work)


@kernel
def moment_of(turns, t, timing, world):
    """Return the moment (N m, lanes), on the hinge's second particle, that held joint coordinate t
    (index in `turns`) in this step: its impulse over timing.kick (s)."""
    return mean_force(world, timing) * load(turns.state, t, TURN_IMPULSE)


@kernel
def add_late_moment(moments, openings, h, moment):
    """Add a `moment` (N m) that is known only after its step, and its work (J), to what is recorded
    of joint coordinate h. moments: Openings.moments."""
    if openings.parts > 0:
        row = h * openings.parts + openings.part
        store(moments, row, OPENING_MOMENT, load(moments, row, OPENING_MOMENT) + moment)
        add_late_work(moments, openings, h, work_on(openings, h, moment))


@kernel
def add_late_work(moments, openings, h, work):
    """Add `work` (J) to what is recorded of joint coordinate h. moments: Openings.moments."""
    if openings.parts > 0:
        row = h * openings.parts + openings.part
        store(moments, row, WORK, load(moments, row, WORK) + work)


def register_losses(arrays, first):
    """Register the hooks `work_before` and `work_due` of an element type whose losses are those of
    its exact holds. arrays: its named tuple; first: field HOLD_MOMENT in part.state."""

    @hook(arrays)
    def work_before(part, world, timing):
        """Add half of the loss (J) of the moments of the last step, and that of the start."""
        for i in range(part.hinge.shape[0]):
            h = part.hinge[i]
            work = work_on(part.openings, h, load(part.state, i, first + HOLD_MOMENT))
            if timing.time < 1.5 * timing.step:
                loss = load(part.state, i, first + WORK_DUE)
                add_late_work(part.openings.moments, part.openings, h, -1.0 * loss)
                work = work - loss
            add_to_account(world, part.account, -1.0 * work)

    register_work_due(arrays, first)


def register_work_due(arrays, first):
    """Register the hook `work_due` of an element type that holds joint coordinates exactly; its
    `work_before` counts half of the work of the last step, and `work_after` calls `end_work`.
    arrays: its named tuple; first: field HOLD_MOMENT in part.state."""

    @hook(arrays)
    def work_due(part, world, energies, row, timing):
        """Add the work (J) that `end_work` counted after the instant was recorded; at the start,
        to the kinetic energy, what `begin_loss` found."""
        account = KINETIC if timing.time == 0.0 else ACCOUNTS + part.account
        for i in range(part.hinge.shape[0]):
            total = load(energies, row, account) + load(part.state, i, first + WORK_DUE)
            store(energies, row, account, total)


@kernel
def end_work(part, world, timing, first, sign):
    """Add half of the work (J, times sign) of the moments found; first: field HOLD_MOMENT."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            moment = moment_of(part.turns, part.turn[i], timing, world)
            add_late_moment(part.openings.moments, part.openings, part.hinge[i], moment)
            end_work_of(part, world, i, moment, first, sign)


@kernel
def end_work_of(part, world, i, moment, first, sign):
    """Add half of the work (J) of the `moment` (N m; lanes) of element i to part.account; store
    both in part.state. The other half follows in the next step. first, sign: as in `end_work`."""
    work = sign * work_on(part.openings, part.hinge[i], moment)
    add_to_account(world, part.account, work)
    store(part.state, i, first + HOLD_MOMENT, moment)
    store(part.state, i, first + WORK_DUE, work)


@kernel
def is_latched(turns, h, t):
    """Return -1 (lanes) where a latch other than condition t holds the joint coordinate of hinge h
    exactly, else 1. turns: Turns."""
    result = 0.0 * load(turns.state, t, HOLDS) + 1.0
    for neighbour in range(turns.hinge.shape[0]):
        if neighbour != t and turns.hinge[neighbour] == h:
            result = where_negative(load(turns.state, neighbour, HOLDS) + 1.5, -1.0, result)
    return result


@kernel
def begin_loss(part, world, timing, i, moment, first):
    """Store as WORK_DUE of element i the energy (J) that its `moment` (N m) takes in the first kick
    beyond its work by the mean rate after it: half of its impulse times the change of the rate. By
    just that the kinetic energy of velocities reflected about the start (`reflect`) is too small,
    which a stop within the first step makes most of it. There the impulse is all that changes the
    rate, of weight, loads and dampers too."""
    turns, t = part.turns.state, part.turn[i]
    change = load(turns, t, RATE) - load(part.rates, i, START_RATE)
    loss = 0.5 * change * moment / mean_force(world, timing)
    loss = where_negative(loss, 0.0, loss)
    loss = where_negative(is_latched(part.turns, part.hinge[i], t), 0.0, loss)
    whole = 0.5 * change * load(world.resistance, 0, 0) * load(turns, t, FIRST_IMPULSE)
    stops = -1.0 * absolute(load(turns, t, FIRST_CHANGE))
    stops = where_negative(load(turns, t, HOLDS), stops, 1.0)
    store(part.state, i, first + WORK_DUE, where_negative(stops, whole, loss))
