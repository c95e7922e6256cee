"""Moments and energies of torsion springs."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load

NUMBERS = "stiffness", "rest"
STIFFNESS, REST = range(2)


class Springs(NamedTuple):
    """Arrays of all torsion springs: hinges on (s,); numbers (s, 2, lanes); rows (s, 1, lanes)."""

    on: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rows: np.ndarray


@hook(Springs)
def forces(part, world, timing):
    """Add the moments (N m) of torsion springs towards their openings at rest."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        angle = load(part.numbers, i, REST) - load(part.openings.angles, h, NEW)
        turn(part.openings, world.state, h, load(part.numbers, i, STIFFNESS) * angle)


@hook(Springs)
def energy_of(part, world, i):
    """Strain energy (J) of spring i."""
    angle = load(part.openings.angles, part.on[i], NEW) - load(part.numbers, i, REST)
    return 0.5 * load(part.numbers, i, STIFFNESS) * angle * angle
