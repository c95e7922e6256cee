"""Dead loads and their work."""

from typing import NamedTuple

import numpy as np

from deployable.fpm.kernels.curves import curve_value
from deployable.fpm.kernels.hooks import hook
from deployable.fpm.kernels.lanes import load, store
from deployable.fpm.kernels.layout import IJ, F, M, P, V, X
from deployable.fpm.kernels.rotation import frame
from deployable.fpm.kernels.vectors import (
    add3,
    cross,
    dot,
    get3,
    kernel,
    times,
    to_global,
    to_local,
)

FORCE, MOMENT, ARM = 0, 3, 6


class Loads(NamedTuple):
    """on (l,) particles, curve (l,), load (l, 9, lanes): force (N), moment (N m), arm (m).

    account: the number of that of their work.
    """

    on: np.ndarray
    curve: np.ndarray
    load: np.ndarray
    account: int


@hook(Loads)
def forces(part, world, now):
    """Forces at the ends of the arms, and moments."""
    state = world.state
    for n in range(part.on.shape[0]):
        i = part.on[n]
        factor = curve_value(world, part.curve[n], now.time)
        force = factor * get3(part.load, n, FORCE)
        moment = factor * get3(part.load, n, MOMENT)
        arm = to_global(frame(state, i), get3(part.load, n, ARM))
        add3(state, i, F, force)
        add3(state, i, M, moment + cross(arm, force))


@kernel
def spin(state, particles, i):
    """Angular velocity of particle i in global axes (rad/s)."""
    axes = frame(state, i)
    return to_global(axes, times(get3(particles, i, IJ), to_local(axes, get3(state, i, P))))


@kernel
def add_work(part, world, now):
    """Add the loads' power, with the velocities as they are, times half a step to their account."""
    state = world.state
    total = 0.0 * load(state, 0, X)
    for n in range(part.on.shape[0]):
        i = part.on[n]
        factor = curve_value(world, part.curve[n], now.time)
        force = factor * get3(part.load, n, FORCE)
        arm = to_global(frame(state, i), get3(part.load, n, ARM))
        moment = factor * get3(part.load, n, MOMENT) + cross(arm, force)
        total = total + dot(force, get3(state, i, V)) + dot(moment, spin(state, world.particles, i))
    given = load(world.accounts, 0, part.account) + 0.5 * now.step * total
    store(world.accounts, 0, part.account, given)


@hook(Loads)
def work_before(part, world, now):
    """Work of the half step up to now."""
    add_work(part, world, now)


@hook(Loads)
def work_after(part, world, now):
    """Work of the half step after it."""
    add_work(part, world, now)
