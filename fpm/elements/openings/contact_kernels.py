"""Moments, energies and events of face-to-face contacts."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.events import note_crossing
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, where_negative
from fpm.kernels.world import Log

NUMBERS = ("stiffness",)
STIFFNESS = 0

TOUCH = 1e-9
"""Overlap (rad) from which faces count as shut: what the hinges leave open is below it, so a
linkage at rest at closure has no events. Faces that meet at 1 rad/s reach it within 1 ns.
"""


class Contacts(NamedTuple):
    """Arrays of all c contacts. on (c,): index of each one's hinge; numbers (c, 1, lanes):
    stiffness (N m/rad); rows (c, 1, lanes): energies, for messages; log: of events."""

    on: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rows: np.ndarray
    log: Log


@hook(Contacts)
def forces(part, world, timing):
    """Add the moments (N m) of contacts whose faces overlap, which open their hinges. part: arrays
    of all contacts (Contacts); world: solver state (World); timing: times of the step (s)."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        psi = load(part.openings.angles, h, NEW)
        overlap = where_negative(psi, -psi, 0.0 * psi)
        turn(part.openings, world.state, h, load(part.numbers, i, STIFFNESS) * overlap)


@hook(Contacts)
def note_events(part, world, timing):
    """Note events of contacts in part.log: which closed (1) or opened (0) since the last step.
    part: arrays of all contacts (Contacts); world: solver state (World); timing: step times (s)."""
    angles = part.openings.angles
    for c in range(part.on.shape[0]):
        h = part.on[c]
        new = where_negative(load(angles, h, NEW) + TOUCH, -1.0, 1.0)
        old = where_negative(load(angles, h, OLD) + TOUCH, -1.0, 1.0)
        if any_negative(new * old):
            for s in range(angles.shape[2]):
                last, value = angles[h, OLD, s] + TOUCH, angles[h, NEW, s] + TOUCH
                note_crossing(part.log, s, c, last, value, timing)


@hook(Contacts)
def energy_of(part, world, i):
    """Energy (J, lanes) of contact i, 0 if open. part: all contacts (Contacts); world: World."""
    psi = load(part.openings.angles, part.on[i], NEW)
    overlap = where_negative(psi, psi, 0.0 * psi)
    return 0.5 * load(part.numbers, i, STIFFNESS) * overlap * overlap
