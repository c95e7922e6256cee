"""Moments, energies and events of releases (theory: release.py).

A kick at time t stands for the moment from half a step before t to half a step after. A release
within the step before t leaves a share between -1/2 and 1/2 of the moment to the kick at t: what
the kick before had too much is taken back. The motion then depends smoothly on the time of release.
"""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import follow_rate
from fpm.elements.openings.opening_kernels import BEFORE, NOW, Openings, turn
from fpm.kernels.events import note
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel, larger
from fpm.kernels.world import Log

# Constants of a release.
NUMBERS = "time", "level", "stiffness", "damping", "hold"
TIME, LEVEL, STIFFNESS, DAMPING, HOLD = range(5)

# Of a release, at the last forces and a step before.
MOMENT, MOMENT_BEFORE = 0, 1
AGO = 2  # when it let go, in steps before the forces at which it did; else below zero
ENERGY, ENERGY_BEFORE = 3, 4
HELD = 5  # -1 while it holds, then 1
STATE = 6


class Releases(NamedTuple):
    """on, watch (r,) hinges; numbers (r, 5, lanes); past (r, PAST, lanes); state (r, STATE,
    lanes); account: number of that of the loss; rows (r, 1, lanes).
    """

    on: np.ndarray
    watch: np.ndarray
    numbers: np.ndarray
    past: np.ndarray
    state: np.ndarray
    openings: Openings
    account: int
    rows: np.ndarray
    log: Log


@kernel
def let_go(part, timing, i):
    """How many steps ago release i was due to let go; below zero: not yet."""
    late = timing.time - load(part.numbers, i, TIME)
    ago = where_negative(late, -1.0, late / timing.step)
    if part.watch[i] >= 0:
        level, angles = load(part.numbers, i, LEVEL), part.openings.angles
        after = load(angles, part.watch[i], NOW) - level
        before = load(angles, part.watch[i], BEFORE) - level
        sides = where_negative(after, -1.0, 1.0) * where_negative(before, -1.0, 1.0)
        ago = larger(ago, where_negative(sides, after / (after - before), -1.0))
    return ago


@hook(Releases)
def forces(part, world, timing):
    """Moments of those that hold; of those that let go in this step, what is left of it."""
    for i in range(part.on.shape[0]):
        for k in (MOMENT, ENERGY):
            store(part.state, i, k + 1, load(part.state, i, k))
        h = part.on[i]
        psi = load(part.openings.angles, h, NOW)
        ago, held = let_go(part, timing, i), load(part.state, i, HELD)
        if timing.time == 0.0:
            ago, held = 0.0 * psi - 1.0, 0.0 * psi - 1.0
        ago = where_negative(held, ago, -1.0)
        off = load(part.numbers, i, HOLD) - psi
        way = psi - load(part.openings.angles, h, BEFORE)
        then = off + where_negative(ago, 0.0, ago) * way  # when it let go, or now
        speed = follow_rate(part.openings, part.past, i, h, timing)
        moment = load(part.numbers, i, STIFFNESS) * then - load(part.numbers, i, DAMPING) * speed
        moment = moment * where_negative(ago, 1.0, 0.5 - ago)
        moment = where_negative(held, moment, 0.0)
        held = where_negative(held, where_negative(ago, -1.0, 1.0), 1.0)
        energy = 0.5 * load(part.numbers, i, STIFFNESS) * off * off
        store(part.state, i, HELD, held)
        store(part.state, i, AGO, ago)
        store(part.state, i, MOMENT, moment)
        store(part.state, i, ENERGY, where_negative(held, energy, 0.0))
        turn(part.openings, world.state, h, moment)


@hook(Releases)
def note_events(part, world, timing):
    """Note those that let go in this step."""
    for i in range(part.on.shape[0]):
        ago = load(part.state, i, AGO)
        if any_negative(where_negative(ago, 1.0, -1.0)):
            for s in range(part.state.shape[2]):
                if part.state[i, AGO, s] >= 0.0:
                    note(part.log, s, timing.time - timing.step * part.state[i, AGO, s], i, 0.0)


@hook(Releases)
def work_before(part, world, timing):
    """What the dampers lost in the step up to now, and those that let go.

    That is what is no longer stored and was not done as work on the hinge either.
    """
    taken = load(world.accounts, 0, part.account)
    for i in range(part.on.shape[0]):
        moment = load(part.state, i, MOMENT) + load(part.state, i, MOMENT_BEFORE)
        angles, h = part.openings.angles, part.on[i]
        work = 0.5 * (load(angles, h, NOW) - load(angles, h, BEFORE)) * moment
        taken = taken + (load(part.state, i, ENERGY_BEFORE) - load(part.state, i, ENERGY) - work)
    store(world.accounts, 0, part.account, taken)


@hook(Releases)
def energy_of(part, world, i):
    """Energy of the spring of release i (J)."""
    return load(part.state, i, ENERGY)
