"""Driven particles and the work of their drives."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import curve_mean, curve_value
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import BY_SPIN, KINETIC, MASS, VELOCITY, F, M, P, V, X
from fpm.kernels.rotation import frame, turn_frame
from fpm.kernels.vectors import add3, cross, dot, get3, kernel, put3, times, to_global, to_local

NUMBERS = "velocity", "spin"
LINEAR, SPIN = 0, 3


class Drives(NamedTuple):
    """Arrays of all d drives (lanes: samples). Drives of one particle add up."""

    particle: np.ndarray  # (d,) index of its particle
    curve: np.ndarray  # (d,) of its curve of time; -1: constant 1
    numbers: np.ndarray  # (d, 6, lanes) m/s, rad/s, in global axes
    inertia: np.ndarray  # (d, 3, lanes) of its particle (kg m²)
    kinetic: np.ndarray  # (1, 1, lanes) energy of all driven particles now (J)
    account: int  # index of their work in World.accounts


@kernel
def add_work(part, world, timing, start):
    """Add the work (J) of drives over half a step, against the forces that act on their particles
    now. start: of the step (s) over which the velocities are means."""
    state = world.state
    total = 0.0 * load(state, 0, X)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        factor = curve_mean(world, part.curve[n], start, start + timing.step)
        power = dot(get3(state, i, F), get3(part.numbers, n, LINEAR))
        total = total - factor * (power + dot(get3(state, i, M), get3(part.numbers, n, SPIN)))
    work = load(world.accounts, 0, part.account) + 0.5 * timing.step * total
    store(world.accounts, 0, part.account, work)


@hook(Drives)
def forces(part, world, timing):
    """Add the change of driven particles' kinetic energy (J) to their drives' work."""
    total = 0.0 * load(world.state, 0, X)
    for n in range(part.particle.shape[0]):
        i, is_first, zero = part.particle[n], True, 0.0 * get3(world.state, part.particle[n], X)
        v, spin = zero, zero
        for k in range(part.particle.shape[0]):
            if part.particle[k] == i:
                is_first = is_first and k >= n
                factor = curve_value(world, part.curve[k], timing.time)
                v = v + factor * get3(part.numbers, k, LINEAR)
                spin = spin + factor * get3(part.numbers, k, SPIN)
        if is_first:
            spin = to_local(frame(world.state, i), spin)
            turn = dot(spin, times(get3(part.inertia, n, 0), spin))
            total = total + 0.5 * (load(world.particles, i, MASS) * dot(v, v) + turn)
    work = load(world.accounts, 0, part.account) + (total - load(part.kinetic, 0, 0))
    store(world.accounts, 0, part.account, work)
    store(part.kinetic, 0, 0, total)


@hook(Drives)
def work_before(part, world, timing):
    add_work(part, world, timing, timing.time - timing.step)


@hook(Drives)
def restrain(part, world, timing):
    add_work(part, world, timing, timing.time)


@hook(Drives)
def move(part, world, timing):
    """Move driven particles as prescribed; their spins stand for angular momenta."""
    state = world.state
    for n in range(part.particle.shape[0]):
        for k in (V, P):
            put3(state, part.particle[n], k, 0.0 * get3(state, part.particle[n], V))
        for k in range(6):
            store(state, part.particle[n], F + k, 0.0)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        factor = curve_mean(world, part.curve[n], timing.time, timing.time + timing.step)
        v = factor * get3(part.numbers, n, LINEAR)
        add3(state, i, V, v)
        put3(state, i, X, timing.step * v + get3(state, i, X))
        spin = factor * get3(part.numbers, n, SPIN)
        add3(state, i, P, spin)
        axes = frame(state, i)
        turn_frame(state, i, axes, to_local(axes, (0.5 * timing.step) * spin))


@hook(Drives)
def look_back(part, world, timing):
    """Extrapolate velocities and spins of driven particles to half a step before the start."""
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        zero = 0.0 * get3(world.state, i, X)
        put3(world.start_state, i, V, zero)
        put3(world.start_state, i, P, zero)
        store(world.particles, i, BY_SPIN, 1.0)
    for n in range(part.particle.shape[0]):
        i, spin = part.particle[n], get3(part.numbers, n, SPIN)
        new = curve_mean(world, part.curve[n], 0.0, timing.step)
        old = 2.0 * curve_value(world, part.curve[n], 0.0) - new
        add3(world.start_state, i, V, old * get3(part.numbers, n, LINEAR))
        add3(world.start_state, i, P, old * spin)


@hook(Drives)
def work_due(part, world, energies, row, timing):
    """Add the kinetic energy (J) of driven particles to the recorded one."""
    store(energies, row, KINETIC, load(energies, row, KINETIC) + load(part.kinetic, 0, 0))


@hook(Drives)
def record_points(part, world, points, row, timing):
    """Overwrite recorded velocities (m/s) of points on driven particles, which have no momenta."""
    count = world.point_particle.shape[0]
    for n in range(count):
        i, first, index = world.point_particle[n], True, row * count + n
        arm = to_global(frame(world.start_state, i), get3(world.point_arm, n, 0))
        for k in range(part.particle.shape[0]):
            if part.particle[k] == i:
                if first:
                    put3(points, index, VELOCITY, 0.0 * get3(points, index, VELOCITY))
                    first = False
                factor = curve_value(world, part.curve[k], timing.time)
                spin = get3(part.numbers, k, SPIN)
                v = factor * (get3(part.numbers, k, LINEAR) + cross(spin, arm))
                add3(points, index, VELOCITY, v)
