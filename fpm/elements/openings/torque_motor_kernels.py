"""Moments and work of torque motors (theory: torque_motor.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import follow_rate
from fpm.elements.openings.motor_kernels import MOMENT, MOMENT_BEFORE
from fpm.elements.openings.motor_kernels import TRACK as TRACK
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.curves import curve_value, kick_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store, where_negative
from fpm.kernels.vectors import kernel

NUMBERS = "torque", "no_load"
TORQUE, NO_LOAD = range(2)

# Of a motor: moments, at the last forces and a step before, means over the kicks there; and at the
# instant of the last forces.
AT_INSTANT = 2
STATE = 3


class TorqueMotors(NamedTuple):
    """Arrays of all m torque motors (lanes: samples)."""

    hinge: np.ndarray  # (m,) index of its hinge
    curve: np.ndarray  # (m,) of its curve of time; -1: constant 1
    numbers: np.ndarray  # (m, 2, lanes) torque (N m), no-load speed (rad/s)
    rates: np.ndarray  # (m, 2, lanes) rate of the hinge (rad/s) in the last step, and 0
    state: np.ndarray  # (m, STATE, lanes) N m
    openings: Openings  # of all hinges
    work_account: int  # index of their work in World.accounts
    track: np.ndarray  # ((instants + 1) m, 1, lanes) recorded moment (N m)


@kernel
def reduced_torque(torque, speed, no_load):
    """Return the moment (N m) that is left of a torque (N m, lanes) at a speed (rad/s) of the
    hinge: none from its no-load speed no_load (rad/s) on, and all against its direction."""
    factor = 1.0 - where_negative(torque, -speed, speed) / no_load
    factor = where_negative(factor, 0.0, factor)
    return torque * where_negative(1.0 - factor, 1.0, factor)


@hook(TorqueMotors)
def forces(part, world, timing):
    """Add the moments (N m) of torque motors, which fall with the speed in their direction."""
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        speed = follow_rate(part.openings, part.rates, i, h, timing)
        torque, no_load = load(part.numbers, i, TORQUE), load(part.numbers, i, NO_LOAD)
        moment = reduced_torque(kick_mean(world, part.curve[i], timing) * torque, speed, no_load)
        torque = curve_value(world, part.curve[i], timing.time) * torque
        store(part.state, i, AT_INSTANT, reduced_torque(torque, speed, no_load))
        store(part.state, i, MOMENT_BEFORE, load(part.state, i, MOMENT))
        store(part.state, i, MOMENT, moment)
        turn(part.openings, world.state, h, moment)


@hook(TorqueMotors)
def work_before(part, world, timing):
    work = load(world.accounts, 0, part.work_account)
    for i in range(part.hinge.shape[0]):
        moment, h = load(part.state, i, MOMENT) + load(part.state, i, MOMENT_BEFORE), part.hinge[i]
        angle = load(part.openings.angles, h, NEW) - load(part.openings.angles, h, OLD)
        work = work + 0.5 * angle * moment
    store(world.accounts, 0, part.work_account, work)


@hook(TorqueMotors)
def record(part, world, row):
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.state, i, AT_INSTANT))
