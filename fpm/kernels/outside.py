"""Loads, gravity, held axes and driven particles: what acts on the particles from outside."""

from fpm.kernels.lanes import load, store
from fpm.kernels.layout import IJ, MASS, F, M, P, V, X
from fpm.kernels.rotation import frame, put_turned
from fpm.kernels.vectors import (
    add,
    axpy,
    cross,
    dot,
    get3,
    kernel,
    put3,
    scale,
    times,
    to_global,
    to_local,
)


@kernel
def curve_value(curve, starts, times_, values, t):
    """Value at time t of piecewise linear curve `curve` (constant outside); -1 is always 1.

    Curve c has the points starts[c] .. starts[c+1] - 1 of times_ and values.
    """
    if curve < 0:
        return 1.0
    first, last = starts[curve], starts[curve + 1] - 1
    if t <= times_[first]:
        return values[first]
    for k in range(first, last):
        if t < times_[k + 1]:
            share = (t - times_[k]) / (times_[k + 1] - times_[k])
            return values[k] + share * (values[k + 1] - values[k])
    return values[last]


@kernel
def gravity_forces(state, particles, gravity):
    """Weight of every particle; gravity (1, 3, lanes) m/s²."""
    g = get3(gravity, 0, 0)
    for i in range(state.shape[0]):
        put3(state, i, F, axpy(load(particles, i, MASS), g, get3(state, i, F)))


@kernel
def load_forces(state, on, loads, curves, starts, times_, values, t):
    """Dead loads; on (n,) particles, loads (n, 9, lanes): force, moment, arm; curves (n,)."""
    for n in range(on.shape[0]):
        i = on[n]
        factor = curve_value(curves[n], starts, times_, values, t)
        force = scale(factor, get3(loads, n, 0))
        moment = scale(factor, get3(loads, n, 3))
        arm = to_global(frame(state, i), get3(loads, n, 6))
        put3(state, i, F, add(get3(state, i, F), force))
        put3(state, i, M, add(get3(state, i, M), add(moment, cross(arm, force))))


@kernel
def add_load_work(work, state, particles, on, loads, curves, starts, times_, values, t, step):
    """Add the loads' power at t, with the velocities as they are, times `step` to work[0, 0]."""
    total = 0.0 * load(state, 0, X)
    for n in range(on.shape[0]):
        i = on[n]
        factor = curve_value(curves[n], starts, times_, values, t)
        force = scale(factor, get3(loads, n, 0))
        arm = to_global(frame(state, i), get3(loads, n, 6))
        moment = add(scale(factor, get3(loads, n, 3)), cross(arm, force))
        total = total + dot(force, get3(state, i, V)) + dot(moment, spin(state, particles, i))
    store(work, 0, 0, load(work, 0, 0) + step * total)


@kernel
def spin(state, particles, i):
    """Angular velocity of particle i in global axes (rad/s)."""
    axes = frame(state, i)
    return to_global(axes, times(get3(particles, i, IJ), to_local(axes, get3(state, i, P))))


@kernel
def hold(state, on, free):
    """Take out forces and moments along held axes; on (n,), free (n, 6, lanes): 0 where held."""
    for n in range(on.shape[0]):
        i = on[n]
        put3(state, i, F, times(get3(free, n, 0), get3(state, i, F)))
        put3(state, i, M, times(get3(free, n, 3), get3(state, i, M)))


@kernel
def add_drive_work(work, state, on, drives, curves, starts, times_, values, t, step):
    """Add the work of the drives over `step` s against the particles' forces to work[0, 0].

    t (s) is the time of the velocities.
    """
    total = 0.0 * load(state, 0, X)
    for n in range(on.shape[0]):
        i = on[n]
        factor = curve_value(curves[n], starts, times_, values, t)
        power = dot(get3(state, i, F), get3(drives, n, 0))
        total = total - factor * (power + dot(get3(state, i, M), get3(drives, n, 3)))
    store(work, 0, 0, load(work, 0, 0) + step * total)


@kernel
def drive(state, on, drives, curves, starts, times_, values, t, step):
    """Move the driven particles by one step, and clear their forces; t (s) is its middle.

    drives (n, 6, lanes): velocity and spin in global axes; those of one particle add up.
    """
    for n in range(on.shape[0]):
        put3(state, on[n], V, scale(0.0, get3(state, on[n], V)))
        for k in range(6):
            store(state, on[n], F + k, 0.0)
    for n in range(on.shape[0]):
        i = on[n]
        factor = curve_value(curves[n], starts, times_, values, t)
        v = scale(factor, get3(drives, n, 0))
        put3(state, i, V, add(v, get3(state, i, V)))
        put3(state, i, X, axpy(step, v, get3(state, i, X)))
        half = scale(0.5 * step * factor, get3(drives, n, 3))
        axes = frame(state, i)
        put_turned(state, i, axes, to_local(axes, half))


@kernel
def add_damping_work(work, state, particles, damping, step):
    """Add the energy that damping takes out over `step` s, velocities as they are, to work[0, 1].

    damping (1, 1, lanes): rate (1/s).
    """
    rate = load(damping, 0, 0)
    total = 0.0 * rate
    for i in range(state.shape[0]):
        v = get3(state, i, V)
        total = total + load(particles, i, MASS) * dot(v, v)
        local = to_local(frame(state, i), get3(state, i, P))
        total = total + dot(local, times(get3(particles, i, IJ), local))
    store(work, 0, 1, load(work, 0, 1) + step * rate * total)


@kernel
def damp(state, damping, kick):
    """Central difference of the damping force: (1 + c) v+ = (1 - c) v- + kick F/m.

    c = rate * kick / 2. Scales momenta and forces; the plain kick that follows does the rest.
    """
    c = 0.5 * kick * load(damping, 0, 0)
    before, force = (1.0 - c) / (1.0 + c), 1.0 / (1.0 + c)
    for i in range(state.shape[0]):
        for k in (V, P):
            put3(state, i, k, scale(before, get3(state, i, k)))
        for k in (F, M):
            put3(state, i, k, scale(force, get3(state, i, k)))
