"""Damping forces as a central difference, and the energy that they take out.

(1 + c) v+ = (1 - c) v- + kick F/m with c = rate * kick / 2, and so momenta. Free particles are
damped as they are kicked; of those that another kind kicks, momenta and forces are scaled before.
The work over a step is the rate times the sum of every momentum times the way that it takes."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, KICK, MASS, F, M, P, V
from fpm.kernels.rotation import frame
from fpm.kernels.run import carry, turn
from fpm.kernels.vectors import dot, get3, kernel, put3, times, to_local, vector


class DampingState(NamedTuple):
    """Arrays of mass-proportional damping, for its kernels. rate (1, 1, lanes): total, 1/s; free
    (f,): indices of particles that no other element type moves; joint_particles (j,): of those that
    joints or supports move, not held in all ways; account: index of the loss in World.accounts."""

    rate: np.ndarray
    free: np.ndarray
    joint_particles: np.ndarray
    account: int


@kernel
def factors(part, kick):
    """Return the factors (lanes) (1 - c)/(1 + c) on the momenta before a damped step, and 1/(1 + c)
    on the impulses of forces, with c = rate kick/2."""
    force = 1.0 / (1.0 + 0.5 * kick * load(part.rate, 0, 0))
    return 2.0 * force - 1.0, force


@kernel
def take(part, world, path):
    """Add the energy (J) that damping takes, rate times `path` (lanes): sum over particles of
    momentum times distance moved, angular ones included (J s)."""
    loss = load(world.accounts, 0, part.account) + load(part.rate, 0, 0) * path
    store(world.accounts, 0, part.account, loss)


@hook(DampingState)
def restrain(part, world, timing):
    """Multiply momenta and forces of part.joint_particles so that their step damps them; impulses
    of joints, which come later, are not multiplied: world.resistance is 1 + c."""
    state = world.state
    factor, force = factors(part, timing.kick)
    store(world.resistance, 0, 0, 1.0 / force)
    for n in range(part.joint_particles.shape[0]):
        i = part.joint_particles[n]
        for k in (V, P):
            put3(state, i, k, factor * get3(state, i, k))
        for k in (F, M):
            put3(state, i, k, force * get3(state, i, k))


@hook(DampingState)
def move(part, world, timing):
    """Make one damped step of part.free, the particles that no other element type moves."""
    state, particles = world.state, world.particles
    factor, force = factors(part, timing.kick)
    kick = timing.kick * force
    linear = 0.0 * kick
    angular = vector(linear, linear, linear)
    for n in range(part.free.shape[0]):
        i = part.free[n]
        # The kick first: of two products it is the one that is fused, as without damping.
        v = force * load(particles, i, KICK) * get3(state, i, F) + factor * get3(state, i, V)
        carry(state, i, v, timing.step)
        linear = linear + load(particles, i, MASS) * dot(v, v)
        p = kick * get3(state, i, M) + factor * get3(state, i, P)
        body, half = turn(state, particles, i, p)
        angular = angular + times(body, half)
    take(part, world, timing.step * linear + 2.0 * (angular.x + angular.y + angular.z))


@hook(DampingState)
def work_after(part, world, timing):
    """Add the energy (J) taken out of part.joint_particles, by momenta after joints acted."""
    state, particles = world.state, world.particles
    total = 0.0 * load(part.rate, 0, 0)
    for n in range(part.joint_particles.shape[0]):
        i = part.joint_particles[n]
        v = get3(state, i, V)
        total = total + load(particles, i, MASS) * dot(v, v)
        local = to_local(frame(state, i), get3(state, i, P))
        total = total + dot(local, times(get3(particles, i, IJ), local))
    take(part, world, timing.step * total)
