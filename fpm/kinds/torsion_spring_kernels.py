"""Moments and energies of torsion springs."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import X
from fpm.kernels.vectors import kernel
from fpm.kinds.hinge_kernels import NOW, Hinges, turn_hinge

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


@kernel
def energy_of(part, i):
    """Energy of spring i (J)."""
    off = load(part.hinges.openings, part.on[i], NOW) - load(part.spring, i, REST)
    return 0.5 * load(part.spring, i, STIFFNESS) * off * off


@hook(Springs)
def stored(part, world, energies, row):
    """Energy of all springs (J)."""
    total = 0.0 * load(world.state, 0, X)
    for i in range(part.on.shape[0]):
        total = total + energy_of(part, i)
    return total


@hook(Springs)
def list_energies(part, world):
    """Energy of each spring (J)."""
    for i in range(part.on.shape[0]):
        store(part.rows, i, 0, energy_of(part, i))
