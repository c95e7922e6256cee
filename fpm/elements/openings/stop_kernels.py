"""Moments, energies, losses and events of stops and face-to-face contacts."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import add_loss, follow_rate, press
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, where_negative
from fpm.kernels.record import note_crossings
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

NUMBERS = "angle", "side", "stiffness", "damping"
ANGLE, SIDE, STIFFNESS, DAMPING = range(4)

TOUCH = 1e-9
"""Overlap (rad) from which a stop is hit: one that is just touched at rest has no events. What
hinges leave open is below it; faces that meet at 1 rad/s reach it within 1 ns."""


class Stops(NamedTuple):
    """Arrays of all s stops (lanes: samples)."""

    hinge: np.ndarray  # (s,) index of its hinge
    numbers: np.ndarray  # (s, 4, lanes) rad, 1 above or -1 below, N m/rad, N m s/rad
    openings: Openings  # of all hinges
    rates: np.ndarray  # (s, 2, lanes) rate (rad/s) and damper's moment (N m) of the last step
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (s, 1, lanes) energy of each (J)
    log: Log


@kernel
def overlap(part, i, field):
    """Return by how much (rad, m) the opening is beyond stop i. field: NEW or OLD."""
    angle = load(part.openings.angles, part.hinge[i], field) - load(part.numbers, i, ANGLE)
    return load(part.numbers, i, SIDE) * angle


@hook(Stops)
def forces(part, world, timing):
    for i in range(part.hinge.shape[0]):
        h, side = part.hinge[i], load(part.numbers, i, SIDE)
        rate = side * follow_rate(part.openings, part.rates, i, h, timing)
        spring, damper = press(
            overlap(part, i, NEW),
            overlap(part, i, OLD),
            rate,
            load(part.numbers, i, STIFFNESS),
            load(part.numbers, i, DAMPING),
        )
        turn(part.openings, world.state, h, -side * (spring + damper))
        add_loss(world, part.account, part.openings, part.rates, i, h, -side * damper)


@hook(Stops)
def note_events(part, world, timing):
    """Note which stops were hit (event 1) or left (0) in the step."""
    for i in range(part.hinge.shape[0]):
        old, new = overlap(part, i, OLD), overlap(part, i, NEW)
        note_crossings(part.log, i, TOUCH - old, TOUCH - new, timing)


@hook(Stops)
def energy_of(part, world, i):
    depth = overlap(part, i, NEW)
    depth = where_negative(depth, 0.0, depth)
    return 0.5 * load(part.numbers, i, STIFFNESS) * depth * depth
