"""Moments, energies and events of face-to-face contacts."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.events import edge, note_crossings
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, where_negative
from fpm.kernels.world import Log

NUMBERS = ("stiffness",)
STIFFNESS = 0

TOUCH = 1e-9
"""Overlap (rad) from which faces count as shut: what the hinges leave open is below it, so a
linkage at rest at closure has no events. Faces that meet at 1 rad/s reach it within 1 ns."""


class Contacts(NamedTuple):
    """Arrays of all c face contacts (lanes: samples). hinge (c,): index of its hinge; numbers (c,
    1, lanes): stiffness (N m/rad); openings: all joint coordinates; rows (c, 1, lanes): energy of
    each (J), to name the worst in a message; log: where their events are noted (Log)."""

    hinge: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rows: np.ndarray
    log: Log


@hook(Contacts)
def forces(part, world, timing):
    """Add the moments (N m) of contacts whose faces overlap, stiffness times overlap, which open
    their hinges, to the forces on particles. part: arrays of all contacts (Contacts); world
    (World): solver state, whose forces change; timing: not used."""
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        psi, old = load(part.openings.angles, h, NEW), load(part.openings.angles, h, OLD)
        overlap = where_negative(psi, -psi, 0.0 * psi) + edge(-psi, -old)
        turn(part.openings, world.state, h, load(part.numbers, i, STIFFNESS) * overlap)


@hook(Contacts)
def note_events(part, world, timing):
    """Write to part.log which contacts closed (event 1) or opened (0) in the step that ends now,
    with the time. part: all contacts (Contacts); world: not used; timing (StepTime): times (s)."""
    angles = part.openings.angles
    for i in range(part.hinge.shape[0]):
        old, new = load(angles, part.hinge[i], OLD), load(angles, part.hinge[i], NEW)
        note_crossings(part.log, i, old + TOUCH, new + TOUCH, timing)


@hook(Contacts)
def energy_of(part, world, i):
    """Return the strain energy (J, lanes) of contact i, 0 where its faces do not overlap. part: all
    contacts (Contacts); world (World): solver state, not used; i: index of the contact."""
    psi = load(part.openings.angles, part.hinge[i], NEW)
    overlap = where_negative(psi, psi, 0.0 * psi)
    return 0.5 * load(part.numbers, i, STIFFNESS) * overlap * overlap
