"""Catching, moments, energies, losses and events of latches; what is theirs alone that hold exactly
is in joints/rigid_latch_kernels.py."""

from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import Turns
from fpm.elements.openings.losses_kernels import RATE, add_loss, follow_rate, onset, press
from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, store, where_negative
from fpm.kernels.record import edge, note
from fpm.kernels.vectors import kernel
from fpm.kernels.world import Log

# Constants of a latch; APPROACH is the sign of the rate with which it can be caught, 0 for both;
# ONE_SIDED is -1 where it is, and 1 elsewhere.
NUMBERS = "angle", "capture_range", "side", "max_capture_rate", "stiffness", "damping", "holds"
ANGLE, CAPTURE_RANGE, APPROACH, MAX_RATE, STIFFNESS, DAMPING, ONE_SIDED = range(7)

# State of a latch.
IS_CAUGHT = 0  # 1 once it has
HOLD_ANGLE = 1  # opening at which it holds
SIGN = 2  # sign of the rate when it caught
NEWS = 3  # of this step: 1 caught, 2 missed
CATCH_TIME = 4  # time of that
CATCH_RATE = 5  # rate of the opening when it caught
MOMENT, IMPULSE = 6, 7  # on the hinge's second particle
WORKS = 8  # of turn_kernels; it and those below: of latches that hold exactly
AGE = WORKS + 2  # steps in which it has held
IMPACT = AGE + 1  # impulse with which it caught
PREDICTION = IMPACT + 1  # opening that is foreseen for the end of this step
SEARCH_END = PREDICTION + 1  # opening up to which it has looked, as foreseen in the step before
SEARCH_SHARE = SEARCH_END + 1  # share of this step after which that is: others caught then
FREE_END = SEARCH_SHARE + 1  # opening that was foreseen for the end of the step in which it catches
CATCH_IMPULSE = FREE_END + 1  # that of the catch, by what it takes to hold it, 0: not known
STATE = CATCH_IMPULSE + 1

TRACK = 4  # recorded: moment, impulse, rate when it caught, impulse with which it caught

ANGLE_TOL = 1e-6
"""Openings (rad) beyond the reach that are looked at one by one; only to save time."""

AT_START = 1e-9
"""Openings (rad) beyond the reach that count as within it at the start of a run."""


class Latches(NamedTuple):
    """Arrays of all l latches (lanes: samples); what stands in `numbers`, `state` and `track` is
    told above."""

    hinge: np.ndarray  # (l,) index of its hinge
    turn: np.ndarray  # (l,) of its condition in turns.state; -1: it holds by a spring
    numbers: np.ndarray  # (l, 7, lanes) rad, rad, sign, rad/s, N m/rad, N m s/rad, sign
    openings: Openings  # of all hinges
    turns: Turns  # those held exactly
    rates: np.ndarray  # (l, 2, lanes) rate (rad/s) and damper's moment (N m) of the last step
    state: np.ndarray  # (l, STATE, lanes) rad, s, rad/s, N m, N m s, J
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (l, 1, lanes) energy of each (J)
    log: Log
    track: np.ndarray  # ((instants + 1) l, TRACK, lanes) N m, N m s, rad/s, N m s


@kernel
def watch(part, i, h, timing):
    """Find out whether latch i on hinge h catches or misses in the step that ends now, where it has
    not caught yet. It catches within its capture range if no faster than its largest rate, and
    misses where it leaves that range faster."""
    angles = part.openings.angles
    reach = reach_of(part, i, load(angles, h, OLD), load(angles, h, NEW))
    if any_negative(where_negative(0.5 - load(part.state, i, IS_CAUGHT), 1.0, reach)):
        for s in range(angles.shape[2]):
            if part.state[i, IS_CAUGHT, s] == 0.0:
                start, end = angles[h, OLD, s], angles[h, NEW, s]
                pass_by(part, i, s, start, end, part.rates[i, RATE, s], timing.time, timing.step)


@kernel
def reach_of(part, i, start, end):
    """Return by how far (rad) coordinates from `start` to `end` stay clear of latch i's range."""
    distance = absolute(0.5 * (end + start) - load(part.numbers, i, ANGLE))
    return distance - 0.5 * absolute(end - start) - load(part.numbers, i, CAPTURE_RANGE) - ANGLE_TOL


@kernel
def pass_by(part, i, s, psi_start, psi_end, last_rate, end, step):
    """Decide whether latch i of sample s catches or misses in a step; write coordinate (rad), rate
    (rad/s) and time (s) of a catch to part.state, or that it missed.

    psi_start, psi_end: coordinate at both ends of the step (rad), linear between; last_rate: in the
    step before (rad/s); end: time of the step's end (s), 0 at the start of a run, where both
    coordinates are the same and the rate is `last_rate`; step: its length (s). `first` and `last`
    (rad) are measured from the edge of the capture range that is met first. The rate is linear
    through the middles of both steps: within the range it may fall to the largest one at which the
    latch catches, or reverse into its direction, at a share of the step."""
    angle, reach = part.numbers[i, ANGLE, s], part.numbers[i, CAPTURE_RANGE, s]
    approach, half = part.numbers[i, APPROACH, s], (psi_end - psi_start) / step
    if end == 0.0:
        half = last_rate
    sign = approach
    if approach == 0.0:
        sign = -1.0 if half < 0.0 else 1.0
    first, last = sign * (psi_start - angle) + reach, sign * (psi_end - angle) + reach
    is_entered = first < 0.0 and last >= 0.0 and end > 0.0
    is_inside = 0.0 <= first <= 2.0 * reach and reach > 0.0
    if end == 0.0:
        is_inside = -AT_START <= first <= 2.0 * reach + AT_START
    if not (is_entered or is_inside):
        return
    entry, change = -first / (last - first) if is_entered else 0.0, sign * (half - last_rate)
    if end < 1.5 * step:  # the last rate is that at the start, half a step before
        change *= 2.0
    entry_rate = sign * half + (entry - 0.5) * change
    rate = min(max(entry_rate, 0.0), part.numbers[i, MAX_RATE, s])
    wait = 0.0
    if rate != entry_rate:
        wait = (rate - entry_rate) / change if change != 0.0 else -1.0
    place = max(first, 0.0) + wait * (last - first)
    if end == 0.0:
        place = first
    if 0.0 <= wait <= 1.0 - entry and (end == 0.0 or 0.0 <= place <= 2.0 * reach):
        part.state[i, IS_CAUGHT, s] = 1.0
        part.state[i, HOLD_ANGLE, s] = angle + sign * (place - reach)
        part.state[i, SIGN, s] = sign
        part.state[i, NEWS, s] = 1.0
        part.state[i, CATCH_TIME, s] = end - (1.0 - entry - wait) * step if end > 0.0 else 0.0
        part.state[i, CATCH_RATE, s] = sign * rate
    elif last > max(first, 2.0 * reach) or (reach == 0.0 and entry_rate > 0.0):
        fraction = (2.0 * reach - first) / (last - first) if end > 0.0 else 1.0
        part.state[i, NEWS, s] = 2.0
        part.state[i, CATCH_TIME, s] = end - (1.0 - fraction) * step


@kernel
def excess(part, i, field):
    """Return how far (rad) latch i is beyond its catch, in its direction. field: NEW or OLD."""
    angle = load(part.openings.angles, part.hinge[i], field) - load(part.state, i, HOLD_ANGLE)
    return load(part.state, i, SIGN) * angle


@kernel
def hold(part, i, rate):
    """Return the moments (N m) of spring and damper of latch i, positive in the direction of its
    catch; 0 in lanes where it has not caught. rate: in that direction (rad/s)."""
    stiffness, damping = load(part.numbers, i, STIFFNESS), load(part.numbers, i, DAMPING)
    # < 0 in the step in which it caught, but for one that holds from the start on
    fresh = where_negative(-load(part.state, i, CATCH_TIME), 0.5 - load(part.state, i, NEWS), 0.5)
    gap, last = excess(part, i, NEW), excess(part, i, OLD)
    # Both ways: it begins where it caught. One-sided: the other way, from the step after.
    onset_gap, start_gap = where_negative(fresh, last, gap), where_negative(fresh, gap, last)
    spring = -1.0 * stiffness * (gap + edge(gap, onset_gap))
    damper = -1.0 * damping * rate * where_negative(fresh, onset(gap, last), 1.0)
    push, resist = press(-1.0 * gap, -1.0 * start_gap, -1.0 * rate, stiffness, damping)
    one_sided, is_free = load(part.numbers, i, ONE_SIDED), 0.5 - load(part.state, i, IS_CAUGHT)
    spring = where_negative(is_free, where_negative(one_sided, push, spring), 0.0)
    damper = where_negative(is_free, where_negative(one_sided, resist, damper), 0.0)
    return spring, damper


@hook(Latches)
def forces(part, world, timing):
    """Find which latches catch, and add moments (N m) of springs, and losses of dampers (J)."""
    for i in range(part.hinge.shape[0]):
        if part.turn[i] >= 0:
            continue
        h = part.hinge[i]
        watch(part, i, h, timing)
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        sign = load(part.state, i, SIGN)
        spring, damper = hold(part, i, sign * rate)
        moment = sign * (spring + damper)
        turn(part.openings, world.state, h, moment)
        add_loss(world, part.account, part.openings, part.rates, i, h, sign * damper)
        impulse = 0.5 * timing.step * (moment + load(part.state, i, MOMENT))
        store(part.state, i, IMPULSE, load(part.state, i, IMPULSE) + impulse)
        store(part.state, i, MOMENT, moment)


@hook(Latches)
def note_events(part, world, timing):
    """Note which latches caught (event 0) or missed (1) in the step, and when."""
    for i in range(part.hinge.shape[0]):
        if any_negative(0.5 - load(part.state, i, NEWS)):
            for s in range(part.state.shape[2]):
                news = part.state[i, NEWS, s]
                if news > 0.0:
                    note(part.log, s, part.state[i, CATCH_TIME, s], i, news - 1.0)
        store(part.state, i, NEWS, 0.0)


@hook(Latches)
def energy_of(part, world, i):
    gap = excess(part, i, NEW)
    one_sided = where_negative(gap, gap, 0.0)
    gap = where_negative(load(part.numbers, i, ONE_SIDED), one_sided, gap)
    energy = 0.5 * load(part.numbers, i, STIFFNESS) * gap * gap
    return where_negative(0.5 - load(part.state, i, IS_CAUGHT), energy, 0.0)


@hook(Latches)
def record(part, world, row):
    """Record moment (N m), impulse so far (N m s) and rate at the catch (rad/s) of each latch."""
    count = part.hinge.shape[0]
    for i in range(count):
        for k, field in enumerate((MOMENT, IMPULSE, CATCH_RATE)):
            store(part.track, row * count + i, k, load(part.state, i, field))
