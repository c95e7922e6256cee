"""Catching, impulses, losses of latches that hold exactly (theory: latch.py)."""

import math

from fpm.elements.joints.joint_arrays import (
    BRAKE,
    FIRST_CHANGE,
    HOLDS,
    RATE,
    STOP_IMPULSE,
    STOPPED_RATE,
    TARGET,
)
from fpm.elements.joints.turn_kernels import begin_loss, end_work, moment_of, register_losses
from fpm.elements.openings import latch_kernels as latch
from fpm.elements.openings.latch_kernels import (
    AGE,
    BRAKE_MOMENT,
    CATCH_IMPULSE,
    CHANGE,
    FIRST_RATE,
    IMPACT,
    LEAD,
    PREDICTION,
    SEARCH_END,
    SEARCH_SHARE,
    WORKS,
    Latches,
)
from fpm.elements.openings.losses_kernels import RATE as LAST
from fpm.elements.openings.losses_kernels import half_rate
from fpm.elements.openings.opening_kernels import NEW
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel

SAME_TIME = 1e-9
"""Share of a step within which latches catch at one time."""

LATCH_HOLD = -2.0
"""HOLDS of what a latch holds: friction on the same joint bears nothing then."""

KNOWN_AGE = 9.0
"""Age of a latch whose impulse of the catch is known."""


register_losses(Latches, WORKS)


@hook(Latches)
def prepare(part, world, timing):
    """Store in part.rates the mean rates of the latches' joint coordinates in the step that ended,
    after the last catch in it, before the next is solved."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0 and timing.time > 0.0:
            share, rate = load(part.state, i, SEARCH_SHARE), load(part.rates, i, LAST)
            mean = half_rate(part.openings, part.hinge[i], timing)
            store(part.rates, i, LAST, where_negative(-share, rate, mean))
            store(part.state, i, LEAD, 0.5 - 0.5 * share)
            store(part.state, i, SEARCH_SHARE, 0.0 * share)


@kernel
def predict(part, i, timing):
    """Return the joint coordinate (rad; m) of latch i at the end of this step, as last solved;
    where it is held, that at which it is, without the error of the solution."""
    state, h = part.turns.state, part.hinge[i]
    end = load(part.openings.angles, h, NEW) + timing.step * load(state, part.turn[i], RATE)
    for t in range(part.turns.hinge.shape[0]):
        if part.turns.hinge[t] == h:
            end = where_negative(load(state, t, HOLDS), load(state, t, TARGET), end)
    return end


@hook(Latches)
def decide(part, world, timing):
    """Catch the joint coordinates that would enter their capture range in this step. The search
    begins at the coordinate predicted in the step before, since the real one, which differs in its
    last digits, might slip through; or, where another latch caught in this step, at that of its
    time: the path bends there."""
    is_any_caught = False
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        find_catch_impulse(part, world, i)
        start, prediction = load(part.state, i, SEARCH_END), predict(part, i, timing)
        store(part.state, i, PREDICTION, prediction)
        turns = part.turns.state
        mean = (prediction - start) * (1.0 / timing.step)
        latch.find_path(part, i, mean)
        store(part.state, i, BRAKE_MOMENT, 0.0 * mean)
        for neighbour in range(part.turns.hinge.shape[0]):
            if part.turns.hinge[neighbour] == part.hinge[i]:
                brake = load(part.state, i, BRAKE_MOMENT) + load(turns, neighbour, BRAKE)
                store(part.state, i, BRAKE_MOMENT, brake)
        reach = latch.reach_of(part, i, start, prediction, timing.step * load(part.rates, i, LAST))
        open_ = 0.5 - load(part.state, i, latch.IS_CAUGHT) - load(part.state, i, latch.NEWS)
        if any_negative(where_negative(open_, 1.0, reach)):
            for s in range(part.state.shape[2]):
                if part.state[i, latch.IS_CAUGHT, s] + part.state[i, latch.NEWS, s] == 0.0:
                    search(part, i, s, timing)
                    if part.state[i, latch.IS_CAUGHT, s] > 0.0:
                        if is_alone(part, i, s):
                            is_any_caught = True
                        else:
                            part.state[i, AGE, s] = KNOWN_AGE
    if is_any_caught:
        for s in range(part.state.shape[2]):
            hold_first(part, world, timing, s)


@kernel
def search(part, i, s, timing):
    """Find out whether latch i of sample s catches or misses in what is left of this step."""
    share, start = part.state[i, SEARCH_SHARE, s], part.state[i, SEARCH_END, s]
    time, span = timing.time + share * timing.step, max(1.0 - share, SAME_TIME) * timing.step
    if share > 0.0:
        part.state[i, FIRST_RATE, s] = (part.state[i, PREDICTION, s] - start) / span
        part.state[i, CHANGE, s] = 0.0
    if timing.time == 0.0 and share == 0.0:
        latch.catch_at_start(part, i, s, start, part.rates[i, LAST, s])
    if part.state[i, latch.NEWS, s] == 0.0:
        latch.follow_path(part, i, s, start, part.state[i, PREDICTION, s], time, span)


@kernel
def find_catch_impulse(part, world, i):
    """Store the impulse (N m s) by which latch i stopped its joint coordinate, where it is the last
    that caught in this step. part: Latches; world: World."""
    turns, impulse = part.turns.state, load(part.state, i, CATCH_IMPULSE)
    stop = load(turns, part.turn[i], STOPPED_RATE) * load(part.state, i, latch.CATCH_RATE)
    is_new = -1.0 * load(part.state, i, AGE) - absolute(impulse)
    is_new = where_negative(is_new, 1.0, -1.0 * absolute(stop))
    new = -1.0 * load(world.resistance, 0, 0) * load(turns, part.turn[i], STOP_IMPULSE)
    store(part.state, i, CATCH_IMPULSE, where_negative(is_new, new, impulse))


@kernel
def is_alone(part, i, s):
    """Return whether no other latch holds the joint coordinate of latch i of sample s, which then
    bears nothing."""
    result = True
    for t in range(part.turns.hinge.shape[0]):
        if part.turns.hinge[t] == part.hinge[i] and part.turns.state[t, HOLDS, s] == LATCH_HOLD:
            result = False
    return result


@kernel
def end_impact(part, i, s):
    """Take the impulse (N m s) of latch i of sample s, if it has just caught, as known, before
    another one catches."""
    if part.state[i, latch.IS_CAUGHT, s] > 0.0 and part.state[i, AGE, s] < 3.5:
        part.state[i, IMPACT, s] = part.state[i, CATCH_IMPULSE, s]
        part.state[i, AGE, s] = KNOWN_AGE


@kernel
def hold_first(part, world, timing, s):
    """Hold the coordinate of the latch of sample s that catches first in this step, or of several
    at that time, and forget what latches would do later: the impact changes the rates, by which
    they are looked at again. What those that caught just before bear of it is none of theirs."""
    first = math.inf
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        is_free = part.turns.state[part.turn[i], HOLDS, s] > 0
        if part.state[i, latch.NEWS, s] == 1.0 and is_free and is_alone(part, i, s):
            first = min(first, part.state[i, latch.CATCH_TIME, s])
    if first == math.inf:
        return
    share = (first - timing.time) / timing.step
    for i in range(part.hinge.shape[0]):
        t, time = part.turn[i], part.state[i, latch.CATCH_TIME, s]
        if t < 0:
            continue
        if part.turns.state[t, HOLDS, s] < 0:
            end_impact(part, i, s)
            part.turns.state[t, STOPPED_RATE, s] = 0.0
            continue
        if part.state[i, latch.NEWS, s] > 0.0 and time > first + SAME_TIME * timing.step:
            part.state[i, latch.IS_CAUGHT, s] = part.state[i, latch.NEWS, s] = 0.0
        if part.state[i, latch.IS_CAUGHT, s] > 0.0 and is_alone(part, i, s):
            part.turns.state[t, HOLDS, s] = LATCH_HOLD
            part.turns.state[t, TARGET, s] = part.state[i, latch.HOLD_ANGLE, s]
            rate = part.state[i, latch.CATCH_RATE, s]
            part.turns.state[t, STOPPED_RATE, s] = rate
            if timing.time == 0.0:
                angles, hold = part.openings.angles, part.state[i, latch.HOLD_ANGLE, s]
                mean = (hold - angles[part.hinge[i], NEW, s]) / timing.step
                part.turns.state[t, FIRST_CHANGE, s] = mean - part.rates[i, LAST, s]
            if rate == 0.0:
                part.state[i, AGE, s] = KNOWN_AGE  # no impact
            part.turns.impact[0, 0, s] = share
            world.undecided[0] = 1
        elif part.state[i, latch.IS_CAUGHT, s] > 0.0:
            part.state[i, AGE, s] = KNOWN_AGE
        else:
            last_share = part.state[i, SEARCH_SHARE, s]
            if last_share < 1.0:
                part_of_rest = (share - last_share) / (1.0 - last_share)
                mean = part.state[i, FIRST_RATE, s] + 0.5 * part_of_rest * part.state[i, CHANGE, s]
                if last_share > 0.0:
                    rest = part.state[i, PREDICTION, s] - part.state[i, SEARCH_END, s]
                    mean = rest / ((1.0 - last_share) * timing.step)
                part.state[i, SEARCH_END, s] += (share - last_share) * timing.step * mean
            part.state[i, SEARCH_SHARE, s] = share


@kernel
def ends_at_turn(part, i):
    """Return where (lanes, below 0) the search for latch i goes on in the next step from where its
    coordinate turned back in this one: friction, which stops in the second half of a step, turns or
    holds in the next."""
    first = load(part.state, i, FIRST_RATE)
    turns = first * (first + load(part.state, i, CHANGE))
    turns = where_negative(turns, first * load(part.state, i, BRAKE_MOMENT), 1.0)
    return where_negative(-1.0 * load(part.state, i, SEARCH_SHARE), 1.0, turns)


@hook(Latches)
def work_after(part, world, timing):
    """Add half of the losses (J) of the moments found in this step, and sum the impulses (N m s).
    The impulse of catching is that of three steps: two share it, and dampers extrapolate their rate
    into the third; less what the moment of the fourth gives in the time since."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        moment = moment_of(part.turns, part.turn[i], timing, world)
        if timing.time == 0.0:
            begin_loss(part, world, timing, i, moment, WORKS)
        impulse = timing.kick * moment
        store(part.state, i, latch.MOMENT, moment)
        store(part.state, i, latch.IMPULSE, load(part.state, i, latch.IMPULSE) + impulse)
        age = load(part.state, i, AGE) + load(part.state, i, latch.IS_CAUGHT)
        store(part.state, i, AGE, age)
        end, rest = predict(part, i, timing), 1.0 - load(part.state, i, SEARCH_SHARE)
        rest = where_negative(rest - SAME_TIME, SAME_TIME, rest)
        rate = (end - load(part.state, i, SEARCH_END)) / (timing.step * rest)
        turns = ends_at_turn(part, i)
        first, change = load(part.state, i, FIRST_RATE), load(part.state, i, CHANGE)
        share = -1.0 * first / change
        vertex = load(part.state, i, SEARCH_END) + 0.5 * timing.step * share * first
        store(part.rates, i, LAST, where_negative(turns, 0.0, rate))
        store(part.state, i, SEARCH_END, where_negative(turns, vertex, end))
        share = where_negative(turns, 2.0 * share - 1.0, load(part.state, i, SEARCH_SHARE))
        store(part.state, i, SEARCH_SHARE, share)
        time = timing.time - 0.5 * timing.step - load(part.state, i, latch.CATCH_TIME)
        impact = where_negative(age - 3.5, impulse, -1.0 * time * moment)
        impact = where_negative(age - 4.5, impact, 0.0)
        store(part.state, i, IMPACT, load(part.state, i, IMPACT) + impact)


@hook(Latches)
def record_step(part, world, row, timing):
    count = part.hinge.shape[0]
    for i in range(count):
        if part.turn[i] < 0:
            continue
        index, moment = row * count + i, load(part.state, i, latch.MOMENT)
        impulse = 0.5 * timing.step * moment  # of the kick from now on
        store(part.track, index, 0, moment)
        store(part.track, index, 1, load(part.state, i, latch.IMPULSE) - impulse)
        store(part.track, index, 2, load(part.state, i, latch.CATCH_RATE))
        impact, first = load(part.state, i, IMPACT), load(part.state, i, CATCH_IMPULSE)
        store(part.track, index, 3, where_negative(load(part.state, i, AGE) - 3.5, first, impact))
