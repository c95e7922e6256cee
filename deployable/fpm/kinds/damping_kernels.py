"""Damping forces as a central difference, and the energy that they take out."""

from typing import NamedTuple

import numpy as np

from deployable.fpm.kernels.hooks import hook
from deployable.fpm.kernels.lanes import load, store
from deployable.fpm.kernels.layout import IJ, MASS, F, M, P, V
from deployable.fpm.kernels.rotation import frame
from deployable.fpm.kernels.vectors import dot, get3, put3, times, to_local


class Rate(NamedTuple):
    """rate (1, 1, lanes) 1/s; account: the number of that of the energy it takes."""

    rate: np.ndarray
    account: int


@hook(Rate)
def restrain(part, world, now):
    """Central difference of the damping force: (1 + c) v+ = (1 - c) v- + kick F/m.

    c = rate * kick / 2. Scales momenta and forces; the plain kick that follows does the rest.
    """
    state = world.state
    c = 0.5 * now.kick * load(part.rate, 0, 0)
    before, force = (1.0 - c) / (1.0 + c), 1.0 / (1.0 + c)
    for i in range(state.shape[0]):
        for k in (V, P):
            put3(state, i, k, before * get3(state, i, k))
        for k in (F, M):
            put3(state, i, k, force * get3(state, i, k))


@hook(Rate)
def work_after(part, world, now):
    """Energy that damping takes out over the step."""
    state, particles = world.state, world.particles
    rate = load(part.rate, 0, 0)
    total = 0.0 * rate
    for i in range(state.shape[0]):
        v = get3(state, i, V)
        total = total + load(particles, i, MASS) * dot(v, v)
        local = to_local(frame(state, i), get3(state, i, P))
        total = total + dot(local, times(get3(particles, i, IJ), local))
    taken = load(world.accounts, 0, part.account) + now.step * rate * total
    store(world.accounts, 0, part.account, taken)
