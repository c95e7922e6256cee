"""Sticking and slipping of friction without a bristle, and what it loses (rigid_friction.py)."""

from typing import NamedTuple

import numpy as np

from deployable.fpm.kernels.hooks import hook
from deployable.fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from deployable.fpm.kernels.vectors import kernel
from deployable.fpm.kinds.losses_kernels import LOSING as EARLIER  # which holds a rate here
from deployable.fpm.kinds.losses_kernels import RATE as LAST
from deployable.fpm.kinds.losses_kernels import half_rate
from deployable.fpm.kinds.opening_kernels import NOW, Openings, push, turn
from deployable.fpm.kinds.turn_arrays import HOLDS, NEEDED, RATE, TARGET, Turns
from deployable.fpm.kinds.turn_kernels import (
    HELD,
    add_due,
    begin_work,
    end_work_of,
    moment_of,
    tell_late,
)

WORKS = 0  # of turn_kernels
WAY = WORKS + HELD  # sign of the rate at which it slips, or slipped last
BRAKE = WAY + 1  # moment while it slips (N m)
TOLD = BRAKE + 1  # the same as it was before the joints were solved
LET = TOLD + 1  # -1 where it let go in this step, 1 elsewhere
STATE = LET + 1


class RigidFrictions(NamedTuple):
    """on, turn (f,); moment (f, 1, lanes); past (f, PAST, lanes); state (f, STATE, lanes)."""

    on: np.ndarray
    turn: np.ndarray
    moment: np.ndarray
    openings: Openings
    turns: Turns
    past: np.ndarray
    state: np.ndarray
    account: int


@hook(RigidFrictions)
def forces(part, world, now):
    """Brake what slips."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        if now.time > 0.0:
            store(part.past, i, EARLIER, load(part.past, i, LAST))
            store(part.past, i, LAST, half_rate(part.openings, h, now))
        held = load(part.turns.state, part.turn[i], HOLDS)
        brake = -1.0 * load(part.state, i, WAY) * load(part.moment, i, 0)
        brake = where_negative(held, 0.0, brake)
        store(part.state, i, BRAKE, brake)
        store(part.state, i, TOLD, brake)
        store(part.state, i, LET, 1.0)
        turn(part.openings, world.state, h, brake)


@hook(RigidFrictions)
def work_before(part, world, now):
    """What it lost in the half step up to now."""
    begin_work(part, world, WORKS, -1.0)


@kernel
def last_way(part, i, way, rate, now):
    """How far (rad) an opening still goes before it sticks.

    rate: that to which it would fall in this kick, below zero. If it fell so before, the way ends
    at the vertex of the parabola; else it is braked only now, from where it is.
    """
    last = way * load(part.past, i, LAST)
    fall, fell = last - rate, way * load(part.past, i, EARLIER) - last
    vertex = 0.5 * now.step * (last - 0.5 * fall) * (last - 0.5 * fall) / fall
    sudden = 0.5 * now.kick * last * last / fall
    rest = where_negative(fell - 0.5 * fall, sudden, vertex)
    return where_negative(-1.0 * last, rest, 0.0)


@hook(RigidFrictions)
def decide(part, world, now):
    """Let go where more is needed than it bears; stick where it would turn round.

    What let go in this step does not stick again in it.
    """
    for i in range(part.on.shape[0]):
        t, h, most = part.turn[i], part.on[i], load(part.moment, i, 0)
        held, way = load(part.turns.state, t, HOLDS), load(part.state, i, WAY)
        needed = (1.0 / now.kick) * load(part.turns.state, t, NEEDED)
        rate = way * load(part.turns.state, t, RATE)
        slips = where_negative(held, most - absolute(needed), 1.0)
        sticks = where_negative(held, 1.0, rate)
        sticks = where_negative(load(part.state, i, LET), 1.0, sticks)
        if any_negative(slips) or any_negative(sticks):
            before, sign = load(part.state, i, BRAKE), where_negative(needed, -1.0, 1.0)
            brake = where_negative(slips, sign * most, before)
            brake = where_negative(sticks, 0.0, brake)
            push(part.openings, world.state, h, now.kick * (brake - before))
            target = load(part.openings.angles, h, NOW) + way * last_way(part, i, way, rate, now)
            old = load(part.turns.state, t, TARGET)
            store(part.turns.state, t, TARGET, where_negative(sticks, target, old))
            held = where_negative(slips, 1.0, held)
            store(part.turns.state, t, HOLDS, where_negative(sticks, -1.0, held))
            store(part.state, i, BRAKE, brake)
            store(part.state, i, WAY, where_negative(slips, -1.0 * sign, way))
            store(part.state, i, LET, where_negative(slips, -1.0, load(part.state, i, LET)))
            part.turns.changed[0] = 1


@hook(RigidFrictions)
def work_after(part, world, now):
    """What it loses in the half step up to now by the moments of this step."""
    for i in range(part.on.shape[0]):
        moment = load(part.state, i, BRAKE) + moment_of(part.turns, part.turn[i], now)
        tell_late(part.openings, part.on[i], moment - load(part.state, i, TOLD))
        end_work_of(part, world, i, moment, WORKS, -1.0)


@hook(RigidFrictions)
def work_due(part, world, energies, row):
    """What it lost up to now by the moments of this step."""
    add_due(part, energies, row, WORKS)
