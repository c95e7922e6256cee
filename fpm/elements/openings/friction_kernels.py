"""Moments, energies and losses of friction (theory: friction.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.closure import mean_force
from fpm.elements.joints.joint_arrays import BRAKE as TURN_BRAKE
from fpm.elements.joints.joint_arrays import (
    FIRST_CHANGE,
    HOLDS,
    RATE,
    SOLVED_IMPULSE,
    TARGET,
    Turns,
)
from fpm.elements.joints.turn_kernels import (
    HOLD_MOMENT,
    add_late_moment,
    begin_loss,
    end_work_of,
    is_latched,
    moment_of,
    register_losses,
)
from fpm.elements.openings.losses_kernels import (
    LOSS,
    JointForce,
    add_loss,
    follow_rate,
    force_of,
    half_rate,
)
from fpm.elements.openings.losses_kernels import RATE as LAST
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, push, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.record import edge
from fpm.kernels.vectors import kernel, larger

STIFFNESS, BEND, DAMPING = range(3)
INVERSE_BEND = 3  # 1/bend where it goes with the force
FRICTION = 4  # moment of one that sticks exactly

ANGLE, SLOPE = 0, 1  # of a point: where, and by how much the slope of the bend changes there

FOOT = 0  # opening at which the bristle is straight
BENDING = 1  # by how much it is bent
MOST = 2  # and by how much it could be, where that goes with the joint's force
LEAST = 3  # the least that it was bent since it slipped,
BASE = 4  # and by how much it could be then
LOCK_RATIO = 5  # by how many times its bend it was bent on while that grew as much, at most
OLD_MOST = 6  # MOST a step before it,
FORCE_BEND = 7  # and by how much it could be by the joint's force as it came out with that
WORKS = 8  # of turn_kernels; it and those below: of what sticks exactly
SIGN = WORKS + 2  # sign of the rate at which it slips, or slipped last
BRAKE = SIGN + 1  # moment while it slips (N m)
LAST_BRAKE = BRAKE + 1  # the same as it was before the joints were solved
CHANGES_LEFT = LAST_BRAKE + 1  # how often it may change its mind in this step
STATE = CHANGES_LEFT + 1

PREVIOUS_RATE = LOSS  # of what sticks exactly, in `rates`

CHANGES = 5
"""How often it may change in a step: turn, stick, let go, stick again, and let go for good."""

STEEP = 0.5
"""By how much of a change of friction the force that the joint bears may change the other way, a
step later, before the next one is found by the secant of both."""


class Frictions(NamedTuple):
    """Arrays of all f friction elements (lanes: samples); what stands in `numbers` and `state` is
    told above."""

    hinge: np.ndarray  # (f,) index of its hinge
    turn: np.ndarray  # (f,) of its condition in turns.state; -1: it has a bristle
    numbers: np.ndarray  # (f, 5, lanes) N m/rad, rad, N m s/rad, 1/rad (else 0), N m
    openings: Openings  # of all hinges
    turns: Turns  # those held exactly
    rates: np.ndarray  # (f, 2, lanes) rad/s; and that before, or the damper's moment (N m)
    state: np.ndarray  # (f, STATE, lanes) rad, N m, J
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (f, 1, lanes) energy or self-locking of each
    peaks: np.ndarray  # (1, 1, lanes) largest self-locking
    start: np.ndarray | None = None  # (f + 1,) where the points of each begin,
    points: np.ndarray | None = None  # (p, 2, lanes), where the bend goes by a table: rad, 1/rad
    bearing: JointForce | None = None  # forces of joints, where they count


@kernel
def bend_at(points, start, i, most, psi):
    """Return the deflection (rad, lanes) at which element i slips at joint coordinate psi (rad).
    points, start: of Frictions, None: no tables; most: deflection (rad) below the table's first
    point."""
    if points is not None:
        for j in range(start[i], start[i + 1]):
            ramp = psi - load(points, j, ANGLE)
            most = most + load(points, j, SLOPE) * where_negative(ramp, 0.0, ramp)
    return most


@kernel
def bend_by_force(bearing, state, i, timing, resistance):
    """Return two deflections (rad) at which element i slips by the force of its joint: now and a
    step ago. state: Frictions.state, changed. Where friction relieves its own joint by more than
    itself (beyond self-locking), taking the force of the step before would grow from step to step;
    the secant of the last two steps finds the force that agrees with its own friction."""
    last = load(state, i, MOST)
    most = last
    if timing.time > 0.0:
        result = load(bearing.share, i, 0) * force_of(bearing, i, timing, resistance)
        change = last - load(state, i, OLD_MOST)
        answer = result - load(state, i, FORCE_BEND)
        steep = (answer + STEEP * change) * change  # < 0: the answer is steep, and the other way
        safe = where_negative(steep, change - answer, 1.0 + 0.0 * change)
        secant = last + (result - last) * change / safe
        most = where_negative(steep, secant, result)
        store(state, i, OLD_MOST, last)
        store(state, i, FORCE_BEND, result)
    store(state, i, MOST, most)
    return most, last


@kernel
def slip_deflections(bearing, part, i, psi, psi_before, timing, resistance):
    """Return two deflections (rad, lanes) at which element i slips, now and a step ago, by its own,
    its table at that coordinate (psi, psi_before, rad), and the joint's force. bearing: JointForce,
    None: none counts."""
    first = load(part.numbers, i, BEND)
    most = bend_at(part.points, part.start, i, first, psi)
    last = bend_at(part.points, part.start, i, first, psi_before)
    if bearing is not None:
        by_force = bend_by_force(bearing, part.state, i, timing, resistance)
        most, last = most + by_force[0], last + by_force[1]
    return most, last


@kernel
def watch_lock(part, i, bend, most, slips):
    """Measure self-locking of element i: how much its deflection `bend` grew without slip (slips:
    below 0 where it slips) while that at which it slips, `most` (rad), grew as fast, over that; it
    counts from the least `bend` since the last slip, once it was bent by one deflection more."""
    state, per_bend = part.state, load(part.numbers, i, INVERSE_BEND)
    size, least = absolute(bend), load(state, i, LEAST)
    least = where_negative(slips, size, where_negative(size - least, size, least))
    growth = size - least
    start = where_negative(slips, -1.0, per_bend * growth - 1.0)
    base = where_negative(start, most, load(state, i, BASE))
    lock = per_bend * where_negative(most - base - growth, 0.0, growth)
    store(state, i, LEAST, least)
    store(state, i, BASE, base)
    store(state, i, LOCK_RATIO, larger(load(state, i, LOCK_RATIO), lock))
    store(part.peaks, 0, 0, larger(load(part.peaks, 0, 0), lock))


@kernel
def slow_down(part, world, i, timing):
    """Add the moment (N m) of element i, which sticks exactly, where it slips."""
    h = part.hinge[i]
    if timing.time > 0.0:
        last, rate = load(part.rates, i, LAST), half_rate(part.openings, h, timing)
        if timing.time < 1.5 * timing.step:  # that half a step before the start, reflected
            last = 2.0 * last - rate
        store(part.rates, i, PREVIOUS_RATE, last)
        store(part.rates, i, LAST, rate)
    hold = load(part.turns.state, part.turn[i], HOLDS)
    moment = -1.0 * load(part.state, i, SIGN) * load(part.numbers, i, FRICTION)
    moment = where_negative(hold, 0.0, moment)
    moment = where_negative(is_latched(part.turns, h, part.turn[i]), 0.0, moment)
    store(part.state, i, BRAKE, moment)
    store(part.state, i, LAST_BRAKE, moment)
    store(part.state, i, CHANGES_LEFT, CHANGES)
    store(part.turns.state, part.turn[i], TURN_BRAKE, moment)
    turn(part.openings, world.state, h, moment)


@hook(Frictions)
def forces(part, world, timing):
    """Add the moments (N m) of bristles and dampers, and the losses (J) of slip and dampers.

    Where slip begins within a step, the mean of the moments at both ends differs from the mean over
    the way between. `edge` corrects it as for a spring that begins at the point of slip. From now
    on the time of an impact, part.turns.impact, counts from its start."""
    impact = load(part.turns.impact, 0, 0)
    store(part.turns.impact, 0, 0, where_negative(-1.0 * impact, impact - 1.0, 0.0))
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            slow_down(part, world, i, timing)
            continue
        h, last = part.hinge[i], load(part.state, i, BENDING)
        stiffness, foot = load(part.numbers, i, STIFFNESS), load(part.state, i, FOOT)
        psi, psi_before = load(part.openings.angles, h, NEW), load(part.openings.angles, h, OLD)
        most, old_most = slip_deflections(
            part.bearing, part, i, psi, psi_before, timing, world.resistance
        )
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        trial = psi - foot
        sign = where_negative(trial, -1.0, 0.0 * trial + 1.0)
        slips = most - absolute(trial)  # < 0 where it does
        bend = where_negative(slips, sign * most, trial)
        new_foot = where_negative(slips, psi - bend, foot)
        extra = -1.0 * stiffness * edge(-slips, sign * last - old_most)
        spring = -1.0 * (stiffness * bend + sign * extra)
        # The damper acts while it sticks; it never raises the moment above M.
        damper = -1.0 * load(part.numbers, i, DAMPING) * rate
        room = stiffness * most
        upper, lower = room - spring, -1.0 * room - spring
        damper = where_negative(upper - damper, upper, damper)
        damper = where_negative(damper - lower, lower, damper)
        # Where the damper helped to bear M in the step before, less is missing.
        gain = -0.5 * sign * load(part.rates, i, LOSS)
        gain = where_negative(gain, 0.0, gain)
        gain = where_negative(extra - gain, extra, gain)
        damper = where_negative(slips, sign * gain, damper)
        turn(part.openings, world.state, h, spring + damper)
        add_loss(world, part.account, part.openings, part.rates, i, h, damper)
        loss = 0.5 * stiffness * (most + old_most) * absolute(new_foot - foot)
        store(world.accounts, 0, part.account, load(world.accounts, 0, part.account) + loss)
        if part.bearing is not None:
            watch_lock(part, i, bend, most, slips)
        store(part.state, i, FOOT, new_foot)
        store(part.state, i, BENDING, bend)


@hook(Frictions)
def energy_of(part, world, i):
    bend = load(part.state, i, BENDING)
    return 0.5 * load(part.numbers, i, STIFFNESS) * bend * bend


@hook(Frictions)
def list_excess(part, world):
    """Store in part.rows how far each element has locked itself (`watch_lock`)."""
    for i in range(part.hinge.shape[0]):
        store(part.rows, i, 0, load(part.state, i, LOCK_RATIO))


register_losses(Frictions, WORKS)


@kernel
def stop_of(part, i, timing):
    """Find when the rate of element i reverses within this kick: return the fraction of the kick
    until it rests, and the angle (rad, at least 0) until then. A rate that fell before is
    extrapolated by the parabola of its motion; else braking starts in the middle of the kick."""
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


@hook(Frictions)
def decide(part, world, timing):
    """Let elements slip that would need more than their moment to stick, and reverse or stick those
    that come to rest. One that would reverse is braked until it rests and pushed the other way from
    then on; if it would not move back, it sticks. Each changes at most CHANGES times in a step, the
    last time to slip: no impulse that it holds is above its friction."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        latch_sign = is_latched(part.turns, part.hinge[i], part.turn[i])
        if any_negative(latch_sign):
            relieve(part, world, timing, i, latch_sign)
        t, changes = part.turn[i], load(part.state, i, CHANGES_LEFT)
        hold, sign = load(part.turns.state, t, HOLDS), load(part.state, i, SIGN)
        reserve = load(part.numbers, i, FRICTION) - absolute(
            find_holding_moment(part, world, i, timing)
        )
        speed = where_negative(hold, 1.0, sign * load(part.turns.state, t, RATE))
        is_first = changes - (CHANGES - 0.5)
        slips = where_negative(hold, reserve, 1.0)
        turns = where_negative(is_first, 1.0, speed)
        sticks = where_negative(is_first, where_negative(changes - 1.5, 1.0, speed), 1.0)
        slips = where_negative(latch_sign, 1.0, slips)
        turns = where_negative(latch_sign, 1.0, turns)
        sticks = where_negative(latch_sign, 1.0, sticks)
        if any_negative(slips) or any_negative(turns) or any_negative(sticks):
            change(part, world, timing, i, slips, turns, sticks)


@kernel
def relieve(part, world, timing, i, latch_sign):
    """Let element i bear nothing where `latch_sign` (lanes) is below 0, as a latch holds its joint
    from part.turns.impact on: in the kick of that step it brakes up to then, also where it turned
    after a share f of the kick and would have (1 - 2 f) of its moment."""
    t, old = part.turn[i], load(part.state, i, BRAKE)
    hold, changes = load(part.turns.state, t, HOLDS), load(part.state, i, CHANGES_LEFT)
    share, last = load(part.turns.impact, 0, 0), load(part.state, i, LAST_BRAKE)
    share = 2.0 * share if timing.time == 0.0 else 0.5 + share
    brake = share * where_negative(-absolute(last), last, old)
    has_turned = -absolute(last) * absolute(old - last)
    brake = where_negative(has_turned, (1.0 - share) * last - old, brake)
    is_new = where_negative(latch_sign, -0.5 - changes, 1.0)
    brake = where_negative(is_new, brake, old)
    if any_negative(-absolute(brake - old)) or any_negative(where_negative(is_new, hold, 1.0)):
        push(part.openings, world, part.hinge[i], (brake - old) / mean_force(world, timing))
        world.undecided[0] = 1
    store(part.state, i, BRAKE, brake)
    store(part.state, i, CHANGES_LEFT, where_negative(is_new, -1.0, changes))
    store(part.turns.state, t, HOLDS, where_negative(latch_sign, 1.0, hold))


@kernel
def find_holding_moment(part, world, i, timing):
    """Return the moment (N m) that holds element i, as last solved; 0 where it slips."""
    return mean_force(world, timing) * load(part.turns.state, part.turn[i], SOLVED_IMPULSE)


@kernel
def slip_moment(part, i, full, timing):
    """Return the moment (N m) of element i in the step in which it starts to slip: a mean of what
    held it and of the `full` moment (N m), which agree to first order for a load that grows; after
    an impact it makes up for what the kicks before and after lack."""
    if timing.time == 0.0:
        return full
    delay = load(part.turns.impact, 0, 0)
    mean = (0.5 - delay) * full + (0.5 + delay) * load(part.state, i, WORKS + HOLD_MOMENT)
    is_slip = -absolute(load(part.state, i, LAST_BRAKE))
    return where_negative(is_slip, full, mean)


@kernel
def change(part, world, timing, i, slips, turns, sticks):
    """Let element i slip, reverse or stick where `slips`, `turns` or `sticks` is below 0."""
    t, h, most = part.turn[i], part.hinge[i], load(part.numbers, i, FRICTION)
    old, last = load(part.state, i, SIGN), load(part.state, i, BRAKE)
    sign = where_negative(find_holding_moment(part, world, i, timing), -1.0, 1.0)
    fraction, path = stop_of(part, i, timing)
    brake = where_negative(slips, slip_moment(part, i, sign * most, timing), last)
    brake = where_negative(turns, (1.0 - 2.0 * fraction) * old * most, brake)
    brake = where_negative(sticks, 0.0, brake)
    push(part.openings, world, h, (brake - last) / mean_force(world, timing))
    store(part.state, i, BRAKE, brake)
    store(part.state, i, SIGN, where_negative(slips, -sign, where_negative(turns, -old, old)))
    hold = where_negative(slips, 1.0, load(part.turns.state, t, HOLDS))
    store(part.turns.state, t, HOLDS, where_negative(sticks, -1.0, hold))
    target = load(part.openings.angles, h, NEW) + old * path
    target = where_negative(turns, target, load(part.turns.state, t, TARGET))
    store(part.turns.state, t, TARGET, target)
    if timing.time == 0.0:
        mean = (target - load(part.openings.angles, h, NEW)) * (1.0 / timing.step)
        stop = load(part.turns.state, t, FIRST_CHANGE)
        stop = where_negative(sticks, mean - load(part.rates, i, LAST), stop)
        store(part.turns.state, t, FIRST_CHANGE, stop)
    is_change = where_negative(slips, -1.0, where_negative(turns, -1.0, sticks))
    changes, full = load(part.state, i, CHANGES_LEFT), load(part.turns.state, t, TURN_BRAKE)
    store(part.state, i, CHANGES_LEFT, where_negative(is_change, changes - 1.0, changes))
    full = where_negative(is_change, where_negative(turns, old * most, 0.0), full)
    store(part.turns.state, t, TURN_BRAKE, full)
    world.undecided[0] = 1


@hook(Frictions)
def work_after(part, world, timing):
    """Add half of the friction loss (J) in the step; `work_before` adds the rest."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        moment = load(part.state, i, BRAKE) + moment_of(part.turns, part.turn[i], timing, world)
        late_moment = moment - load(part.state, i, LAST_BRAKE)
        add_late_moment(part.openings.moments, part.openings, part.hinge[i], late_moment)
        end_work_of(part, world, i, moment, WORKS, -1.0)
        if timing.time == 0.0:
            begin_loss(part, world, timing, i, moment, WORKS)
