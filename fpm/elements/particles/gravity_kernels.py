"""The weight of the particles and its work."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ACCOUNTS, MASS, F, X
from fpm.kernels.vectors import dot, get3, put3


class Weight(NamedTuple):
    """acceleration (1, 3, lanes) m/s²; account: the number of that of its work."""

    acceleration: np.ndarray
    account: int


@hook(Weight)
def forces(part, world, timing):
    """Weight of every particle."""
    g = get3(part.acceleration, 0, 0)
    for i in range(world.state.shape[0]):
        weight = load(world.particles, i, MASS) * g
        put3(world.state, i, F, weight + get3(world.state, i, F))


@hook(Weight)
def work_of_place(part, world, energies, row):
    """Minus the potential energy of the weight (J), zero at the global origin."""
    g = get3(part.acceleration, 0, 0)
    total = 0.0 * load(world.state, 0, X)
    for i in range(world.state.shape[0]):
        total = total + load(world.particles, i, MASS) * dot(g, get3(world.state, i, X))
    column = ACCOUNTS + part.account
    store(energies, row, column, load(energies, row, column) + total)
