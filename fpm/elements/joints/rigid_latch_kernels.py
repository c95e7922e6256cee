"""Catching, impulses, losses and events of rigid latches (theory: rigid.py)."""

import math
from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import HOLDS, RATE, TARGET, Turns
from fpm.elements.joints.turn_kernels import HOLD_FIELDS, end_work, moment_of, register_work_hooks
from fpm.elements.openings import latch_kernels as latch
from fpm.elements.openings.losses_kernels import RATE as LAST
from fpm.elements.openings.losses_kernels import half_rate
from fpm.elements.openings.opening_kernels import NEW, Openings
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

# State of a rigid latch, behind that of all latches.
WORKS = latch.STATE  # of turn_kernels
AGE = WORKS + HOLD_FIELDS  # steps in which it has held
IMPACT = AGE + 1  # impulse with which it caught
PREDICTION = IMPACT + 1  # opening that is foreseen for the end of this step
SEARCH_END = PREDICTION + 1  # opening up to which it has looked, as foreseen in the step before
STATE = SEARCH_END + 1

NUMBERS = latch.NUMBERS[:4]  # how it catches
SAME_TIME = 1e-9
"""Share of a step within which latches catch at one time."""

TRACK = 4  # recorded: as of all latches, and the impulse with which it caught


class RigidLatches(NamedTuple):
    """Arrays of l rigid latches (lanes: samples). hinge (l,): index of the hinge; turn (l,): index
    of its condition in turns.state; numbers (l, 4, lanes): angle, capture range (rad), sign of the
    rate at which it catches (0: both), largest rate (rad/s); openings, turns: all joint
    coordinates, and those held exactly; rates (l, 2, lanes): rate (rad/s) in the last step; state
    (l, 14, lanes): as Latches.state, then moment held (N m), its work due (J), steps held, impulse
    of the catch (N m s), coordinate foreseen at the step's end, coordinate searched so far (rad);
    account: index of the loss in World.accounts; log: of events; track ((instants + 1) l, 4,
    lanes): recorded moment (N m), impulse (N m s) so far, rate (rad/s) and impulse of the catch."""

    hinge: np.ndarray
    turn: np.ndarray
    numbers: np.ndarray
    openings: Openings
    turns: Turns
    rates: np.ndarray
    state: np.ndarray
    account: int
    log: Log
    track: np.ndarray  # ((instants + 1) l, TRACK, lanes)


hook(RigidLatches, "note_events")(latch.note_events)


register_work_hooks(RigidLatches, WORKS, -1.0)


@hook(RigidLatches)
def prepare(part, world, timing):
    """Store in part.rates the mean rates (rad/s; m/s on slides) of the latches' joint coordinates
    in the step that ended, before the next is solved; nothing at the start of a run. part: all
    rigid latches (RigidLatches); world: not used; timing (StepTime): times of the step (s)."""
    if timing.time > 0.0:
        for i in range(part.hinge.shape[0]):
            store(part.rates, i, LAST, half_rate(part.openings, part.hinge[i], timing))


@kernel
def predict(part, i, timing):
    """Return the joint coordinate (rad; m on slides) of latch i at the end of this step, by its
    rate as the joints were last solved. part: all latches (RigidLatches); timing: StepTime (s)."""
    rate = load(part.turns.state, part.turn[i], RATE)
    return load(part.openings.angles, part.hinge[i], NEW) + timing.step * rate


@hook(RigidLatches)
def decide(part, world, timing):
    """Catch the joint coordinates that would enter their capture range in this step; where any
    does, sets world.undecided, and the joints are solved again. part: RigidLatches; world (World):
    solver state; timing: StepTime (s). The search begins at the coordinate predicted in the step
    before, since the real one, which differs in its last digits, might slip through."""
    is_any_caught = False
    for i in range(part.hinge.shape[0]):
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
    which they are looked at again. part: RigidLatches; world: solver state (World); timing:
    StepTime (s); s: index of the sample (its lane)."""
    first, last = math.inf, timing.time  # those to come, and that which caught before
    for i in range(part.hinge.shape[0]):
        if part.state[i, latch.NEWS, s] == 1.0:
            time = part.state[i, latch.CATCH_TIME, s]
            if part.turns.state[part.turn[i], HOLDS, s] < 0:
                last = max(last, time)
            else:
                first = min(first, time)
    for i in range(part.hinge.shape[0]):
        t, time = part.turn[i], part.state[i, latch.CATCH_TIME, s]
        if part.state[i, latch.NEWS, s] == 0.0 or part.turns.state[t, HOLDS, s] < 0:
            continue
        if time > first + SAME_TIME * timing.step:
            part.state[i, latch.IS_CAUGHT, s] = part.state[i, latch.NEWS, s] = 0.0
        elif part.state[i, latch.IS_CAUGHT, s] > 0.0:
            time = part.state[i, latch.CATCH_TIME, s] = max(time, last)
            part.turns.state[t, HOLDS, s] = -1.0
            part.turns.state[t, TARGET, s] = part.state[i, latch.HOLD_ANGLE, s]
            part.turns.impact[0, 0, s] = (time - timing.time) / timing.step
            world.undecided[0] = 1


@hook(RigidLatches)
def work_after(part, world, timing):
    """Add half of the losses (J) of the moments found in this step, over the step that ends now, to
    part.account, and sum the impulses (N m s). The impulse of catching is that of three steps: two
    share it, and dampers extrapolate their rate into the third; less what the moment of the fourth
    gives in the time since. part: all rigid latches (RigidLatches); world (World): solver state;
    timing (StepTime): times (s)."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.hinge.shape[0]):
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


@hook(RigidLatches)
def record_step(part, world, row, timing):
    """Record of each latch its moment (N m), its impulse from the start to this instant (N m s),
    rate (rad/s) and impulse (N m s) of the catch in part.track. part: arrays of all rigid latches
    (RigidLatches); world: not used; row: index of the recorded instant; timing: StepTime (s)."""
    count = part.hinge.shape[0]
    for i in range(count):
        index, moment = row * count + i, load(part.state, i, latch.MOMENT)
        impulse = 0.5 * timing.step * moment  # of the kick from now on
        store(part.track, index, 0, moment)
        store(part.track, index, 1, load(part.state, i, latch.IMPULSE) - impulse)
        store(part.track, index, 2, load(part.state, i, latch.CATCH_RATE))
        store(part.track, index, 3, load(part.state, i, IMPACT))
