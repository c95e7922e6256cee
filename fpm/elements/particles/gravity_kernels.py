"""The weight of the particles and its work."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ACCOUNTS, MASS, F, X
from fpm.kernels.vectors import dot, get3, put3


class Weight(NamedTuple):
    """Arrays of gravity, for its kernels. acceleration (1, 3, lanes): of gravity, m/s², global;
    account: index of its work in World.accounts."""

    acceleration: np.ndarray
    account: int


@hook(Weight)
def forces(part, world, timing):
    """Add the weight (N) of every particle to the forces in world.state. part: arrays of gravity
    (Weight); world: solver state, whose forces change; timing: not used."""
    g = get3(part.acceleration, 0, 0)
    for i in range(world.state.shape[0]):
        weight = load(world.particles, i, MASS) * g
        put3(world.state, i, F, weight + get3(world.state, i, F))


@hook(Weight)
def work_of_place(part, world, energies, row):
    """Add the work (J) that weight has done on all particles, counted from the global origin to
    where they are now (minus the potential energy), to the recorded energies. part: arrays of
    gravity (Weight); world: solver state; energies (instants + 1, columns, lanes): changed in row
    `row` (index of the recorded instant) and column ACCOUNTS + part.account."""
    g = get3(part.acceleration, 0, 0)
    total = 0.0 * load(world.state, 0, X)
    for i in range(world.state.shape[0]):
        total = total + load(world.particles, i, MASS) * dot(g, get3(world.state, i, X))
    column = ACCOUNTS + part.account
    store(energies, row, column, load(energies, row, column) + total)
