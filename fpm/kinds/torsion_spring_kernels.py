"""Moments and energies of torsion springs."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load
from fpm.kinds.hinge_arrays import NOW, Hinges
from fpm.kinds.hinge_openings import turn_hinge

STIFFNESS, REST = 0, 1


class Springs(NamedTuple):
    """on (s,) hinges; spring (s, 2, lanes): stiffness (N m/rad), rest (rad); rows (s, 1, lanes)."""

    on: np.ndarray
    spring: np.ndarray
    hinges: Hinges
    rows: np.ndarray


@hook(Springs)
def forces(part, world, now):
    """Moments towards the openings at rest."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        off = load(part.spring, i, REST) - load(part.hinges.openings, h, NOW)
        turn_hinge(part.hinges, world.state, h, load(part.spring, i, STIFFNESS) * off)


@hook(Springs)
def energy_of(part, world, i):
    """Energy of spring i (J)."""
    off = load(part.hinges.openings, part.on[i], NOW) - load(part.spring, i, REST)
    return 0.5 * load(part.spring, i, STIFFNESS) * off * off
