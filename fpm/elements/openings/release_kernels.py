"""Moments, energies and events of releases (theory: docs/mechanics.md, "Loops, motors and
releases").

A kick at time t stands for the moment from half a step before t to half a step after: what the kick
before had too much is taken back."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import HOLDS as TURN_HOLDS
from fpm.elements.joints.joint_arrays import Turns
from fpm.elements.joints.turn_kernels import (
    HOLD_MOMENT,
    end_work,
    register_work_due,
    work_on,
)
from fpm.elements.openings.latch_kernels import CATCH_TIME, IS_CAUGHT
from fpm.elements.openings.losses_kernels import follow_rate
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.record import note
from fpm.kernels.vectors import kernel, larger
from fpm.kernels.world import Log

# Constants of a release.
NUMBERS = "time", "level", "stiffness", "damping", "hold"
TIME, LEVEL, STIFFNESS, DAMPING, HOLD = range(5)

# Of a release, at the last forces and a step before.
MOMENT, MOMENT_BEFORE = 0, 1
STEPS = 2  # when it let go, in steps before the forces at which it did; else below zero
ENERGY, ENERGY_BEFORE = 3, 4
HOLDS = 5  # -1 while it holds, then 1
WORKS = 6  # of turn_kernels, of one that holds exactly
STATE = 8


class Releases(NamedTuple):
    """Arrays of all r releases (lanes: samples); what stands in `numbers` and `state` is told
    above."""

    hinge: np.ndarray  # (r,) index of its hinge
    turn: np.ndarray  # (r,) of its condition in turns.state; -1: it holds by a spring
    watch: np.ndarray  # (r,) of the hinge whose opening frees it; -1: none
    latch_row: np.ndarray  # (r,) of the latch whose catch frees it; -1: none
    latches: np.ndarray | None  # (l, n, lanes) Latches.state; None: none is watched
    numbers: np.ndarray  # (r, 5, lanes) s, rad, N m/rad, N m s/rad, rad
    rates: np.ndarray  # (r, 2, lanes) rate of the hinge (rad/s) in the last step, and 0
    state: np.ndarray  # (r, STATE, lanes) N m, steps, J
    openings: Openings  # of all hinges
    turns: Turns  # those held exactly
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (r, 1, lanes) energy of each (J)
    log: Log


@kernel
def steps_since_catch(states, row, timing, steps):
    """Return how many steps ago (lanes) latch `row` (-1: none) caught, if that is more than
    `steps`, else `steps`. states: Latches.state, or None."""
    if states is None:
        return steps
    if row >= 0:
        delay = timing.time - load(states, row, CATCH_TIME)
        is_free = 0.5 - load(states, row, IS_CAUGHT)
        steps = larger(steps, where_negative(is_free, delay / timing.step, -1.0))
    return steps


@kernel
def let_go(part, timing, i):
    """Return how many steps ago (lanes, with fractions) release i was due to let go: by its time, a
    latch's catch, or the watched opening; below 0: it is not due."""
    delay = timing.time - load(part.numbers, i, TIME)
    steps = where_negative(delay, -1.0, delay / timing.step)
    if part.watch[i] >= 0:
        level, angles = load(part.numbers, i, LEVEL), part.openings.angles
        new = load(angles, part.watch[i], NEW) - level
        old = load(angles, part.watch[i], OLD) - level
        sides = where_negative(new, -1.0, 1.0) * where_negative(old, -1.0, 1.0)
        steps = larger(steps, where_negative(sides, new / (new - old), -1.0))
    return steps_since_catch(part.latches, part.latch_row[i], timing, steps)


@hook(Releases)
def forces(part, world, timing):
    """Add the moments (N m) of releases that hold, and the rest of that of one that lets go."""
    for i in range(part.hinge.shape[0]):
        for k in (MOMENT, ENERGY):
            store(part.state, i, k + 1, load(part.state, i, k))
        h = part.hinge[i]
        psi = load(part.openings.angles, h, NEW)
        steps, hold = let_go(part, timing, i), load(part.state, i, HOLDS)
        if timing.time == 0.0:
            steps, hold = 0.0 * psi - 1.0, 0.0 * psi - 1.0
        steps = where_negative(hold, steps, -1.0)
        gap = load(part.numbers, i, HOLD) - psi
        change = psi - load(part.openings.angles, h, OLD)
        angle = gap + where_negative(steps, 0.0, steps) * change  # time of letting go, or now
        speed = follow_rate(part.openings, part.rates, i, h, timing)
        moment = load(part.numbers, i, STIFFNESS) * angle - load(part.numbers, i, DAMPING) * speed
        moment = moment * where_negative(steps, 1.0, 0.5 - steps)
        moment = where_negative(hold, moment, 0.0)
        if part.turn[i] >= 0:
            old_moment = load(part.state, i, WORKS + HOLD_MOMENT)
            moment = where_negative(steps, 0.0, (0.5 - steps) * old_moment)
            is_held = load(part.turns.state, part.turn[i], TURN_HOLDS)
            store(part.turns.state, part.turn[i], TURN_HOLDS, where_negative(steps, is_held, 1.0))
        hold = where_negative(hold, where_negative(steps, -1.0, 1.0), 1.0)
        energy = 0.5 * load(part.numbers, i, STIFFNESS) * gap * gap
        store(part.state, i, HOLDS, hold)
        store(part.state, i, STEPS, steps)
        store(part.state, i, MOMENT, moment)
        store(part.state, i, ENERGY, where_negative(hold, energy, 0.0))
        turn(part.openings, world.state, h, moment)


@hook(Releases)
def note_events(part, world, timing):
    """Note which releases let go (event 0) in the step, and when."""
    for i in range(part.hinge.shape[0]):
        steps = load(part.state, i, STEPS)
        if any_negative(where_negative(steps, 1.0, -1.0)):
            for s in range(part.state.shape[2]):
                if part.state[i, STEPS, s] >= 0.0:
                    note(part.log, s, timing.time - timing.step * part.state[i, STEPS, s], i, 0.0)


@hook(Releases)
def work_before(part, world, timing):
    loss = load(world.accounts, 0, part.account)
    for i in range(part.hinge.shape[0]):
        angles, h = part.openings.angles, part.hinge[i]
        if part.turn[i] >= 0:  # the other half follows (`work_after`)
            loss = loss - work_on(part.openings, h, load(part.state, i, WORKS + HOLD_MOMENT))
            continue
        moment = load(part.state, i, MOMENT) + load(part.state, i, MOMENT_BEFORE)
        work = 0.5 * (load(angles, h, NEW) - load(angles, h, OLD)) * moment
        loss = loss + (load(part.state, i, ENERGY_BEFORE) - load(part.state, i, ENERGY) - work)
    store(world.accounts, 0, part.account, loss)


@hook(Releases)
def work_after(part, world, timing):
    """Add half of the loss (J) of releases that hold exactly; `work_before` adds the rest."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            total = load(part.state, i, WORKS + HOLD_MOMENT) + load(part.state, i, MOMENT)
            store(part.state, i, WORKS + HOLD_MOMENT, total)


register_work_due(Releases, WORKS)


@hook(Releases)
def energy_of(part, world, i):
    return load(part.state, i, ENERGY)
