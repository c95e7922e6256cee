"""Forces, energies, losses and events of pins with play (theory: journal.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.cables.cable_kernels import TINY
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, load, sqrt, store, where_negative
from fpm.kernels.record import edge, note_crossings
from fpm.kernels.vectors import kernel, larger
from fpm.kernels.world import Log

# Constants of a pin: of the press, then of the friction.
CLEARANCE, LOAD, PER_DEPTH, HERTZ, HYSTERESIS = range(5)
FRICTION, RADIUS, STIFFNESS, DAMPING, SOFTNESS = range(5, 10)
NUMBERS = 10

# Of a pin at the last positions; rates are those in the middle of the last step, at first those at
# the start. SPEED is the largest of the eccentricity since it touched.
RATE, SLIP_RATE, SPEED, DAMPER, BEND, DRAG, FORCE = range(7)
STATE = 7
TRACK = 2

TOUCH = 1e-6
"""Share of its depth at `load` from which a pin counts as touching."""


class Journals(NamedTuple):
    """Arrays of all p pins with play (lanes: samples); what stands in `numbers` and `state` is told
    above."""

    hinge: np.ndarray  # (p,) index of the turn of its joint, after which come x and y
    numbers: np.ndarray  # (p, NUMBERS, lanes) m, N, 1/m, 1, 1; 1, m, N/m, N s/m, m/N
    state: np.ndarray  # (p, STATE, lanes) m/s, m/s, m/s, N, m, N, N
    openings: Openings  # of all joints
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (p, 1, lanes) energy of each (J)
    peaks: np.ndarray  # (1, 1, lanes) largest force over load
    log: Log
    track: np.ndarray  # ((instants + 1) p, TRACK, lanes) force (N), eccentricity (m)


@kernel
def eccentricity(part, i, field):
    """Return the distance (m, lanes) of pin i from its bearing's axis. field: NEW or OLD."""
    h, angles = part.hinge[i], part.openings.angles
    x, y = load(angles, h + 1, field), load(angles, h + 2, field)
    return sqrt(x * x + y * y)


@kernel
def depth_of(part, i):
    """Return two lanes: how deep pin i is in its bearing, at least 0, over its depth at `load`; and
    the factor on that in the force over load: its root by Hertz's law, else 1. part: Journals."""
    depth = eccentricity(part, i, NEW) - load(part.numbers, i, CLEARANCE)
    ratio = load(part.numbers, i, PER_DEPTH) * where_negative(depth, 0.0, depth)
    hertz = load(part.numbers, i, HERTZ)
    return ratio, hertz * sqrt(ratio) + (1.0 - hertz)


@kernel
def extrapolate(part, i, field, change, timing):
    """Return a rate (m/s) of pin i now, from its mean rates in the last two steps. field: of the
    state, RATE or SLIP_RATE; change: in the step (m)."""
    rate = load(part.state, i, field)
    if timing.time > 0.0:
        half = (1.0 / timing.step) * change
        store(part.state, i, field, half)
        rate = 1.5 * half - 0.5 * rate
    return rate


@kernel
def press(part, i, change, timing):
    """Return two forces (N) that push pin i to its bearing's axis, at least 0; the first is
    corrected by `edge` in the step in which a linear pin leaves. change: of the eccentricity in the
    step (m)."""
    rate = extrapolate(part, i, RATE, change, timing)
    ratio, root = depth_of(part, i)
    spring, size = load(part.numbers, i, LOAD) * ratio * root, absolute(rate)
    speed = where_negative(-ratio, larger(load(part.state, i, SPEED), size), 0.0)
    damper = load(part.numbers, i, HYSTERESIS) * spring * rate / (speed + TINY)
    damper = where_negative(spring + damper, -spring, damper)
    store(part.state, i, SPEED, speed)
    store(part.state, i, DAMPER, damper)
    clearance, stiffness = load(part.numbers, i, CLEARANCE), load(part.numbers, i, LOAD)
    stiffness = (1.0 - load(part.numbers, i, HERTZ)) * stiffness * load(part.numbers, i, PER_DEPTH)
    depth, old = eccentricity(part, i, NEW) - clearance, eccentricity(part, i, OLD) - clearance
    return spring + damper + stiffness * edge(depth, old), spring + damper


@kernel
def _limit(value, most):
    """Return lanes of `value`, or of ± `most` where it is larger."""
    return where_negative(value + most, -most, where_negative(most - value, most, value))


@kernel
def rub(part, i, slip, normal, timing):
    """Return the force (N) of friction by the `slip` in the step (m), limited by `normal` (N): a
    damped spring (bristle) whose end slides where its bend or its force would be too large."""
    rate = extrapolate(part, i, SLIP_RATE, slip, timing)
    bend = _limit(load(part.state, i, BEND) + slip, load(part.numbers, i, SOFTNESS) * normal)
    drag = load(part.numbers, i, STIFFNESS) * bend + load(part.numbers, i, DAMPING) * rate
    drag = _limit(drag, load(part.numbers, i, FRICTION) * normal)
    store(part.state, i, BEND, bend)
    store(part.state, i, DRAG, drag)
    return drag


@hook(Journals)
def forces(part, world, timing):
    loss = load(world.accounts, 0, part.account)
    for i in range(part.hinge.shape[0]):
        h, angles, state = part.hinge[i], part.openings.angles, part.state
        stiffness = load(part.numbers, i, STIFFNESS)
        damper, bend, drag = load(state, i, DAMPER), load(state, i, BEND), load(state, i, DRAG)
        x, old_x = load(angles, h + 1, NEW), load(angles, h + 1, OLD)
        y, old_y = load(angles, h + 2, NEW), load(angles, h + 2, OLD)
        distance = eccentricity(part, i, NEW)
        change = distance - eccentricity(part, i, OLD)
        radius, mean_x, mean_y = load(part.numbers, i, RADIUS), x + old_x, y + old_y
        sweep = mean_x * (y - old_y) - mean_y * (x - old_x)
        slip = sweep / (sqrt(mean_x * mean_x + mean_y * mean_y) + TINY)
        slip = slip + radius * (load(angles, h, NEW) - load(angles, h, OLD))
        force, normal = press(part, i, change, timing)
        friction = rub(part, i, slip, normal, timing)
        new = load(state, i, BEND)
        loss = loss + 0.5 * (damper + load(state, i, DAMPER)) * change
        loss = loss + 0.5 * (drag + friction) * slip - 0.5 * stiffness * (new * new - bend * bend)
        store(state, i, FORCE, normal)
        relative = normal / load(part.numbers, i, LOAD)
        store(part.peaks, 0, 0, larger(load(part.peaks, 0, 0), relative))
        x, y = x / (distance + TINY), y / (distance + TINY)
        turn(part.openings, world.state, h + 1, friction * y - force * x)
        turn(part.openings, world.state, h + 2, -1.0 * friction * x - force * y)
        turn(part.openings, world.state, h, -1.0 * radius * friction)
    store(world.accounts, 0, part.account, loss)


@hook(Journals)
def note_events(part, world, timing):
    """Note which pins touched (event 1) or left (0) their bearings in the step."""
    for i in range(part.hinge.shape[0]):
        start = load(part.numbers, i, CLEARANCE) + TOUCH / load(part.numbers, i, PER_DEPTH)
        old, new = eccentricity(part, i, OLD), eccentricity(part, i, NEW)
        note_crossings(part.log, i, start - old, start - new, timing)


@hook(Journals)
def energy_of(part, world, i):
    ratio, root = depth_of(part, i)
    bend, hertz = load(part.state, i, BEND), load(part.numbers, i, HERTZ)
    energy = load(part.numbers, i, LOAD) / load(part.numbers, i, PER_DEPTH) * ratio * ratio * root
    energy = (0.5 - 0.1 * hertz) * energy
    return energy + 0.5 * load(part.numbers, i, STIFFNESS) * bend * bend


@hook(Journals)
def record(part, world, row):
    count = part.hinge.shape[0]
    for i in range(count):
        store(part.track, row * count + i, 0, load(part.state, i, FORCE))
        store(part.track, row * count + i, 1, eccentricity(part, i, NEW))
