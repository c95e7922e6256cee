"""Moments, energies and events of face-to-face contacts."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.events import note_crossing
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, where_negative
from fpm.kernels.world import Log
from fpm.kinds.hinge_arrays import BEFORE, NOW, Hinges
from fpm.kinds.hinge_openings import turn_hinge

STIFFNESS = 0

TOUCH = 1e-9
"""Overlap (rad) from which faces count as shut: what the hinges leave open is below it, so a
linkage at rest at closure has no events. Faces that meet at 1 rad/s reach it within 1 ns.
"""


class Contacts(NamedTuple):
    """on (c,) hinges; contact (c, 1, lanes): stiffness (N m/rad); rows (c, 1, lanes)."""

    on: np.ndarray
    contact: np.ndarray
    hinges: Hinges
    rows: np.ndarray
    log: Log


@hook(Contacts)
def forces(part, world, now):
    """Moments that open the hinges whose faces overlap."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        psi = load(part.hinges.openings, h, NOW)
        overlap = where_negative(psi, -psi, 0.0 * psi)
        turn_hinge(part.hinges, world.state, h, load(part.contact, i, STIFFNESS) * overlap)


@hook(Contacts)
def note_events(part, world, now):
    """Note the contacts that shut or opened since the last step."""
    openings = part.hinges.openings
    for c in range(part.on.shape[0]):
        h = part.on[c]
        after = where_negative(load(openings, h, NOW) + TOUCH, -1.0, 1.0)
        before = where_negative(load(openings, h, BEFORE) + TOUCH, -1.0, 1.0)
        if any_negative(after * before):
            for s in range(openings.shape[2]):
                last, this = openings[h, BEFORE, s] + TOUCH, openings[h, NOW, s] + TOUCH
                note_crossing(part.log, s, c, last, this, now)


@hook(Contacts)
def energy_of(part, world, i):
    """Energy of contact i (J)."""
    psi = load(part.hinges.openings, part.on[i], NOW)
    overlap = where_negative(psi, psi, 0.0 * psi)
    return 0.5 * load(part.contact, i, STIFFNESS) * overlap * overlap
