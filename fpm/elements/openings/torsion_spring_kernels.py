"""Moments and energies of torsion springs."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NOW, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load

STIFFNESS, REST = 0, 1


class Springs(NamedTuple):
    """on (s,) hinges; spring (s, 2, lanes): stiffness (N m/rad), rest (rad); rows (s, 1, lanes)."""

    on: np.ndarray
    spring: np.ndarray
    openings: Openings
    rows: np.ndarray


@hook(Springs)
def forces(part, world, now):
    """Moments towards the openings at rest."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        off = load(part.spring, i, REST) - load(part.openings.angles, h, NOW)
        turn(part.openings, world.state, h, load(part.spring, i, STIFFNESS) * off)


@hook(Springs)
def energy_of(part, world, i):
    """Energy of spring i (J)."""
    off = load(part.openings.angles, part.on[i], NOW) - load(part.spring, i, REST)
    return 0.5 * load(part.spring, i, STIFFNESS) * off * off
