"""Catching, moments, energies, losses and events of latches."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import RATE, edge, follow_rate, lose, onset, press
from fpm.elements.openings.opening_kernels import BEFORE, NOW, Openings, turn
from fpm.kernels.events import note
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

# Constants of a latch; FROM is the sign of the rate with which it can be caught, 0 for both;
# ONE_SIDED is -1 where it is, and 1 elsewhere.
NUMBERS = "angle", "tolerance", "side", "fastest", "stiffness", "damping", "one_sided"
ANGLE, TOLERANCE, FROM, FASTEST, STIFFNESS, DAMPING, ONE_SIDED = range(7)

# State of a latch.
CAUGHT = 0  # 1 once it has
HELD = 1  # opening at which it holds
WAY = 2  # sign of the rate when it caught
NEWS = 3  # of this step: 1 caught, 2 missed
WHEN = 4  # time of that
RATE_THERE = 5  # rate of the opening when it caught
MOMENT, IMPULSE = 6, 7  # on the hinge's second particle
STATE = 8

TRACK = 3  # recorded: moment, impulse, rate when it caught

NEAR = 1e-6
"""Openings (rad) beyond the tolerance that are looked at one by one; only to save time."""


class Latches(NamedTuple):
    """on (l,) hinges; numbers (l, 7, lanes); past (l, PAST, lanes); state (l, STATE, lanes)."""

    on: np.ndarray
    numbers: np.ndarray
    openings: Openings
    past: np.ndarray
    state: np.ndarray
    account: int
    rows: np.ndarray
    log: Log
    track: np.ndarray  # ((instants + 1) l, TRACK, lanes)


@kernel
def watch(part, i, h, timing):
    """Catch the opening of latch i in the lanes where it has come by in this step."""
    angles = part.openings.angles
    reach = reached(part, i, load(angles, h, BEFORE), load(angles, h, NOW))
    if any_negative(where_negative(0.5 - load(part.state, i, CAUGHT), 1.0, reach)):
        for s in range(angles.shape[2]):
            if part.state[i, CAUGHT, s] == 0.0:
                before, after = angles[h, BEFORE, s], angles[h, NOW, s]
                pass_by(part, i, s, before, after, part.past[i, RATE, s], timing.time, timing.step)


@kernel
def reached(part, i, before, after):
    """Below zero where latch i must be looked at on the way from an opening to another (rad)."""
    off = absolute(0.5 * (after + before) - load(part.numbers, i, ANGLE))
    return off - 0.5 * absolute(after - before) - load(part.numbers, i, TOLERANCE) - NEAR


@kernel
def pass_by(part, i, s, before, after, earlier, end, step):
    """Whether lane s of latch i catches or misses on the way of a step, and where.

    before, after: the opening at its beginning and end (rad); earlier: its rate in the step before;
    end: of the step (s). The way is taken as straight; what is called first and last counts from
    the edge of the tolerance that is met first.
    """
    angle, tolerance = part.numbers[i, ANGLE, s], part.numbers[i, TOLERANCE, s]
    moved = after - before
    if part.numbers[i, FROM, s] * moved < 0.0:
        return
    way = -1.0 if moved < 0.0 else 1.0
    first, last = way * (before - angle) + tolerance, way * (after - angle) + tolerance
    entered = first < 0.0 and last >= 0.0
    if not (entered or (tolerance > 0.0 and 0.0 <= first <= 2.0 * tolerance)):
        return
    share = -first / (last - first) if entered else 1.0
    half = moved / step
    rate = half + (share - 0.5) * (half - earlier)
    if abs(rate) <= part.numbers[i, FASTEST, s]:
        place = 0.0 if entered else min(last, 2.0 * tolerance)
        part.state[i, CAUGHT, s] = 1.0
        part.state[i, HELD, s] = angle + way * (place - tolerance)
        part.state[i, WAY, s] = way
        part.state[i, NEWS, s] = 1.0
        part.state[i, WHEN, s] = end - (1.0 - share) * step
        part.state[i, RATE_THERE, s] = rate
    elif last > 2.0 * tolerance or tolerance == 0.0:
        left = (2.0 * tolerance - first) / (last - first)
        part.state[i, NEWS, s] = 2.0
        part.state[i, WHEN, s] = end - (1.0 - left) * step


@kernel
def beyond(part, i, when):
    """How far (rad) the opening is beyond where latch i holds; `when` NOW or BEFORE."""
    off = load(part.openings.angles, part.on[i], when) - load(part.state, i, HELD)
    return load(part.state, i, WAY) * off


@kernel
def hold(part, i, rate):
    """What the spring and the damper of latch i, if it holds, do on the way it came."""
    stiffness, damping = load(part.numbers, i, STIFFNESS), load(part.numbers, i, DAMPING)
    fresh = 0.5 - load(part.state, i, NEWS)  # < 0 in the step in which it caught
    now, before = beyond(part, i, NOW), beyond(part, i, BEFORE)
    # Both ways: it begins where it caught. One-sided: the other way, from the step after.
    began, going = where_negative(fresh, before, now), where_negative(fresh, now, before)
    spring = -1.0 * stiffness * (now + edge(now, began))
    damper = -1.0 * damping * rate * onset(now, began)
    push, resist = press(-1.0 * now, -1.0 * going, -1.0 * rate, stiffness, damping)
    one_sided, caught = load(part.numbers, i, ONE_SIDED), 0.5 - load(part.state, i, CAUGHT)
    spring = where_negative(caught, where_negative(one_sided, push, spring), 0.0)
    damper = where_negative(caught, where_negative(one_sided, resist, damper), 0.0)
    return spring, damper


@hook(Latches)
def forces(part, world, timing):
    """Moments of the latches that hold, those that have just caught among them."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        if timing.time > 0.0:
            watch(part, i, h, timing)
        rate = follow_rate(part.openings, part.past, i, h, timing)
        way = load(part.state, i, WAY)
        spring, damper = hold(part, i, way * rate)
        moment = way * (spring + damper)
        turn(part.openings, world.state, h, moment)
        lose(world, part.account, part.openings, part.past, i, h, way * damper)
        given = 0.5 * timing.step * (moment + load(part.state, i, MOMENT))
        store(part.state, i, IMPULSE, load(part.state, i, IMPULSE) + given)
        store(part.state, i, MOMENT, moment)


@hook(Latches)
def note_events(part, world, timing):
    """Note the latches that caught or missed since the last step."""
    for i in range(part.on.shape[0]):
        if any_negative(0.5 - load(part.state, i, NEWS)):
            for s in range(part.state.shape[2]):
                news = part.state[i, NEWS, s]
                if news > 0.0:
                    note(part.log, s, part.state[i, WHEN, s], i, news - 1.0)
        store(part.state, i, NEWS, 0.0)


@hook(Latches)
def energy_of(part, world, i):
    """Energy of latch i (J)."""
    off = beyond(part, i, NOW)
    one_sided = where_negative(off, off, 0.0)
    off = where_negative(load(part.numbers, i, ONE_SIDED), one_sided, off)
    energy = 0.5 * load(part.numbers, i, STIFFNESS) * off * off
    return where_negative(0.5 - load(part.state, i, CAUGHT), energy, 0.0)


@hook(Latches)
def record(part, world, row):
    """Moment, impulse, and rate when it caught."""
    count = part.on.shape[0]
    for i in range(count):
        for k, field in enumerate((MOMENT, IMPULSE, RATE_THERE)):
            store(part.track, row * count + i, k, load(part.state, i, field))
