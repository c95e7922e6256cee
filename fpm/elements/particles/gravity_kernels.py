"""The weight of the particles and its work."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import kick_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ACCOUNTS, MASS, F, X
from fpm.kernels.vectors import add3, dot, get3, kernel, put3


class Weight(NamedTuple):
    """Arrays of gravity, for its kernels. acceleration (1, 3, lanes): of gravity, m/s², global;
    account: index of its work in World.accounts."""

    acceleration: np.ndarray
    account: int


@hook(Weight)
def forces(part, world, timing):
    g = get3(part.acceleration, 0, 0)
    for i in range(world.state.shape[0]):
        weight = load(world.particles, i, MASS) * g
        put3(world.state, i, F, weight + get3(world.state, i, F))


@hook(Weight)
def work_of_place(part, world, energies, row):
    """Add the work (J) of weight from the global origin (minus the potential energy)."""
    g = get3(part.acceleration, 0, 0)
    total = 0.0 * load(world.state, 0, X)
    for i in range(world.state.shape[0]):
        total = total + load(world.particles, i, MASS) * dot(g, get3(world.state, i, X))
    column = ACCOUNTS + part.account
    store(energies, row, column, load(energies, row, column) + total)


class VaryingWeight(NamedTuple):
    """Arrays of gravity with a curve. acceleration (1, 3, lanes): where the curve is 1 (m/s²,
    global); curve (1,): its index; moment (1, 3, lanes): sum of masses times positions (kg m) when
    forces were last computed; account: index of its work in World.accounts."""

    acceleration: np.ndarray
    curve: np.ndarray
    moment: np.ndarray
    account: int


@kernel
def first_moment(world):
    """Return the sum of masses times positions (kg m, 3) of all particles. world: solver state."""
    total = 0.0 * get3(world.state, 0, X)
    for i in range(world.state.shape[0]):
        total = total + load(world.particles, i, MASS) * get3(world.state, i, X)
    return total


@hook(VaryingWeight, "forces")
def varying_forces(part, world, timing):
    g = kick_mean(world, part.curve[0], timing) * get3(part.acceleration, 0, 0)
    put3(part.moment, 0, 0, first_moment(world))
    for i in range(world.state.shape[0]):
        add3(world.state, i, F, load(world.particles, i, MASS) * g)


@hook(VaryingWeight)
def work_after(part, world, timing):
    """Add the work (J) of weight in this step, by the curve's means, as with loads."""
    factor = kick_mean(world, part.curve[0], timing)
    factor = 0.5 * (factor + kick_mean(world, part.curve[0], timing, 1))
    change = first_moment(world) - get3(part.moment, 0, 0)
    work = load(world.accounts, 0, part.account)
    work = work + factor * dot(get3(part.acceleration, 0, 0), change)
    store(world.accounts, 0, part.account, work)
