"""Supports: forces along held axes go before the kick, particles free about two axes are moved."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load
from fpm.kernels.layout import HALF, KICK, F, M, P, V
from fpm.kernels.rotation import frame, half_turn
from fpm.kernels.run import carry, turn
from fpm.kernels.vectors import dot, get3, put3, times, to_local

LINEAR, ANGULAR = 0, 3

ROUNDS = 4
"""Each leaves of the spin about the held axis a share like the angle of a step."""


class Supports(NamedTuple):
    """Arrays of particles held along or about some axes, for kernels. particle (f,): their indices;
    free (f, 6, lanes): 1 where a particle can move along x, y, z and about them, 0 where it is
    held; about_two (t,): indices of those of unequal inertias that turn about two axes; axis (t, 3,
    lanes): global unit vector of the axis about which each of these is held."""

    particle: np.ndarray
    free: np.ndarray
    about_two: np.ndarray
    axis: np.ndarray


@hook(Supports)
def restrain(part, world, timing):
    """Set forces along held axes, and moments about them, of partly held particles to 0."""
    state = world.state
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        put3(state, i, F, times(get3(part.free, n, LINEAR), get3(state, i, F)))
        put3(state, i, M, times(get3(part.free, n, ANGULAR), get3(state, i, M)))


@hook(Supports)
def move(part, world, timing):
    """Move particles that turn about two axes. The angular momentum about the held axis is such
    that in the middle of the step there is no spin about it: a condition on rates."""
    state, particles = world.state, world.particles
    for n in range(part.about_two.shape[0]):
        i = part.about_two[n]
        v = load(particles, i, KICK) * get3(state, i, F) + get3(state, i, V)
        carry(state, i, v, timing.step)
        p, axis = timing.kick * get3(state, i, M) + get3(state, i, P), get3(part.axis, n, 0)
        axes, rate = frame(state, i), get3(particles, i, HALF)
        local_axis = to_local(axes, axis)
        soft = dot(local_axis, times(rate, local_axis))
        for _ in range(ROUNDS):
            p = p - (dot(local_axis, half_turn(to_local(axes, p), rate)) / soft) * axis
        turn(state, particles, i, p)
