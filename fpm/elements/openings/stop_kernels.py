"""Moments, energies, losses and events of stops."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import follow_rate, lose, press
from fpm.elements.openings.opening_kernels import BEFORE, NOW, Openings, turn
from fpm.kernels.events import note_crossing
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, where_negative
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

NUMBERS = "angle", "side", "stiffness", "damping"
ANGLE, SIDE, STIFFNESS, DAMPING = range(4)

TOUCH = 1e-9
"""Overlap (rad) from which a stop is hit: one that is just touched at rest has no events."""


class Stops(NamedTuple):
    """on (s,) hinges; numbers (s, 4, lanes); past (s, PAST, lanes); account of what is lost."""

    on: np.ndarray
    numbers: np.ndarray
    openings: Openings
    past: np.ndarray
    account: int
    rows: np.ndarray
    log: Log


@kernel
def overlap(part, i, when):
    """Overlap (rad) of stop i, `when` NOW or BEFORE; negative where it is free."""
    off = load(part.openings.angles, part.on[i], when) - load(part.numbers, i, ANGLE)
    return load(part.numbers, i, SIDE) * off


@hook(Stops)
def forces(part, world, timing):
    """Moments against the overlaps."""
    for i in range(part.on.shape[0]):
        h, side = part.on[i], load(part.numbers, i, SIDE)
        rate = side * follow_rate(part.openings, part.past, i, h, timing)
        spring, damper = press(
            overlap(part, i, NOW),
            overlap(part, i, BEFORE),
            rate,
            load(part.numbers, i, STIFFNESS),
            load(part.numbers, i, DAMPING),
        )
        turn(part.openings, world.state, h, -side * (spring + damper))
        lose(world, part.account, part.openings, part.past, i, h, -side * damper)


@hook(Stops)
def note_events(part, world, timing):
    """Note the stops that were hit or left since the last step."""
    for i in range(part.on.shape[0]):
        after = TOUCH - overlap(part, i, NOW)
        before = TOUCH - overlap(part, i, BEFORE)
        signs = where_negative(after, -1.0, 0.0 * after + 1.0)
        if any_negative(signs * where_negative(before, -1.0, 0.0 * before + 1.0)):
            angles, stop, h = part.openings.angles, part.numbers, part.on[i]
            for s in range(angles.shape[2]):
                angle, side = stop[i, ANGLE, s], stop[i, SIDE, s]
                last = TOUCH - side * (angles[h, BEFORE, s] - angle)
                this = TOUCH - side * (angles[h, NOW, s] - angle)
                note_crossing(part.log, s, i, last, this, timing)


@hook(Stops)
def energy_of(part, world, i):
    """Energy of stop i (J)."""
    over = overlap(part, i, NOW)
    over = where_negative(over, 0.0, over)
    return 0.5 * load(part.numbers, i, STIFFNESS) * over * over
