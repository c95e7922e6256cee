"""Moments, energies and work of motors that prescribe openings (theory: motor.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import TARGET as TURN_TARGET
from fpm.elements.joints.joint_arrays import Turns
from fpm.elements.joints.turn_kernels import HOLD_MOMENT, end_work, register_work_due, work_on
from fpm.elements.openings.losses_kernels import dead_band, follow_rate, onset
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.curves import bend_after, travel_factor, travel_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.vectors import kernel

# Constants of a motor.
NUMBERS = "stiffness", "damping", "start", "turn"
STIFFNESS, DAMPING, START, TURN = range(4)

# Of a motor, at the last forces and a step before.
MOMENT, MOMENT_BEFORE = 0, 1
VISCOUS, VISCOUS_BEFORE = 2, 3  # its part by damping
ERROR = 4  # target less opening,
ADVANCE = 5  # of the target over the last step
TARGET = 6
EXCESS = 7  # of the error outside the backlash
AT_INSTANT = 8  # moment at the instant of the last forces
WORKS = 9  # of turn_kernels, of one that holds exactly
STATE = 11

TRACK = 1


class Motors(NamedTuple):
    """Arrays of all m motors (lanes: samples); what stands in `numbers` and `state` is told
    above."""

    hinge: np.ndarray  # (m,) index of its hinge
    turn: np.ndarray  # (m,) of its condition in turns.state; -1: it has a drive train
    curve: np.ndarray  # (m,) of its curve of time; -1: constant 1
    by_rate: np.ndarray  # (m,) 1 where the curve gives the rate
    numbers: np.ndarray  # (m, 4, lanes) N m/rad, N m s/rad, rad, rad
    rates: np.ndarray  # (m, 2, lanes) first: rate of the last step (rad/s)
    state: np.ndarray  # (m, STATE, lanes) N m and rad, with the mean target over a kick
    openings: Openings  # of all hinges
    turns: Turns  # those held exactly
    account: int  # index of their work in World.accounts
    loss_account: int  # and of the loss in drive trains
    rows: np.ndarray  # (m, 1, lanes) energy of each (J)
    track: np.ndarray  # ((instants + 1) m, 1, lanes) recorded moment (N m)
    backlash: np.ndarray | None = None  # (m, 1, lanes) rad


@kernel
def grip(backlash, i, viscous, spring, error, old):
    """Return what of the moment `viscous` (N m) of a drive train's damper acts: 0 within its
    backlash, and no more against its `spring` (N m) than that has, so that teeth never pull.
    backlash: Motors.backlash; error, old: target less opening now and a step ago (rad)."""
    if backlash is not None:
        half = 0.5 * load(backlash, i, 0)
        sign = where_negative(error, -1.0, 1.0)
        damper = sign * viscous * onset(sign * error - half, sign * old - half)
        bound = sign * spring
        damper = where_negative(damper + bound, -bound, damper)
        damper = where_negative(-bound, sign * damper, 0.0)
        viscous = where_negative(-half, damper, viscous)
    return viscous


@hook(Motors)
def forces(part, world, timing):
    """Add the moments (N m) of the motors' drive trains; keep moments and targets in part.state."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            continue
        h = part.hinge[i]
        for k in (MOMENT, VISCOUS):
            store(part.state, i, k + 1, load(part.state, i, k))
        curve, by_rate = part.curve[i], part.by_rate[i]
        mean = travel_mean(world, curve, by_rate, timing)
        target = load(part.numbers, i, START) + mean * load(part.numbers, i, TURN)
        lead = travel_factor(world, curve, by_rate, timing.time) - mean
        lead = lead * load(part.numbers, i, TURN)  # of the instant before its mean
        error = target - load(part.openings.angles, h, NEW)
        advance = target - load(part.state, i, TARGET)
        if timing.time == 0.0:
            advance = 0.0 * error
        # The target's rate as the opening's: what it lacks at the start, the step after makes up.
        target_rate = (1.0 / timing.step) * (1.5 * advance - 0.5 * load(part.state, i, ADVANCE))
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        viscous = load(part.numbers, i, DAMPING) * (target_rate - rate)
        stiffness, old = load(part.numbers, i, STIFFNESS), load(part.state, i, ERROR)
        old = error if timing.time == 0.0 else old
        excess, force_excess = dead_band(part.backlash, i, error, old)
        viscous = grip(part.backlash, i, viscous, stiffness * excess, error, old)
        moment = stiffness * force_excess + viscous
        _, excess_now = dead_band(part.backlash, i, error + lead, old)
        store(part.state, i, AT_INSTANT, stiffness * excess_now + viscous)
        if timing.time == 0.0:
            advance = 2.0 * lead  # so that the rate in the next kick makes up for it
        store(part.state, i, EXCESS, excess)
        store(part.state, i, ERROR, error)
        store(part.state, i, ADVANCE, advance)
        store(part.state, i, TARGET, target)
        store(part.state, i, MOMENT, moment)
        store(part.state, i, VISCOUS, viscous)
        turn(part.openings, world.state, h, moment)


@hook(Motors)
def work_before(part, world, timing):
    """Add the work (J) of the motors, and the losses of their drive trains: means of the moments at
    both ends times the way, as they do on the hinges, so that the balance has no error."""
    work = load(world.accounts, 0, part.account)
    loss = load(world.accounts, 0, part.loss_account)
    for i in range(part.hinge.shape[0]):
        advance, h = load(part.state, i, ADVANCE), part.hinge[i]
        if part.turn[i] >= 0:  # the other half follows (`work_after`)
            work = work + work_on(part.openings, h, load(part.state, i, WORKS + HOLD_MOMENT))
            continue
        angle = load(part.openings.angles, h, NEW) - load(part.openings.angles, h, OLD)
        moment = load(part.state, i, MOMENT) + load(part.state, i, MOMENT_BEFORE)
        work = work + 0.5 * advance * moment
        viscous = load(part.state, i, VISCOUS) + load(part.state, i, VISCOUS_BEFORE)
        loss = loss + 0.5 * (advance - angle) * viscous
    store(world.accounts, 0, part.account, work)
    store(world.accounts, 0, part.loss_account, loss)


@hook(Motors)
def prepare(part, world, timing):
    """Store the joint coordinate (rad; m) that a motor prescribes exactly for the end of the step,
    as TARGET of its condition; where its curve (not by rate) bends within the step, the rate jumps:
    the bend's time, as a share of the step, is part.turns.impact."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        if not part.by_rate[i]:
            bend = bend_after(world, part.curve[i], timing.time)
            if bend < timing.step:
                store(part.turns.impact, 0, 0, bend / timing.step)
        distance = travel_factor(world, part.curve[i], part.by_rate[i], timing.time + timing.step)
        target = load(part.numbers, i, START) + distance * load(part.numbers, i, TURN)
        store(part.turns.state, part.turn[i], TURN_TARGET, target)


@hook(Motors)
def work_after(part, world, timing):
    """Add half of the work (J) of moments that prescribe exactly; `work_before` adds the rest."""
    end_work(part, world, timing, WORKS, 1.0)


register_work_due(Motors, WORKS)


@hook(Motors)
def energy_of(part, world, i):
    excess = load(part.state, i, EXCESS)
    return 0.5 * load(part.numbers, i, STIFFNESS) * excess * excess


@hook(Motors)
def record(part, world, row):
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.state, i, AT_INSTANT))


@hook(Motors)
def record_step(part, world, row, timing):
    count = part.hinge.shape[0]
    for i in range(count):
        if part.turn[i] >= 0:
            moment = load(part.state, i, WORKS + HOLD_MOMENT)
            store(part.track, row * count + i, 0, moment)
