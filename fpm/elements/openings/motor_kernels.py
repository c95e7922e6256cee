"""Moments, energies and work of motors that prescribe openings (theory: motor.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import follow_rate
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.curves import travel_factor
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store

# Constants of a motor.
NUMBERS = "stiffness", "damping", "start", "turn"
STIFFNESS, DAMPING, START, TURN = range(4)

# Of a motor, at the last forces and a step before.
MOMENT, MOMENT_BEFORE = 0, 1
VISCOUS, VISCOUS_BEFORE = 2, 3  # its part by damping
ERROR = 4  # target less opening
ADVANCE = 5  # of the target over the last step
TARGET = 6
STATE = 7

TRACK = 1


class Motors(NamedTuple):
    """Arrays of all m motors (lanes: samples). hinge (m,): index of its hinge; curve (m,): index of
    its curve of time, -1: constant 1; by_rate (m,): 1 where the curve gives the rate; numbers (m,
    4, lanes): stiffness (N m/rad), damping (N m s/rad), start, turn (rad); rates (m, 2, lanes):
    first, rate of the last step; state (m, 7, lanes): moment, a step ago, moment of damping, a step
    ago (N m), target less opening, change of the target, target (rad); openings: joint coordinates
    of all hinges; work_account, loss_account: indices in World.accounts of work and loss; rows (m,
    1, lanes): energy of each; track ((instants + 1) m, 1, lanes): recorded moment (N m)."""

    hinge: np.ndarray
    curve: np.ndarray
    by_rate: np.ndarray
    numbers: np.ndarray
    rates: np.ndarray
    state: np.ndarray
    openings: Openings
    work_account: int
    loss_account: int
    rows: np.ndarray
    track: np.ndarray


@hook(Motors)
def forces(part, world, timing):
    """Add the moments (N m) of the motors' drive trains, towards the prescribed joint coordinates,
    to the forces on particles; keep moments and targets in part.state. part: arrays of all motors
    (Motors); world (World): solver state, whose forces change; timing (StepTime): times (s)."""
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        for k in (MOMENT, VISCOUS):
            store(part.state, i, k + 1, load(part.state, i, k))
        distance = travel_factor(world, part.curve[i], part.by_rate[i], timing.time)
        target = load(part.numbers, i, START) + distance * load(part.numbers, i, TURN)
        error = target - load(part.openings.angles, h, NEW)
        advance = target - load(part.state, i, TARGET)
        if timing.time == 0.0:
            advance = 0.0 * error
        # The target's rate as the opening's: what it lacks at the start, the step after makes up.
        target_rate = (1.0 / timing.step) * (1.5 * advance - 0.5 * load(part.state, i, ADVANCE))
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        viscous = load(part.numbers, i, DAMPING) * (target_rate - rate)
        moment = load(part.numbers, i, STIFFNESS) * error + viscous
        store(part.state, i, ERROR, error)
        store(part.state, i, ADVANCE, advance)
        store(part.state, i, TARGET, target)
        store(part.state, i, MOMENT, moment)
        store(part.state, i, VISCOUS, viscous)
        turn(part.openings, world.state, h, moment)


@hook(Motors)
def work_before(part, world, timing):
    """Add to World.accounts the work (J) of the motors, and the losses (J) of their drive trains,
    in the step that ends at timing.time: means of the moments at both ends times the way, which is
    what the moments do on the hinges, so that the balance has no error of it. part: arrays of all
    motors (Motors); world (World): solver state; timing (StepTime): times of the step (s)."""
    work = load(world.accounts, 0, part.work_account)
    loss = load(world.accounts, 0, part.loss_account)
    for i in range(part.hinge.shape[0]):
        advance, h = load(part.state, i, ADVANCE), part.hinge[i]
        angle = load(part.openings.angles, h, NEW) - load(part.openings.angles, h, OLD)
        moment = load(part.state, i, MOMENT) + load(part.state, i, MOMENT_BEFORE)
        work = work + 0.5 * advance * moment
        viscous = load(part.state, i, VISCOUS) + load(part.state, i, VISCOUS_BEFORE)
        loss = loss + 0.5 * (advance - angle) * viscous
    store(world.accounts, 0, part.work_account, work)
    store(world.accounts, 0, part.loss_account, loss)


@hook(Motors)
def energy_of(part, world, i):
    """Return the strain energy (J, lanes) of the drive train of motor i when forces were last
    computed. part: arrays of all motors (Motors); world: not used."""
    error = load(part.state, i, ERROR)
    return 0.5 * load(part.numbers, i, STIFFNESS) * error * error


@hook(Motors)
def record(part, world, row):
    """Record the moment (N m) of each motor on its hinge in part.track. part: arrays of all motors
    (Motors or TorqueMotors); world: not used; row: index of the recorded instant."""
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.state, i, MOMENT))
