"""Supports: forces along held axes, and moments about them, go before the kick."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.layout import F, M
from fpm.kernels.vectors import get3, put3, times

LINEAR, ANGULAR = 0, 3


class Supports(NamedTuple):
    """Arrays of particles held along or about some axes. particle (f,): their indices; free (f, 6,
    lanes): 1 where a particle can move along x, y, z and about them, 0 where it is held."""

    particle: np.ndarray
    free: np.ndarray


@hook(Supports)
def restrain(part, world, timing):
    """Set forces along held axes, and moments about them, of partly held particles to 0."""
    state = world.state
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        put3(state, i, F, times(get3(part.free, n, LINEAR), get3(state, i, F)))
        put3(state, i, M, times(get3(part.free, n, ANGULAR), get3(state, i, M)))
