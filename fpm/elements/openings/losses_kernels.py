"""What elements that lose energy on openings share: rates, losses, and edges that are crossed."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.hinge_arrays import ON_TWO
from fpm.elements.joints.joint_arrays import DIRECTION
from fpm.elements.openings.opening_kernels import NEW, OLD
from fpm.kernels.lanes import absolute, load, sqrt, store, where_negative
from fpm.kernels.vectors import dot, get3, kernel, vector

# Kept for each element from one step to the next.
RATE = 0  # of the opening, in the middle of the last step (rad/s); at first that at the start
LOSS = 1  # the moment that loses energy at the last positions (N m)
HISTORY = 2


class JointForce(NamedTuple):
    """The forces of the joints: hinge of each element among the lone ones, or -1, and its first row
    and how many among those of joints; the impulses of either, of the last step."""

    share: np.ndarray  # (f, 1, lanes) what counts of each N; 0: not this one
    lone: np.ndarray  # (f,)
    first: np.ndarray  # (f,)
    count: np.ndarray  # (f,)
    hinges: np.ndarray  # (h, SUMS, lanes)
    rows: np.ndarray  # (r, ROW, lanes)
    impulses: np.ndarray  # (r, 1, lanes)


@kernel
def half_rate(openings, h, timing):
    """Rate (rad/s) of opening h in the middle of the step up to now."""
    angles = openings.angles
    return (load(angles, h, NEW) - load(angles, h, OLD)) * (1.0 / timing.step)


@kernel
def follow_rate(openings, history, i, h, timing):
    """Rate (rad/s) of opening h now, to the second order in the step, from the last two steps.

    The middles of the steps lie half a step and one and a half behind (Adams and Bashforth).
    """
    last = load(history, i, RATE)
    rate = last
    if timing.time > 0.0:
        half = half_rate(openings, h, timing)
        rate = 1.5 * half - 0.5 * last
        store(history, i, RATE, half)
    return rate


@kernel
def lose(world, account, openings, history, i, h, moment):
    """Count what a moment on the second particle of hinge h loses in the step up to now.

    The trapezium rule is what leapfrog does: kinetic energy of the half steps before and after
    (record.py) changes by just that, so that no order of the step is left in the balance.
    """
    angles = openings.angles
    angle = load(angles, h, NEW) - load(angles, h, OLD)
    loss = -0.5 * (moment + load(history, i, LOSS)) * angle
    store(history, i, LOSS, moment)
    store(world.accounts, 0, account, load(world.accounts, 0, account) + loss)


@kernel
def force_of(bearing, i, timing):
    """Force (N) of the joint of element i in the last step."""
    zero = 0.0 * load(bearing.share, i, 0)
    impulse = vector(zero, zero, zero)
    if bearing.lone[i] >= 0:
        impulse = get3(bearing.hinges, bearing.lone[i], ON_TWO)
    for r in range(bearing.first[i], bearing.first[i] + bearing.count[i]):
        impulse = impulse + load(bearing.impulses, r, 0) * get3(bearing.rows, r, DIRECTION)
    # The first kick is half a step.
    kick = timing.step if timing.time > 1.5 * timing.step else 0.5 * timing.step
    return (1.0 / kick) * sqrt(dot(impulse, impulse))


@kernel
def edge(new, old):
    """What a spring that begins at zero must have on top of `new` where zero was crossed.

    On the way from -b to s it does k s²/2, but the forces k s and 0 at its ends do k s (s + b)/2.
    Half of the difference is taken off at the later step, and again by the step that follows.
    """
    product = new * old
    return where_negative(product, 0.5 * product / absolute(new - old), 0.0)


@kernel
def onset(new, old):
    """Share of a kick for a force that begins, whole, where zero was crossed from below.

    A kick is for half a step on either side; this one is for half a step and s/(s + b) of one.
    """
    product = new * old
    return where_negative(product, 0.5 + absolute(new) / absolute(new - old), 1.0)


@kernel
def press(new, old, rate, stiffness, damping):
    """Force (>= 0) of a one-sided spring and of its damper, where the overlap is above zero.

    new, before: the overlap now and a step ago; rate: its growth. The damper never pulls: it
    takes off at most what the spring has.
    """
    spring = stiffness * where_negative(new, 0.0, new)
    damper = damping * rate * onset(new, old)
    damper = where_negative(damper + spring, -spring, damper)
    damper = where_negative(-new, damper, 0.0)
    return spring + stiffness * edge(new, old), damper
