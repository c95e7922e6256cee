"""Rates, losses and zero crossings that dissipative elements on joint openings share."""

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
    """Where friction finds the force in its joint: impulses of joints in the last step. lone (f,):
    index of the hinge of each of f friction elements among hinges solved alone, or -1; first, count
    (f,): its rows among joints solved together."""

    share: np.ndarray  # (f, 1, lanes) what counts of each N; 0: not this one
    lone: np.ndarray  # (f,)
    first: np.ndarray  # (f,)
    count: np.ndarray  # (f,)
    hinges: np.ndarray  # (h, SUMS, lanes)
    rows: np.ndarray  # (r, ROW, lanes)
    impulses: np.ndarray  # (r, 1, lanes)


@kernel
def half_rate(openings, h, timing):
    """Rate (rad/s, m/s) of opening h at the middle of the step that ends now. openings: arrays of
    all openings (Openings); h: index of the hinge; timing: times of the step (s)."""
    angles = openings.angles
    return (load(angles, h, NEW) - load(angles, h, OLD)) * (1.0 / timing.step)


@kernel
def follow_rate(openings, history, i, h, timing):
    """Rate (rad/s, m/s) of opening h now, for element i, extrapolated from the last two steps to
    second order.

    The middles of the steps lie half a step and one and a half behind (Adams and Bashforth).
    openings: arrays of all openings (Openings); history (elements, HISTORY, lanes): of the
    element's type, whose RATE is updated, so once a step; h: index of the hinge; timing: times of
    the step (s).
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
    """Add to an account the energy (J) that a moment (N m) on hinge h takes out in the step that
    ends now.

    moment: on the second particle, now; history, i: row of the element, with its moment a step ago;
    account: index in World.accounts; openings: arrays of all openings (Openings). The trapezium
    rule is what leapfrog does: kinetic energy of the half steps before and after (record.py)
    changes by just that, so that no order of the step is left in the balance.
    """
    angles = openings.angles
    angle = load(angles, h, NEW) - load(angles, h, OLD)
    loss = -0.5 * (moment + load(history, i, LOSS)) * angle
    store(history, i, LOSS, moment)
    store(world.accounts, 0, account, load(world.accounts, 0, account) + loss)


@kernel
def force_of(bearing, i, timing):
    """Size (N, lanes) of the constraint force in the joint of friction element i, as a mean over
    the last step. bearing: impulses of joints (JointForce); timing: times of the step (s)."""
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
    """Correction of the overlap `new` of a spring that begins at zero, in the step in which zero
    was crossed; else 0. new, old: overlap now and a step ago, in one unit.

    On the way from -b to s such a spring does k s²/2, but the forces k s and 0 at the ends do k s
    (s + b)/2. Half of the difference is taken off at the later step, and again by the step that
    follows.
    """
    product = new * old
    return where_negative(product, 0.5 * product / absolute(new - old), 0.0)


@kernel
def onset(new, old):
    """Fraction, up to 3/2, of a step's impulse that a force gives which jumps from 0 to its full
    size where zero is crossed; 1 where nothing is crossed. new, old: the crossing value now and a
    step ago.

    The impulse at an instant is that of half a step on either side; the force acts for half a step
    and s/(s + b) of one, s and b being the sizes of new and old.
    """
    product = new * old
    return where_negative(product, 0.5 + absolute(new) / absolute(new - old), 1.0)


@kernel
def press(new, old, rate, stiffness, damping):
    """Forces of the spring and of the damper of a one-sided stop, at least 0 in sum, where the
    overlap `new` is above 0; the damper's is 0 elsewhere.

    new, old: overlap (rad, m) now and a step ago; rate: its rate now; stiffness (N m/rad), damping
    (N m s/rad), on slides in N/m, N s/m. The damper never pulls: it takes off at most the force of
    the spring.
    """
    spring = stiffness * where_negative(new, 0.0, new)
    damper = damping * rate * onset(new, old)
    damper = where_negative(damper + spring, -spring, damper)
    damper = where_negative(-new, damper, 0.0)
    return spring + stiffness * edge(new, old), damper
