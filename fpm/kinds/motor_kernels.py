"""Moments, energies and work of motors that prescribe openings (theory: motor.py)."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import curve_value
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kinds.damped_opening_kernels import rate
from fpm.kinds.opening_kernels import NOW, Openings, turn

# Constants of a motor.
STIFFNESS, DAMPING, START, TURN = 0, 1, 2, 3

# Of a motor, at the last forces and a step before.
OFF = 0  # target less opening
CHANGE = 1  # of that, over the last step
TARGET, TARGET_BEFORE = 2, 3
MOMENT, MOMENT_BEFORE = 4, 5
VISCOUS, VISCOUS_BEFORE = 6, 7  # its part by damping
STATE = 8


class Motors(NamedTuple):
    """on (m,) hinges; curve (m,); motors (m, 4, lanes): stiffness (N m/rad), damping (N m s/rad),
    start, turn (rad); now (m, STATE, lanes); given, taken: numbers of the accounts of work and
    loss; rows (m, 1, lanes); track ((instants + 1) m, 1, lanes) recorded moment (N m).
    """

    on: np.ndarray
    curve: np.ndarray
    motors: np.ndarray
    now: np.ndarray
    openings: Openings
    given: int
    taken: int
    rows: np.ndarray
    track: np.ndarray


@hook(Motors)
def forces(part, world, now):
    """Moments towards the targets."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        for k in (TARGET, MOMENT, VISCOUS):
            store(part.now, i, k + 1, load(part.now, i, k))
        factor = curve_value(world, part.curve[i], now.time)
        target = load(part.motors, i, START) + factor * load(part.motors, i, TURN)
        off = target - load(part.openings.angles, h, NOW)
        change = off - load(part.now, i, OFF)
        if now.time == 0.0:
            change = 0.0 * off
        speed = rate(now.step, change, load(part.now, i, CHANGE))
        viscous = load(part.motors, i, DAMPING) * speed
        moment = load(part.motors, i, STIFFNESS) * off + viscous
        store(part.now, i, OFF, off)
        store(part.now, i, CHANGE, change)
        store(part.now, i, TARGET, target)
        store(part.now, i, MOMENT, moment)
        store(part.now, i, VISCOUS, viscous)
        turn(part.openings, world.state, h, moment)


@hook(Motors)
def work_before(part, world, now):
    """Work of the motors over the step up to now, and what their drive trains lost.

    By the trapezium rule, as the moments do it on the hinges: so the balance has no error of it.
    """
    given = load(world.accounts, 0, part.given)
    taken = load(world.accounts, 0, part.taken)
    for i in range(part.on.shape[0]):
        way = load(part.now, i, TARGET) - load(part.now, i, TARGET_BEFORE)
        given = given + 0.5 * way * (load(part.now, i, MOMENT) + load(part.now, i, MOMENT_BEFORE))
        viscous = load(part.now, i, VISCOUS) + load(part.now, i, VISCOUS_BEFORE)
        taken = taken + 0.5 * load(part.now, i, CHANGE) * viscous
    store(world.accounts, 0, part.given, given)
    store(world.accounts, 0, part.taken, taken)


@hook(Motors)
def energy_of(part, world, i):
    """Energy of the drive train of motor i (J)."""
    off = load(part.now, i, OFF)
    return 0.5 * load(part.motors, i, STIFFNESS) * off * off


@hook(Motors)
def record(part, world, row):
    """The moments."""
    count = part.on.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.now, i, MOMENT))
