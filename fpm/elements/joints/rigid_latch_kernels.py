"""Catching, impulses, losses of latches that hold exactly (theory: latch.py)."""

import math

from fpm.elements.joints.joint_arrays import HOLDS, RATE, TARGET
from fpm.elements.joints.turn_kernels import end_work, moment_of, register_losses
from fpm.elements.openings import latch_kernels as latch
from fpm.elements.openings.latch_kernels import (
    AGE,
    IMPACT,
    PREDICTION,
    SEARCH_END,
    WORKS,
    Latches,
)
from fpm.elements.openings.losses_kernels import RATE as LAST
from fpm.elements.openings.losses_kernels import half_rate
from fpm.elements.openings.opening_kernels import NEW
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel

SAME_TIME = 1e-9
"""Share of a step within which latches catch at one time."""


register_losses(Latches, WORKS)


@hook(Latches)
def prepare(part, world, timing):
    """Store in part.rates the mean rates (rad/s; m/s on slides) of the latches' joint coordinates
    in the step that ended, before the next is solved; nothing at the start of a run. part: all
    rigid latches (Latches); world: not used; timing (StepTime): times of the step (s)."""
    if timing.time > 0.0:
        for i in range(part.hinge.shape[0]):
            if part.turn[i] >= 0:
                store(part.rates, i, LAST, half_rate(part.openings, part.hinge[i], timing))


@kernel
def predict(part, i, timing):
    """Return the joint coordinate (rad; m on slides) of latch i at the end of this step, by its
    rate as the joints were last solved. part: all latches (Latches); timing: StepTime (s)."""
    rate = load(part.turns.state, part.turn[i], RATE)
    return load(part.openings.angles, part.hinge[i], NEW) + timing.step * rate


@hook(Latches)
def decide(part, world, timing):
    """Catch the joint coordinates that would enter their capture range in this step; where any
    does, sets world.undecided, and the joints are solved again. part: Latches; world (World):
    solver state; timing: StepTime (s). The search begins at the coordinate predicted in the step
    before, since the real one, which differs in its last digits, might slip through."""
    is_any_caught = False
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        start, prediction = load(part.state, i, SEARCH_END), predict(part, i, timing)
        store(part.state, i, PREDICTION, prediction)
        reach = latch.reach_of(part, i, start, prediction)
        open_ = 0.5 - load(part.state, i, latch.IS_CAUGHT) - load(part.state, i, latch.NEWS)
        if any_negative(where_negative(open_, 1.0, reach)):
            end = timing.time + timing.step
            for s in range(part.state.shape[2]):
                if part.state[i, latch.IS_CAUGHT, s] + part.state[i, latch.NEWS, s] == 0.0:
                    first, last = part.state[i, SEARCH_END, s], part.state[i, PREDICTION, s]
                    rate = part.rates[i, LAST, s]
                    if timing.time == 0.0:
                        latch.pass_by(part, i, s, first, first, rate, 0.0, timing.step)
                    if part.state[i, latch.IS_CAUGHT, s] + part.state[i, latch.NEWS, s] == 0.0:
                        latch.pass_by(part, i, s, first, last, rate, end, timing.step)
                    if part.state[i, latch.IS_CAUGHT, s] > 0.0:
                        is_any_caught = True
    if is_any_caught:
        for s in range(part.state.shape[2]):
            hold_first(part, world, timing, s)


@kernel
def hold_first(part, world, timing, s):
    """Hold the joint coordinate of the latch of one sample that catches first in this step, or of
    several at that time, and forget what latches would do later: the impact changes the rates, by
    which they are looked at again. part: Latches; world: solver state (World); timing:
    StepTime (s); s: index of the sample (its lane)."""
    first, last = math.inf, timing.time  # those to come, and that which caught before
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0 and part.state[i, latch.NEWS, s] == 1.0:
            time = part.state[i, latch.CATCH_TIME, s]
            if part.turns.state[part.turn[i], HOLDS, s] < 0:
                last = max(last, time)
            else:
                first = min(first, time)
    for i in range(part.hinge.shape[0]):
        t, time = part.turn[i], part.state[i, latch.CATCH_TIME, s]
        if t < 0 or part.state[i, latch.NEWS, s] == 0.0 or part.turns.state[t, HOLDS, s] < 0:
            continue
        if time > first + SAME_TIME * timing.step:
            part.state[i, latch.IS_CAUGHT, s] = part.state[i, latch.NEWS, s] = 0.0
        elif part.state[i, latch.IS_CAUGHT, s] > 0.0:
            time = part.state[i, latch.CATCH_TIME, s] = max(time, last)
            part.turns.state[t, HOLDS, s] = -1.0
            part.turns.state[t, TARGET, s] = part.state[i, latch.HOLD_ANGLE, s]
            part.turns.impact[0, 0, s] = (time - timing.time) / timing.step
            world.undecided[0] = 1


@hook(Latches)
def work_after(part, world, timing):
    """Add half of the losses (J) of the moments found in this step, over the step that ends now, to
    part.account, and sum the impulses (N m s). The impulse of catching is that of three steps: two
    share it, and dampers extrapolate their rate into the third; less what the moment of the fourth
    gives in the time since. part: all latches (Latches); world (World): solver state;
    timing (StepTime): times (s)."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.hinge.shape[0]):
        if part.turn[i] < 0:
            continue
        moment = moment_of(part.turns, part.turn[i], timing, world)
        impulse = timing.kick * moment
        store(part.state, i, latch.MOMENT, moment)
        store(part.state, i, latch.IMPULSE, load(part.state, i, latch.IMPULSE) + impulse)
        age = load(part.state, i, AGE) + load(part.state, i, latch.IS_CAUGHT)
        store(part.state, i, AGE, age)
        store(part.state, i, SEARCH_END, predict(part, i, timing))
        time = timing.time - 0.5 * timing.step - load(part.state, i, latch.CATCH_TIME)
        impact = where_negative(age - 3.5, impulse, -1.0 * time * moment)
        impact = where_negative(age - 4.5, impact, 0.0)
        store(part.state, i, IMPACT, load(part.state, i, IMPACT) + impact)


@hook(Latches)
def record_step(part, world, row, timing):
    """Record of each latch its moment (N m), its impulse from the start to this instant (N m s),
    rate (rad/s) and impulse (N m s) of the catch in part.track. part: arrays of all rigid latches
    (Latches); world: not used; row: index of the recorded instant; timing: StepTime (s)."""
    count = part.hinge.shape[0]
    for i in range(count):
        if part.turn[i] < 0:
            continue
        index, moment = row * count + i, load(part.state, i, latch.MOMENT)
        impulse = 0.5 * timing.step * moment  # of the kick from now on
        store(part.track, index, 0, moment)
        store(part.track, index, 1, load(part.state, i, latch.IMPULSE) - impulse)
        store(part.track, index, 2, load(part.state, i, latch.CATCH_RATE))
        store(part.track, index, 3, load(part.state, i, IMPACT))
