"""What elements that lose energy on openings share: rates, losses, and edges that are crossed."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.hinge_arrays import ON_TWO
from fpm.elements.joints.joint_arrays import ALONG
from fpm.elements.openings.opening_kernels import BEFORE, NOW
from fpm.kernels.lanes import absolute, load, sqrt, store, where_negative
from fpm.kernels.vectors import dot, get3, kernel, vector

# Kept for each element from one step to the next.
RATE = 0  # of the opening, in the middle of the last step (rad/s); at first that at the start
LOSING = 1  # the moment that loses energy at the last positions (N m)
PAST = 2


class Borne(NamedTuple):
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
    return (load(angles, h, NOW) - load(angles, h, BEFORE)) * (1.0 / timing.step)


@kernel
def follow_rate(openings, past, i, h, timing):
    """Rate (rad/s) of opening h now, to the second order in the step, from the last two steps.

    The middles of the steps lie half a step and one and a half behind (Adams and Bashforth).
    """
    last = load(past, i, RATE)
    rate = last
    if timing.time > 0.0:
        half = half_rate(openings, h, timing)
        rate = 1.5 * half - 0.5 * last
        store(past, i, RATE, half)
    return rate


@kernel
def lose(world, account, openings, past, i, h, moment):
    """Count what a moment on the second particle of hinge h loses in the step up to now.

    The trapezium rule is what leapfrog does: kinetic energy of the half steps before and after
    (record.py) changes by just that, so that no order of the step is left in the balance.
    """
    angles = openings.angles
    turned = load(angles, h, NOW) - load(angles, h, BEFORE)
    lost = -0.5 * (moment + load(past, i, LOSING)) * turned
    store(past, i, LOSING, moment)
    store(world.accounts, 0, account, load(world.accounts, 0, account) + lost)


@kernel
def force_of(borne, i, timing):
    """Force (N) of the joint of element i in the last step."""
    none = 0.0 * load(borne.share, i, 0)
    impulse = vector(none, none, none)
    if borne.lone[i] >= 0:
        impulse = get3(borne.hinges, borne.lone[i], ON_TWO)
    for r in range(borne.first[i], borne.first[i] + borne.count[i]):
        impulse = impulse + load(borne.impulses, r, 0) * get3(borne.rows, r, ALONG)
    # The first kick is half a step.
    kick = timing.step if timing.time > 1.5 * timing.step else 0.5 * timing.step
    return (1.0 / kick) * sqrt(dot(impulse, impulse))


@kernel
def edge(after, before):
    """What a spring that begins at zero must have on top of `after` where zero was crossed.

    On the way from -b to s it does k s²/2, but the forces k s and 0 at its ends do k s (s + b)/2.
    Half of the difference is taken off at the later step, and again by the step that follows.
    """
    both = after * before
    return where_negative(both, 0.5 * both / absolute(after - before), 0.0)


@kernel
def onset(after, before):
    """Share of a kick for a force that begins, whole, where zero was crossed from below.

    A kick is for half a step on either side; this one is for half a step and s/(s + b) of one.
    """
    both = after * before
    return where_negative(both, 0.5 + absolute(after) / absolute(after - before), 1.0)


@kernel
def press(after, before, rate, stiffness, damping):
    """Force (>= 0) of a one-sided spring and of its damper, where the overlap is above zero.

    after, before: the overlap now and a step ago; rate: its growth. The damper never pulls: it
    takes off at most what the spring has.
    """
    spring = stiffness * where_negative(after, 0.0, after)
    damper = damping * rate * onset(after, before)
    damper = where_negative(damper + spring, -spring, damper)
    damper = where_negative(-after, damper, 0.0)
    return spring + stiffness * edge(after, before), damper
