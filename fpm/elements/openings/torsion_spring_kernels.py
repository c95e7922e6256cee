"""Moments and energies of torsion springs."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load

NUMBERS = "stiffness", "rest"
STIFFNESS, REST = range(2)


class Springs(NamedTuple):
    """Arrays of all s torsion springs. hinge (s,): index of each one's hinge; numbers (s, 2,
    lanes): stiffness (N m/rad) and opening at rest (rad); openings: of all hinges; rows (s, 1,
    lanes): energy of each (J), to name the worst in a message."""

    hinge: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rows: np.ndarray


@hook(Springs)
def forces(part, world, timing):
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        angle = load(part.numbers, i, REST) - load(part.openings.angles, h, NEW)
        turn(part.openings, world.state, h, load(part.numbers, i, STIFFNESS) * angle)


@hook(Springs)
def energy_of(part, world, i):
    angle = load(part.openings.angles, part.hinge[i], NEW) - load(part.numbers, i, REST)
    return 0.5 * load(part.numbers, i, STIFFNESS) * angle * angle
