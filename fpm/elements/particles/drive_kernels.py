"""Driven particles and the work of their drives."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import curve_mean, curve_value
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import VELOCITY, F, M, P, V, X
from fpm.kernels.rotation import frame, turn_frame
from fpm.kernels.vectors import add3, cross, dot, get3, kernel, put3, to_global, to_local

NUMBERS = "velocity", "spin"
LINEAR, SPIN = 0, 3


class Drives(NamedTuple):
    """Arrays of all d drives. particle (d,): index of its particle; curve (d,): index of its curve
    of time, -1: constant 1; numbers (d, 6, lanes): velocity (m/s) and spin (rad/s) in global axes;
    account: index of their work in World.accounts. Those of one particle add up."""

    particle: np.ndarray
    curve: np.ndarray
    numbers: np.ndarray
    account: int


@kernel
def add_work(part, world, timing, start):
    """Add to World.accounts the work (J) of drives over half a step: they move particles against
    the forces that act on these now, so that it is minus the power of the forces times step/2.
    part: arrays of all drives (Drives); world: solver state; timing: times of this step (s); start:
    of the step (s) over which the velocities are means."""
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
def work_before(part, world, timing):
    """Add to World.accounts the work (J) of drives in the half step that ends now, at timing.time.
    part: arrays of all drives (Drives); world: solver state; timing: times of this step (s)."""
    add_work(part, world, timing, timing.time - timing.step)


@hook(Drives)
def restrain(part, world, timing):
    """Add to World.accounts the work (J) of drives in the half step that begins now, at
    timing.time, against the forces at its start. part: arrays of all drives (Drives); world: solver
    state; timing: times of this step (s)."""
    add_work(part, world, timing, timing.time)


@hook(Drives)
def move(part, world, timing):
    """Move driven particles by one step as prescribed, and set the forces on them to 0. part:
    arrays of all drives (Drives); world: solver state (World), changed; timing: times (s)."""
    state = world.state
    for n in range(part.particle.shape[0]):
        put3(state, part.particle[n], V, 0.0 * get3(state, part.particle[n], V))
        for k in range(6):
            store(state, part.particle[n], F + k, 0.0)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        factor = curve_mean(world, part.curve[n], timing.time, timing.time + timing.step)
        v = factor * get3(part.numbers, n, LINEAR)
        add3(state, i, V, v)
        put3(state, i, X, timing.step * v + get3(state, i, X))
        half = (0.5 * timing.step * factor) * get3(part.numbers, n, SPIN)
        axes = frame(state, i)
        turn_frame(state, i, axes, to_local(axes, half))


@hook(Drives)
def look_back(part, world, timing):
    """In the first step only, extrapolate linearly the velocities (m/s) and spins (rad/s) of driven
    particles to half a step before the start, into World.start_state; and write their spins half a
    step after it into World.state. Spins stand in for angular momenta, which they lack. part:
    arrays of all drives; world: solver state, changed; timing: times of this step (s)."""
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        zero = 0.0 * get3(world.state, i, X)
        put3(world.start_state, i, V, zero)
        put3(world.start_state, i, P, zero)
        put3(world.state, i, P, zero)
    for n in range(part.particle.shape[0]):
        i, spin = part.particle[n], get3(part.numbers, n, SPIN)
        new = curve_mean(world, part.curve[n], 0.0, timing.step)
        old = 2.0 * curve_value(world, part.curve[n], 0.0) - new
        add3(world.start_state, i, V, old * get3(part.numbers, n, LINEAR))
        add3(world.start_state, i, P, old * spin)
        add3(world.state, i, P, new * spin)


@hook(Drives)
def record_points(part, world, points, row, timing):
    """Overwrite recorded velocities (m/s) of named points on driven particles with the prescribed
    ones, as these particles have no momenta. part: arrays of all drives (Drives); world: solver
    state; points: Record.points (rows, 6, lanes), positions and velocities, changed; row: index of
    the recorded instant; timing: times of this step (s)."""
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
