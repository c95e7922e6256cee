"""Moments, energies and events of synchronising loops (theory: sync_loop.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NOW, Openings, turn
from fpm.kernels.events import note_crossing
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

# Constants of a loop.
NUMBERS = "stiffness", "radii", "rest", "tight"
STIFFNESS, RADII, REST, TIGHT = 0, 1, 3, 5  # radii and rest of both hinges

# Of a loop, at the last forces and a step before.
SLIP = 0
LEFT, LEFT_BEFORE = 1, 2  # slip that is left before a strand gets slack
STATE = 3

TRACK = 1

TOUCH = 1e-9
"""Turn (rad) of the pulleys below which a loop without preload has no events."""


class Loops(NamedTuple):
    """on (l, 2) hinges; numbers (l, 6, lanes); state (l, STATE, lanes); rows (l, 1, lanes);
    track ((instants + 1) l, 1, lanes) recorded pull (N).
    """

    on: np.ndarray
    numbers: np.ndarray
    state: np.ndarray
    openings: Openings
    rows: np.ndarray
    log: Log
    track: np.ndarray


@kernel
def beyond(part, i):
    """By how much the slip of loop i is beyond that at which a strand gets slack (m), or zero."""
    over = absolute(load(part.state, i, SLIP)) - load(part.numbers, i, TIGHT)
    return where_negative(over, 0.0, over)


@kernel
def pull(part, i):
    """Difference of the tensions of both strands of loop i (N), with the sign of the slip."""
    slip = load(part.state, i, SLIP)
    over = beyond(part, i)
    return load(part.numbers, i, STIFFNESS) * (slip - 0.5 * where_negative(slip, -over, over))


@hook(Loops)
def forces(part, world, timing):
    """Moments on both hinges that take the slip back."""
    for i in range(part.on.shape[0]):
        angles = part.openings.angles
        one, two = part.on[i, 0], part.on[i, 1]
        first, second = load(part.numbers, i, RADII), load(part.numbers, i, RADII + 1)
        off = load(angles, one, NOW) - load(part.numbers, i, REST)
        slip = first * off - second * (load(angles, two, NOW) - load(part.numbers, i, REST + 1))
        store(part.state, i, SLIP, slip)
        store(part.state, i, LEFT_BEFORE, load(part.state, i, LEFT))
        touch = TOUCH * (absolute(first) + absolute(second))
        store(part.state, i, LEFT, load(part.numbers, i, TIGHT) + touch - absolute(slip))
        force = pull(part, i)
        turn(part.openings, world.state, one, -1.0 * first * force)
        turn(part.openings, world.state, two, second * force)


@hook(Loops)
def note_events(part, world, timing):
    """Note the loops of which a strand turned slack, or both are tight again."""
    for i in range(part.on.shape[0]):
        after = where_negative(load(part.state, i, LEFT), -1.0, 1.0)
        before = where_negative(load(part.state, i, LEFT_BEFORE), -1.0, 1.0)
        if any_negative(after * before):
            for s in range(part.state.shape[2]):
                last, this = part.state[i, LEFT_BEFORE, s], part.state[i, LEFT, s]
                note_crossing(part.log, s, i, last, this, timing)


@hook(Loops)
def energy_of(part, world, i):
    """Energy of loop i (J)."""
    slip, over = load(part.state, i, SLIP), beyond(part, i)
    return 0.5 * load(part.numbers, i, STIFFNESS) * (slip * slip - 0.5 * over * over)


@hook(Loops)
def record(part, world, row):
    """The pulls."""
    count = part.on.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, pull(part, i))
