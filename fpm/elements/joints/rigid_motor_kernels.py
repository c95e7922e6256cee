"""Openings, moments and work of rigid motors (theory: rigid.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import TARGET, Turns
from fpm.elements.joints.turn_kernels import HOLD_FIELDS, HOLD_MOMENT, end_work, register_work_hooks
from fpm.elements.openings.opening_kernels import Openings
from fpm.kernels.curves import bend_after, travel_factor
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store

NUMBERS = "start", "turn"
START, TRAVEL = range(2)
TRACK = 1
WORKS = 0  # of turn_kernels
STATE = HOLD_FIELDS


class RigidMotors(NamedTuple):
    """Arrays of m rigid motors (lanes: samples), which prescribe joint coordinates exactly: start +
    factor times a curve, or, where by_rate (m,), times its integral over time. hinge (m,): index of
    its hinge; turn (m,): index of its condition in turns.state; curve (m,): of its curve, -1:
    constant 1; numbers (m, 2, lanes): start, factor (rad; m on slides; factor per second by rate);
    openings, turns: all joint coordinates, those held exactly; state (m, 2, lanes): moment (N m) at
    the last positions, work (J) of the half step up to them; account: index of the motors' work in
    World.accounts; track ((instants + 1) m, 1, lanes): recorded moments (N m)."""

    hinge: np.ndarray
    turn: np.ndarray
    curve: np.ndarray
    by_rate: np.ndarray
    numbers: np.ndarray
    openings: Openings
    turns: Turns
    state: np.ndarray
    account: int
    track: np.ndarray  # ((instants + 1) m, 1, lanes) recorded moment (N m)


@hook(RigidMotors)
def prepare(part, world, timing):
    """Store the joint coordinate (rad; m on slides) that each motor prescribes for the end of the
    step, as TARGET of its condition in part.turns.state; where its curve (not by rate) bends within
    the step, the bend's time is stored in part.turns.impact as a share of the step: the rate jumps
    there. part: RigidMotors; world: solver state, with the curves; timing: StepTime (s)."""
    for i in range(part.hinge.shape[0]):
        if not part.by_rate[i]:
            bend = bend_after(world, part.curve[i], timing.time)
            if bend < timing.step:
                store(part.turns.impact, 0, 0, bend / timing.step)
        distance = travel_factor(world, part.curve[i], part.by_rate[i], timing.time + timing.step)
        target = load(part.numbers, i, START) + distance * load(part.numbers, i, TRAVEL)
        store(part.turns.state, part.turn[i], TARGET, target)


register_work_hooks(RigidMotors, WORKS, 1.0)


@hook(RigidMotors)
def work_after(part, world, timing):
    """Add half of the work (J) of the motors' moments of this step, over the step that ends now, to
    part.account (`work_before` adds the rest). part: RigidMotors; world: World; timing: times."""
    end_work(part, world, timing, WORKS, 1.0)


@hook(RigidMotors)
def record_step(part, world, row, timing):
    """Record the moment (N m) of each motor in part.track. part: arrays of all rigid motors
    (RigidMotors); world, timing: not used; row: index of the recorded instant."""
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.state, i, WORKS + HOLD_MOMENT))
