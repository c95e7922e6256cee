"""Moments, work and events of rigid releases (theory: rigid.py).

A release within the step before a kick leaves to it a share of the moment that held (see
release_kernels.py).
"""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import HOLDS, Turns
from fpm.elements.joints.turn_kernels import HELD_BY, account, end_work
from fpm.elements.openings.opening_kernels import Openings, turn
from fpm.elements.openings.release_kernels import AGO, let_go, note_events
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.world import Log

WORKS = 0  # of turn_kernels, up to AGO, where all releases have it
LEFT = AGO + 1  # moment that was left then (N m)
STATE = LEFT + 1

NUMBERS = "time", "level"  # which come first of all releases


class RigidReleases(NamedTuple):
    """on, turn, watch (r,); numbers (r, 2, lanes); state (r, STATE, lanes)."""

    on: np.ndarray
    turn: np.ndarray
    watch: np.ndarray
    numbers: np.ndarray
    openings: Openings
    turns: Turns
    state: np.ndarray
    account: int
    log: Log


@hook(RigidReleases)
def forces(part, world, timing):
    """Let go where it is due; what is left of the moment then."""
    for i in range(part.on.shape[0]):
        t = part.turn[i]
        held = load(part.turns.state, t, HOLDS)
        ago = let_go(part, timing, i)
        if timing.time == 0.0:
            ago = 0.0 * held - 1.0
        ago = where_negative(held, ago, -1.0)
        left = (0.5 - ago) * load(part.state, i, WORKS + HELD_BY)
        left = where_negative(ago, 0.0, left)
        store(part.state, i, AGO, ago)
        store(part.state, i, LEFT, left)
        store(part.turns.state, t, HOLDS, where_negative(ago, held, 1.0))
        turn(part.openings, world.state, part.on[i], left)


hook(RigidReleases, "note_events")(note_events)


account(RigidReleases, WORKS, -1.0)


@hook(RigidReleases)
def work_after(part, world, timing):
    """The same by the impulses of this step."""
    end_work(part, world, timing, WORKS, -1.0)
    for i in range(part.on.shape[0]):
        both = load(part.state, i, WORKS + HELD_BY) + load(part.state, i, LEFT)
        store(part.state, i, WORKS + HELD_BY, both)
