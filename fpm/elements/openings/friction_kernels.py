"""Moments, energies and losses of friction (theory: friction.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import LOSS, JointForce, add_loss, follow_rate, force_of
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.events import edge
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, load, store, where_negative
from fpm.kernels.vectors import kernel, larger

STIFFNESS, BEND, DAMPING, INVERSE_BEND = range(4)  # the last: 1/bend where it goes with the force

ANGLE, SLOPE = 0, 1  # of a point: where, and by how much the slope of the bend changes there

FOOT = 0  # opening at which the bristle is straight
BENDING = 1  # by how much it is bent
MOST = 2  # and by how much it could be, where that goes with the joint's force
LEAST = 3  # the least that it was bent since it slipped,
BASE = 4  # and by how much it could be then
LOCK_RATIO = 5  # by how many times its bend it was bent on while that grew as much, at most
OLD_MOST = 6  # MOST a step before it,
FORCE_BEND = 7  # and by how much it could be by the joint's force as it came out with that
STATE = 8

STEEP = 0.5
"""By how much of a change of friction the force that the joint bears may change the other way, a
step later, before the next one is found by the secant of both."""


class Frictions(NamedTuple):
    """Arrays of all f friction elements (lanes: samples). hinge (f,): index of its hinge; numbers
    (f, 4, lanes): bristle stiffness (N m/rad), deflection at slip (rad), damping (N m s/rad),
    1/deflection where the joint's force counts, else 0; openings: joint coordinates; rates (f, 2,
    lanes): their rate and damper's moment of the last step; state (f, 8, lanes): foot (coordinate,
    rad, of the straight bristle), deflection (rad), then what joint forces and self-locking need;
    account: index of the loss in World.accounts; rows (f, 1, lanes): energy or self-locking of
    each; peaks: largest self-locking; start (f + 1,): first point of its table; points (p, 2,
    lanes): angle (rad) and change of slope of all points; bearing: joint forces. None: unused."""

    hinge: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rates: np.ndarray
    state: np.ndarray
    account: int
    rows: np.ndarray
    peaks: np.ndarray  # (1, 1, lanes)
    start: np.ndarray | None = None  # (f + 1,) where the points of each begin,
    points: np.ndarray | None = None  # (p, 2, lanes), where the bend goes by a table
    bearing: JointForce | None = None


@kernel
def bend_at(points, start, i, most, psi):
    """Return the bristle deflection (rad, lanes) at which friction element i slips at joint
    coordinate psi (rad, lanes), linear between the points of its table. points (p, 2, lanes):
    coordinate (rad) and change of slope there, of all tables; start: index of each element's first
    point; both None: no tables; most: deflection (rad, lanes) below the table's first point."""
    if points is not None:
        for j in range(start[i], start[i + 1]):
            ramp = psi - load(points, j, ANGLE)
            most = most + load(points, j, SLOPE) * where_negative(ramp, 0.0, ramp)
    return most


@kernel
def bend_by_force(bearing, state, i, timing, resistance):
    """Return two bristle deflections (rad) at which element i slips by the force of its joint: now
    and a step ago. bearing: forces of joints (JointForce); state (f, 8, lanes): Frictions.state, in
    which MOST, OLD_MOST and FORCE_BEND are updated; timing (StepTime): times of the step (s);
    resistance: World.resistance. Where friction relieves its own joint by more than itself (beyond
    the angle of self-locking), taking the force of the step before would grow from step to step;
    the secant of the last two steps finds the force that agrees with its own friction."""
    last = load(state, i, MOST)
    most = last
    if timing.time > 0.0:
        result = load(bearing.share, i, 0) * force_of(bearing, i, timing, resistance)
        change = last - load(state, i, OLD_MOST)
        answer = result - load(state, i, FORCE_BEND)
        steep = (answer + STEEP * change) * change  # < 0: the answer is steep, and the other way
        safe = where_negative(steep, change - answer, 1.0 + 0.0 * change)
        secant = last + (result - last) * change / safe
        most = where_negative(steep, secant, result)
        store(state, i, OLD_MOST, last)
        store(state, i, FORCE_BEND, result)
    store(state, i, MOST, most)
    return most, last


@kernel
def slip_deflections(bearing, part, i, psi, psi_before, timing, resistance):
    """Return two bristle deflections (rad, lanes) at which friction element i slips: now and a step
    ago. Each is the element's own, plus what its table adds at that joint coordinate, psi now and
    psi_before a step ago (rad), plus what the joint's force adds. bearing: forces of joints
    (JointForce), None where none counts; part: all friction (Frictions); timing: StepTime (s);
    resistance: World.resistance."""
    first = load(part.numbers, i, BEND)
    most = bend_at(part.points, part.start, i, first, psi)
    last = bend_at(part.points, part.start, i, first, psi_before)
    if bearing is not None:
        by_force = bend_by_force(bearing, part.state, i, timing, resistance)
        most, last = most + by_force[0], last + by_force[1]
    return most, last


@kernel
def watch_lock(part, i, bend, most, slips):
    """Measure self-locking of friction element i: by how much its bristle's deflection `bend` (rad)
    grew without slip while the deflection `most` (rad), at which it slips, grew as fast. The
    growth, over the deflection at slip, raises LOCK_RATIO in part.state and part.peaks if larger.
    part: all friction elements (Frictions); slips: below 0 in lanes where it slips now. It counts
    from the least `bend` since the last slip, once the bristle was bent by one deflection more."""
    state, per_bend = part.state, load(part.numbers, i, INVERSE_BEND)
    size, least = absolute(bend), load(state, i, LEAST)
    least = where_negative(slips, size, where_negative(size - least, size, least))
    growth = size - least
    start = where_negative(slips, -1.0, per_bend * growth - 1.0)
    base = where_negative(start, most, load(state, i, BASE))
    lock = per_bend * where_negative(most - base - growth, 0.0, growth)
    store(state, i, LEAST, least)
    store(state, i, BASE, base)
    store(state, i, LOCK_RATIO, larger(load(state, i, LOCK_RATIO), lock))
    store(part.peaks, 0, 0, larger(load(part.peaks, 0, 0), lock))


@hook(Frictions)
def forces(part, world, timing):
    """Add the moments (N m) of friction, bristles and dampers, to the forces on particles, and what
    slip and dampers lose in the step (J) to World.accounts; update part.state. part: arrays of all
    friction elements (Frictions); world (World): solver state, changed; timing (StepTime): times of
    the step (s). Where slip begins within a step, the mean of the moments at both ends is not that
    over the way between; `edge` corrects it as for a spring that begins at the point of slip."""
    for i in range(part.hinge.shape[0]):
        h, last = part.hinge[i], load(part.state, i, BENDING)
        stiffness, foot = load(part.numbers, i, STIFFNESS), load(part.state, i, FOOT)
        psi, psi_before = load(part.openings.angles, h, NEW), load(part.openings.angles, h, OLD)
        most, old_most = slip_deflections(
            part.bearing, part, i, psi, psi_before, timing, world.resistance
        )
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        trial = psi - foot
        sign = where_negative(trial, -1.0, 0.0 * trial + 1.0)
        slips = most - absolute(trial)  # < 0 where it does
        bend = where_negative(slips, sign * most, trial)
        new_foot = where_negative(slips, psi - bend, foot)
        extra = -1.0 * stiffness * edge(-slips, sign * last - old_most)
        spring = -1.0 * (stiffness * bend + sign * extra)
        # The damper acts while it sticks, and takes the moment to M at most.
        damper = -1.0 * load(part.numbers, i, DAMPING) * rate
        room = stiffness * most
        upper, lower = room - spring, -1.0 * room - spring
        damper = where_negative(upper - damper, upper, damper)
        damper = where_negative(damper - lower, lower, damper)
        # Where the damper helped to bear M in the step before, less is missing.
        gain = -0.5 * sign * load(part.rates, i, LOSS)
        gain = where_negative(gain, 0.0, gain)
        gain = where_negative(extra - gain, extra, gain)
        damper = where_negative(slips, sign * gain, damper)
        turn(part.openings, world.state, h, spring + damper)
        add_loss(world, part.account, part.openings, part.rates, i, h, damper)
        loss = 0.5 * stiffness * (most + old_most) * absolute(new_foot - foot)
        store(world.accounts, 0, part.account, load(world.accounts, 0, part.account) + loss)
        if part.bearing is not None:
            watch_lock(part, i, bend, most, slips)
        store(part.state, i, FOOT, new_foot)
        store(part.state, i, BENDING, bend)


@hook(Frictions)
def energy_of(part, world, i):
    """Return the strain energy (J, lanes) of the bristle of friction element i. part: arrays of all
    friction elements (Frictions); world (World): solver state, not used."""
    bend = load(part.state, i, BENDING)
    return 0.5 * load(part.numbers, i, STIFFNESS) * bend * bend


@hook(Frictions)
def list_excess(part, world):
    """Once a run has failed, store in part.rows how far each friction element has locked itself
    (the growth of its bristle's deflection without slip, over the deflection at slip), to name the
    worst. part: arrays of all friction elements (Frictions); world: not used."""
    for i in range(part.hinge.shape[0]):
        store(part.rows, i, 0, load(part.state, i, LOCK_RATIO))
