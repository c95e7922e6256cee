"""Rates, losses and zero crossings that dissipative elements on joint openings share."""

from typing import NamedTuple

import numpy as np

from fpm.elements.cables.cable_kernels import TINY
from fpm.elements.joints.hinge_arrays import SIDE_FORCE2
from fpm.elements.joints.joint_arrays import DIRECTION
from fpm.elements.openings.opening_kernels import NEW, OLD
from fpm.kernels.lanes import absolute, load, sqrt, store, where_negative
from fpm.kernels.record import edge
from fpm.kernels.vectors import dot, get3, kernel, vector

# Kept for each element from one step to the next.
RATE = 0  # of the opening, in the middle of the last step (rad/s); at first that at the start
LOSS = 1  # the moment that loses energy at the last positions (N m)
HISTORY = 2


class JointForce(NamedTuple):
    """Impulses of joints in the last step (lanes: samples), by which f friction elements find their
    joint's force."""

    share: np.ndarray  # (f, 1, lanes) deflection at slip for each N (rad/N); 0: it is constant
    lone: np.ndarray  # (f,) row of each one's hinge in `hinges`; -1: not solved alone
    first: np.ndarray  # (f,) first row of its joint
    count: np.ndarray  # type: ignore[assignment]  # not tuple.count; (f,) how many
    hinges: np.ndarray  # (h, SUMS, lanes) impulses of hinges solved alone (N s, N m s)
    rows: np.ndarray  # (r, ROW, lanes) of joints solved together
    impulses: np.ndarray  # (r, 1, lanes) N s, N m s


@kernel
def half_rate(openings, h, timing):
    """Return the mean rate (rad/s, on slides m/s) of hinge h's coordinate in the step."""
    angles = openings.angles
    return (load(angles, h, NEW) - load(angles, h, OLD)) * (1.0 / timing.step)


@kernel
def follow_rate(openings, history, i, h, timing):
    """Return the rate (rad/s, on slides m/s) of hinge h's joint coordinate now, extrapolated to
    second order from the mean rates of the last two steps (Adams and Bashforth). Call it once a
    step: it stores the mean rate in history (elements, 2, lanes), the type's `rates`, of element
    i."""
    last = load(history, i, RATE)
    rate = last
    if timing.time > 0.0:
        half = half_rate(openings, h, timing)
        rate = 1.5 * half - 0.5 * last
        store(history, i, RATE, half)
    return rate


@kernel
def add_loss(world, account, openings, history, i, h, moment):
    """Add the energy (J) that a `moment` (N m, now) of element i on hinge h takes out in the step,
    the mean of this and the last one times the change of the coordinate, just what kinetic energy
    of the half steps changes by (record.py); store the moment in history (elements, 2, lanes)."""
    angles = openings.angles
    angle = load(angles, h, NEW) - load(angles, h, OLD)
    loss = -0.5 * (moment + load(history, i, LOSS)) * angle
    store(history, i, LOSS, moment)
    store(world.accounts, 0, account, load(world.accounts, 0, account) + loss)


@kernel
def force_of(bearing, i, timing, resistance):
    """Return the size (N, lanes) of the force in the joint of friction element i."""
    zero = 0.0 * load(bearing.share, i, 0)
    impulse = vector(zero, zero, zero)
    if bearing.lone[i] >= 0:
        impulse = get3(bearing.hinges, bearing.lone[i], SIDE_FORCE2)
    for r in range(bearing.first[i], bearing.first[i] + bearing.count[i]):
        impulse = impulse + load(bearing.impulses, r, 0) * get3(bearing.rows, r, DIRECTION)
    # The first kick is half a step.
    kick = timing.step if timing.time > 1.5 * timing.step else 0.5 * timing.step
    return (1.0 / kick) * load(resistance, 0, 0) * sqrt(dot(impulse, impulse))


@kernel
def onset(new, old):
    """Return the factor, 0.5 to 1.5, on the force of a damper that starts (or ends) within this
    step, as the overlap passes 0 or begins there; 1 in other steps. new, old: overlap now and a
    step ago (rad, m). An impulse is that of half a step before and after now; the force acts for
    half a step and s/(s + b) of one, s and b being the sizes of new and old."""
    share = absolute(new) / (absolute(new - old) + TINY)
    return where_negative(-1.0 * new * old, 1.0, 0.5 + share)


@kernel
def dead_band(backlash, i, value, old):
    """Return how far `value` is outside the dead band of element i, negative below it, and the same
    corrected by `edge`. value, old: now and a step ago (rad or m); backlash (elements, 1, lanes):
    widths, None: 0."""
    excess, force_excess = value, value
    if backlash is not None:
        half = 0.5 * load(backlash, i, 0)
        upper, lower = value - half, -1.0 * value - half
        excess = where_negative(upper, 0.0, upper) - where_negative(lower, 0.0, lower)
        passes = edge(upper, old - half) - edge(lower, -1.0 * old - half)
        force_excess = where_negative(-half, excess + passes, value)
        excess = where_negative(-half, excess, value)
    return excess, force_excess


@kernel
def press(new, old, rate, stiffness, damping):
    """Return the forces of spring and damper of a one-sided stop (N m, on slides N), in sum at
    least 0: it never pulls. new, old: overlap (rad, m) now and a step ago; rate: of it now."""
    overlap = where_negative(new, 0.0, new)
    spring = stiffness * overlap
    damper = damping * rate * onset(new, old)
    damper = where_negative(damper + spring, -spring, damper)
    damper = where_negative(-new, damper, 0.0)
    return stiffness * (overlap + edge(new, old)), damper
