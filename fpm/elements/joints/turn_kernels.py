"""Moments, work and accounts of what holds openings exactly (turn.py).

The impulse of a step is known when all else is; its moment is that by the length of the kick. By
the trapezium rule it does half of its work on the way to the positions at which it acts, and half
on the way from there, as all other moments do (losses_kernels.lose).
"""

from fpm.elements.joints.turn_arrays import IMPULSE
from fpm.elements.openings.opening_kernels import BEFORE, MOMENT, NOW, WORK
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ACCOUNTS
from fpm.kernels.vectors import kernel

# Kept for each element from one step to the next, in this order from a first field.
HELD_BY, DUE = 0, 1  # moment (N m) at the last positions; work of the half step up to them (J)
HELD = 2


@kernel
def work_on(openings, h, moment):
    """Work (J) of half of a moment on opening h, on the way of the step up to now."""
    return 0.5 * moment * (load(openings.angles, h, NOW) - load(openings.angles, h, BEFORE))


@kernel
def give(world, account, work):
    """Add work (lanes, J) to an account."""
    store(world.accounts, 0, account, load(world.accounts, 0, account) + work)


@kernel
def moment_of(turns, t, now):
    """Moment (N m) on the second particle by which opening t was held at now.time."""
    return (1.0 / now.kick) * load(turns.state, t, IMPULSE)


@kernel
def tell_late(told, openings, h, moment):
    """Count a moment of the kicks that are over, and its work up to now, where moments are told
    apart.
    """
    if told is not None:
        row = h * openings.parts + openings.which
        store(told, row, MOMENT, load(told, row, MOMENT) + moment)
        store(told, row, WORK, load(told, row, WORK) + work_on(openings, h, moment))


@kernel
def begin_work(part, world, first, sign):
    """Half of the work of the moments of the step before, on the way up to now (`work_before`).

    first: the field of part.state with HELD_BY; sign: 1 for an account that is given to, -1 for one
    of losses.
    """
    for i in range(part.on.shape[0]):
        work = work_on(part.openings, part.on[i], load(part.state, i, first + HELD_BY))
        give(world, part.account, sign * work)


@kernel
def end_work(part, world, now, first, sign):
    """The other half, of the moments of this step (`work_after`)."""
    for i in range(part.on.shape[0]):
        moment = moment_of(part.turns, part.turn[i], now)
        tell_late(part.openings.told, part.openings, part.on[i], moment)
        end_work_of(part, world, i, moment, first, sign)


@kernel
def end_work_of(part, world, i, moment, first, sign):
    """The other half, of the moment of element i."""
    work = sign * work_on(part.openings, part.on[i], moment)
    give(world, part.account, work)
    store(part.state, i, first + HELD_BY, moment)
    store(part.state, i, first + DUE, work)


@kernel
def add_due(part, energies, row, first):
    """What `end_work` has counted, in a row that was recorded before (`work_due`)."""
    for i in range(part.on.shape[0]):
        account = ACCOUNTS + part.account
        due = load(energies, row, account) + load(part.state, i, first + DUE)
        store(energies, row, account, due)
