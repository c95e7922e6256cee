"""Sticking and slipping of friction without a bristle, and what it loses (rigid.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.closure import mean_force
from fpm.elements.joints.joint_arrays import HOLDS, RATE, SOLVED_IMPULSE, TARGET, Turns
from fpm.elements.joints.turn_kernels import (
    HOLD_FIELDS,
    HOLD_MOMENT,
    add_late_moment,
    end_work_of,
    moment_of,
    register_work_hooks,
)
from fpm.elements.openings.losses_kernels import LOSS as PREVIOUS_RATE  # which holds a rate here
from fpm.elements.openings.losses_kernels import RATE as LAST
from fpm.elements.openings.losses_kernels import half_rate
from fpm.elements.openings.opening_kernels import NEW, Openings, push, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel

WORKS = 0  # of turn_kernels
SIGN = WORKS + HOLD_FIELDS  # sign of the rate at which it slips, or slipped last
BRAKE = SIGN + 1  # moment while it slips (N m)
LAST_BRAKE = BRAKE + 1  # the same as it was before the joints were solved
CHANGES_LEFT = LAST_BRAKE + 1  # how often it may change its mind in this step
STATE = CHANGES_LEFT + 1

NUMBERS = ("moment",)

CHANGES = 5
"""How often it may change in a step: turn, stick, let go, stick again, and let go for good."""


class RigidFrictions(NamedTuple):
    """Arrays of f frictions that stick exactly (lanes: samples). hinge (f,): index of the hinge;
    turn (f,): index of its condition in turns.state; numbers (f, 1, lanes): friction moment (N m);
    openings, turns: all joint coordinates, and those held exactly; rates (f, 2, lanes): rates
    (rad/s) of the last two steps, the last first; state (f, 6, lanes): moment in the last step (N
    m), the half of its work (J) that was added to the account after an instant was recorded but is
    due before it, sign of the slip's rate, brake moment now and before the joints were solved (N
    m), changes left in this step; account: index of the loss in World.accounts."""

    hinge: np.ndarray
    turn: np.ndarray
    numbers: np.ndarray
    openings: Openings
    turns: Turns
    rates: np.ndarray
    state: np.ndarray
    account: int


@hook(RigidFrictions)
def forces(part, world, timing):
    """Add the friction moment (N m) of each element that slips to the particles of its hinge. part:
    arrays of all rigid frictions (RigidFrictions); world (World): solver state, changed; timing:
    StepTime (s). The time of an impact, part.turns.impact, then counts from its start."""
    impact = load(part.turns.impact, 0, 0)
    store(part.turns.impact, 0, 0, where_negative(-1.0 * impact, impact - 1.0, 0.0))
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        if timing.time > 0.0:
            store(part.rates, i, PREVIOUS_RATE, load(part.rates, i, LAST))
            store(part.rates, i, LAST, half_rate(part.openings, h, timing))
        hold = load(part.turns.state, part.turn[i], HOLDS)
        brake = -1.0 * load(part.state, i, SIGN) * load(part.numbers, i, 0)
        brake = where_negative(hold, 0.0, brake)
        store(part.state, i, BRAKE, brake)
        store(part.state, i, LAST_BRAKE, brake)
        store(part.state, i, CHANGES_LEFT, CHANGES)
        turn(part.openings, world.state, h, brake)


register_work_hooks(RigidFrictions, WORKS, -1.0)


@kernel
def stop_of(part, i, timing):
    """Return, for each lane where the rate of element i would reverse in this kick, the fraction of
    the kick until it comes to rest, and the angle (rad, at least 0) that it turns until then: by
    the parabola of its motion if its rate fell before, else as braked from the middle of the kick
    on. part: all rigid frictions (RigidFrictions); timing (StepTime): times of the step (s)."""
    sign = load(part.state, i, SIGN)
    last = sign * load(part.rates, i, LAST)
    last = where_negative(last, 0.0, last)
    fall = last - sign * load(part.turns.state, part.turn[i], RATE)
    old_fall = sign * load(part.rates, i, PREVIOUS_RATE) - last
    vertex = 0.5 * timing.step * (last - 0.5 * fall) * (last - 0.5 * fall) / fall
    jump = 0.5 * timing.kick * last * last / fall
    impact = old_fall - 0.5 * fall
    fraction = last / fall
    if timing.time > 0.0:
        fraction = where_negative(impact, 0.5 + load(part.turns.impact, 0, 0), fraction)
    return fraction, where_negative(-last, where_negative(impact, jump, vertex), 0.0)


@hook(RigidFrictions)
def decide(part, world, timing):
    """Let elements slip that would need more than their friction moment to stick, and reverse or
    stick those that come to rest; where any changes, sets world.undecided, and the joints are
    solved again. part: arrays of all rigid frictions (RigidFrictions); world (World): solver state;
    timing (StepTime): times (s). One that would reverse is braked until it rests and pushed the
    other way from then on; if it would not move back, it sticks. Each changes at most CHANGES times
    in a step, the last time to slip: no impulse that it holds is above its friction."""
    for i in range(part.hinge.shape[0]):
        t, changes = part.turn[i], load(part.state, i, CHANGES_LEFT)
        hold, sign = load(part.turns.state, t, HOLDS), load(part.state, i, SIGN)
        reserve = load(part.numbers, i, 0) - absolute(find_holding_moment(part, world, i, timing))
        speed = where_negative(hold, 1.0, sign * load(part.turns.state, t, RATE))
        is_first = changes - (CHANGES - 0.5)
        slips = where_negative(hold, reserve, 1.0)
        turns = where_negative(is_first, 1.0, speed)
        sticks = where_negative(is_first, where_negative(changes - 1.5, 1.0, speed), 1.0)
        if any_negative(slips) or any_negative(turns) or any_negative(sticks):
            change(part, world, timing, i, slips, turns, sticks)


@kernel
def find_holding_moment(part, world, i, timing):
    """Return the moment (N m) that holds element i in this step, as the joints were last solved; 0
    where it slips. part: all rigid frictions (RigidFrictions); world: solver state; timing:
    StepTime."""
    return mean_force(world, timing) * load(part.turns.state, part.turn[i], SOLVED_IMPULSE)


@kernel
def slip_moment(part, i, full, timing):
    """Return the moment (N m) of element i in the step in which it starts to slip: a mean of what
    held it and of the `full` friction moment (N m, with its sign), which agree to first order for a
    load that grows; after an impact it makes up for what the kicks before and after lack. part: all
    rigid frictions (RigidFrictions); timing (StepTime): times of the step (s)."""
    if timing.time == 0.0:
        return full
    delay = load(part.turns.impact, 0, 0)
    mean = (0.5 - delay) * full + (0.5 + delay) * load(part.state, i, WORKS + HOLD_MOMENT)
    is_slip = -absolute(load(part.state, i, LAST_BRAKE))
    return where_negative(is_slip, full, mean)


@kernel
def change(part, world, timing, i, slips, turns, sticks):
    """Let element i slip, reverse or stick in the lanes (samples) where `slips`, `turns` or
    `sticks` (lanes) is below 0, and set world.undecided to have the joints solved again. part: all
    rigid frictions (RigidFrictions); world (World): solver state; timing (StepTime): times (s)."""
    t, h, most = part.turn[i], part.hinge[i], load(part.numbers, i, 0)
    old, last = load(part.state, i, SIGN), load(part.state, i, BRAKE)
    sign = where_negative(find_holding_moment(part, world, i, timing), -1.0, 1.0)
    fraction, path = stop_of(part, i, timing)
    brake = where_negative(slips, slip_moment(part, i, sign * most, timing), last)
    brake = where_negative(turns, (1.0 - 2.0 * fraction) * old * most, brake)
    brake = where_negative(sticks, 0.0, brake)
    push(part.openings, world.state, h, (brake - last) / mean_force(world, timing))
    store(part.state, i, BRAKE, brake)
    store(part.state, i, SIGN, where_negative(slips, -sign, where_negative(turns, -old, old)))
    hold = where_negative(slips, 1.0, load(part.turns.state, t, HOLDS))
    store(part.turns.state, t, HOLDS, where_negative(sticks, -1.0, hold))
    target = load(part.openings.angles, h, NEW) + old * path
    target = where_negative(turns, target, load(part.turns.state, t, TARGET))
    store(part.turns.state, t, TARGET, target)
    is_change = where_negative(slips, -1.0, where_negative(turns, -1.0, sticks))
    changes = load(part.state, i, CHANGES_LEFT)
    store(part.state, i, CHANGES_LEFT, where_negative(is_change, changes - 1.0, changes))
    world.undecided[0] = 1


@hook(RigidFrictions)
def work_after(part, world, timing):
    """Add half of the friction loss (J) of the moments found in this step, over the step that ends
    now, to part.account in world.accounts (`work_before` adds the rest). part: all rigid frictions
    (RigidFrictions); world (World): solver state; timing: StepTime (s)."""
    for i in range(part.hinge.shape[0]):
        moment = load(part.state, i, BRAKE) + moment_of(part.turns, part.turn[i], timing, world)
        late_moment = moment - load(part.state, i, LAST_BRAKE)
        add_late_moment(part.openings.moments, part.openings, part.hinge[i], late_moment)
        end_work_of(part, world, i, moment, WORKS, -1.0)
