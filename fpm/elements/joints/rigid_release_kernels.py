"""Moments, work and events of rigid releases (theory: rigid.py).

A release in the step before a kick leaves it a share of the moment held (release_kernels.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import HOLDS, Turns
from fpm.elements.joints.turn_kernels import HOLD_MOMENT, end_work, register_work_hooks
from fpm.elements.openings.opening_kernels import Openings, turn
from fpm.elements.openings.release_kernels import STEPS, let_go, note_events
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.world import Log

WORKS = 0  # of turn_kernels, up to STEPS, where all releases have it
REST_MOMENT = STEPS + 1  # moment that was left then (N m)
STATE = REST_MOMENT + 1

NUMBERS = "time", "level"  # which come first of all releases


class RigidReleases(NamedTuple):
    """Arrays of r rigid releases (lanes: samples). hinge, watch (r,): index of the hinge held, and
    of that watched (-1: none); latch_rows, latches, rigid_latches: as in Releases; turn (r,): index
    of its condition in turns.state; numbers (r, 2, lanes): time (s, inf: none), level (rad, m);
    openings, turns: all joint coordinates, and those held exactly; state (r, 4, lanes): last moment
    (N m), loss of the half step up to it (J), share of this step (0 to 1) since it let go, below 0:
    it did not in this step, moment for the time before that (N m); account: index of the loss in
    World.accounts; log: of events."""

    hinge: np.ndarray
    turn: np.ndarray
    watch: np.ndarray
    latch_rows: np.ndarray
    latches: np.ndarray | None
    rigid_latches: np.ndarray | None
    numbers: np.ndarray
    openings: Openings
    turns: Turns
    state: np.ndarray
    account: int
    log: Log


@hook(RigidReleases)
def forces(part, world, timing):
    """Free the joint coordinates whose release is due, and add to their particles the rest of the
    moment (N m) that held them, for the part of the step before it. part: arrays of all rigid
    releases (RigidReleases); world (World): solver state, changed; timing (StepTime): times (s)."""
    for i in range(part.hinge.shape[0]):
        t = part.turn[i]
        hold = load(part.turns.state, t, HOLDS)
        steps = let_go(part, timing, i)
        if timing.time == 0.0:
            steps = 0.0 * hold - 1.0
        steps = where_negative(hold, steps, -1.0)
        moment = (0.5 - steps) * load(part.state, i, WORKS + HOLD_MOMENT)
        moment = where_negative(steps, 0.0, moment)
        store(part.state, i, STEPS, steps)
        store(part.state, i, REST_MOMENT, moment)
        store(part.turns.state, t, HOLDS, where_negative(steps, hold, 1.0))
        turn(part.openings, world.state, part.hinge[i], moment)


hook(RigidReleases, "note_events")(note_events)


register_work_hooks(RigidReleases, WORKS, -1.0)


@hook(RigidReleases)
def work_after(part, world, timing):
    """Add half of the loss (J) of the moments found in this step, over the step that ends now, to
    account part.account of World; `work_before` adds the rest. part: all rigid releases
    (RigidReleases); world (World): solver state; timing: StepTime (s)."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.hinge.shape[0]):
        total = load(part.state, i, WORKS + HOLD_MOMENT) + load(part.state, i, REST_MOMENT)
        store(part.state, i, WORKS + HOLD_MOMENT, total)
