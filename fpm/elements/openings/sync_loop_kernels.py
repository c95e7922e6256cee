"""Moments, energies and events of synchronising loops (theory: sync_loop.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import dead_band
from fpm.elements.openings.opening_kernels import NEW, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, load, store, where_negative
from fpm.kernels.record import note_crossings
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

# Constants of a loop.
NUMBERS = "stiffness", "radii", "rest", "tight"
STIFFNESS, RADII, REST, TIGHT = 0, 1, 3, 5  # radii and rest of both hinges

# Of a loop, at the last forces and a step before.
SLIP = 0  # outside the backlash
SLACK, SLACK_BEFORE = 1, 2  # slip that is left before a strand gets slack
WHOLE, PULL_SLIP = 3, 4  # slip with the backlash; that by which the strands pull
STATE = 5

TRACK = 1

TOUCH = 1e-9
"""Turn (rad) of the pulleys below which a loop without preload has no events."""


class Loops(NamedTuple):
    """Arrays of all l synchronising loops (lanes: samples); what stands in `numbers` and `state` is
    told above."""

    hinge: np.ndarray  # (l, 2) indices of both hinges
    numbers: np.ndarray  # (l, 6, lanes) N/m, m (2), rad (2), m
    state: np.ndarray  # (l, STATE, lanes) m
    openings: Openings  # of all hinges
    rows: np.ndarray  # (l, 1, lanes) energy of each (J)
    log: Log
    track: np.ndarray  # ((instants + 1) l, TRACK, lanes) recorded pull (N)
    backlash: np.ndarray | None = None  # (l, 1, lanes) m


@kernel
def excess(part, i):
    """Return by how much (m, at least 0) loop i slips beyond where a strand turns slack."""
    slip = absolute(load(part.state, i, SLIP)) - load(part.numbers, i, TIGHT)
    return where_negative(slip, 0.0, slip)


@kernel
def pull(part, i):
    """Return the difference (N, lanes) of the tensions of loop i's strands, signed as the slip."""
    slip = load(part.state, i, PULL_SLIP)
    extra = excess(part, i)
    return load(part.numbers, i, STIFFNESS) * (slip - 0.5 * where_negative(slip, -extra, extra))


@hook(Loops)
def forces(part, world, timing):
    """Add the moments (N m) of loops on both hinges; store slip, and what is left to slack."""
    for i in range(part.hinge.shape[0]):
        angles = part.openings.angles
        h1, h2 = part.hinge[i, 0], part.hinge[i, 1]
        first, second = load(part.numbers, i, RADII), load(part.numbers, i, RADII + 1)
        angle = load(angles, h1, NEW) - load(part.numbers, i, REST)
        slip = first * angle - second * (load(angles, h2, NEW) - load(part.numbers, i, REST + 1))
        old = slip if timing.time == 0.0 else load(part.state, i, WHOLE)
        store(part.state, i, WHOLE, slip)
        slip, pull_slip = dead_band(part.backlash, i, slip, old)
        store(part.state, i, SLIP, slip)
        store(part.state, i, PULL_SLIP, pull_slip)
        store(part.state, i, SLACK_BEFORE, load(part.state, i, SLACK))
        touch = TOUCH * (absolute(first) + absolute(second))
        store(part.state, i, SLACK, load(part.numbers, i, TIGHT) + touch - absolute(slip))
        force = pull(part, i)
        turn(part.openings, world.state, h1, -1.0 * first * force)
        turn(part.openings, world.state, h2, second * force)


@hook(Loops)
def note_events(part, world, timing):
    """Note in which loops one strand turned slack (event 1) or both are tight again (0)."""
    for i in range(part.hinge.shape[0]):
        old, new = load(part.state, i, SLACK_BEFORE), load(part.state, i, SLACK)
        note_crossings(part.log, i, old, new, timing)


@hook(Loops)
def energy_of(part, world, i):
    slip, extra = load(part.state, i, SLIP), excess(part, i)
    return 0.5 * load(part.numbers, i, STIFFNESS) * (slip * slip - 0.5 * extra * extra)


@hook(Loops)
def record(part, world, row):
    """Record the difference of the strands' tensions (N), above 0 where the first turns farther."""
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, pull(part, i))
