"""Catching, moments, energies, losses and events of latches; what is theirs alone that hold exactly
is in joints/rigid_latch_kernels.py."""

import math
from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint_arrays import FREE_RATE, HOLDS, Turns
from fpm.elements.joints.joint_arrays import RATE as SOLVED_RATE
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
FIRST_RATE = 8  # rate of the opening at the start of this step, by the parabola through its ends
CHANGE = 9  # and the change of that rate in the step
WORKS = 10  # of turn_kernels; it and those below: of latches that hold exactly
AGE = WORKS + 2  # steps in which it has held
IMPACT = AGE + 1  # impulse with which it caught
PREDICTION = IMPACT + 1  # opening that is foreseen for the end of this step
SEARCH_END = PREDICTION + 1  # opening up to which it has looked, as foreseen in the step before
SEARCH_SHARE = SEARCH_END + 1  # share of this step after which that is: others caught then
CATCH_IMPULSE = SEARCH_SHARE + 1  # that of the catch, by what it takes to hold it, 0: not known
LEAD = CATCH_IMPULSE + 1  # steps from the time of the rate in `rates` to the start of this step
BRAKE_MOMENT = LEAD + 1  # moment (N m) with which exact friction slips on the joint
MOVES = BRAKE_MOMENT + 1  # -1 where the coordinate is held at the end of the step, 1 elsewhere
STATE = MOVES + 1

TRACK = 4  # recorded: moment, impulse, rate when it caught, impulse with which it caught

ANGLE_TOL = 1e-6
"""Openings (rad) beyond the reach that are looked at one by one; only to save time."""

AT_START = 1e-9
"""Openings (rad) beyond the reach that count as within it at the start of a run."""

HELD_RATE = 1e-9
"""Share of the rate before up to which a joint counts as held during the whole step."""

AT_REST = 1e-12
"""Ways (rad) against a latch's direction that count as rest."""


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
    angles, last = part.openings.angles, load(part.rates, i, RATE)
    start, end = load(angles, h, OLD), load(angles, h, NEW)
    reach = reach_of(part, i, start, end, timing.step * last)
    if any_negative(where_negative(0.5 - load(part.state, i, IS_CAUGHT), 1.0, reach)):
        store(part.state, i, LEAD, 0.0 if timing.time < 1.5 * timing.step else 0.5)
        find_path(part, i, (end - start) * (1.0 / timing.step))
        for s in range(angles.shape[2]):
            if part.state[i, IS_CAUGHT, s] > 0.0:
                continue
            first, last_angle = angles[h, OLD, s], angles[h, NEW, s]
            if timing.time == 0.0:
                catch_at_start(part, i, s, first, part.rates[i, RATE, s])
            else:
                follow_path(part, i, s, first, last_angle, timing.time - timing.step, timing.step)


@kernel
def reach_of(part, i, start, end, last_way):
    """Return by how far (rad) the path from `start` to `end` in a step stays clear of latch i's
    range. last_way: way (rad) at the rate before, from which the path may be bent."""
    distance = absolute(0.5 * (end + start) - load(part.numbers, i, ANGLE))
    bend = 0.5 * absolute(end - start) + 0.5 * absolute(end - start - last_way)
    return distance - bend - load(part.numbers, i, CAPTURE_RANGE) - ANGLE_TOL


@kernel
def find_path(part, i, mean):
    """Store the path of latch i's coordinate in a step, a parabola: its rate (rad/s) at the start
    and the change in the step, by the rate before. mean: rate of the step. Where friction turned or
    held the coordinate, the free rate tells the path up to there."""
    last, weight = load(part.rates, i, RATE), 1.0 / (0.5 + load(part.state, i, LEAD))
    free, free_to_move = mean, 0.0 * mean + 1.0
    for t in range(part.turns.hinge.shape[0]):
        if part.turns.hinge[t] == part.hinge[i]:
            turns = part.turns.state
            free = mean + load(turns, t, FREE_RATE) - load(turns, t, SOLVED_RATE)
            free_to_move = where_negative(load(turns, t, HOLDS), -1.0, free_to_move)
    change, free_change = (mean - last) * weight, (free - last) * weight
    rate, free_rate = mean - 0.5 * change, free - 0.5 * free_change
    turns_back = free_rate * (free_rate + free_change)
    rests = where_negative(free_to_move, absolute(mean) - HELD_RATE * absolute(last), 1.0)
    rate = where_negative(rests, 0.0, where_negative(turns_back, free_rate, rate))
    change = where_negative(rests, 0.0, where_negative(turns_back, free_change, change))
    store(part.state, i, FIRST_RATE, rate)
    store(part.state, i, CHANGE, change)
    store(part.state, i, MOVES, free_to_move)


@kernel
def catch_at_start(part, i, s, angle, rate):
    """Let latch i of sample s catch, or miss, at the start of a run, at an `angle` (rad) and `rate`
    (rad/s) of its coordinate."""
    distance = abs(angle - part.numbers[i, ANGLE, s])
    sign = direction_of(part, i, s, rate)
    if distance > part.numbers[i, CAPTURE_RANGE, s] + AT_START or sign * rate < 0.0:
        return
    if sign * rate <= part.numbers[i, MAX_RATE, s]:
        catch(part, i, s, angle, rate, 0.0, sign)
    elif part.numbers[i, CAPTURE_RANGE, s] == 0.0:
        miss(part, i, s, 0.0)


@kernel
def direction_of(part, i, s, motion):
    """Return the sign of the rate with which latch i of sample s catches now. motion: with the sign
    of its coordinate's rate, which counts where it catches from both sides."""
    sign = part.numbers[i, APPROACH, s]
    if sign == 0.0:
        sign = -1.0 if motion < 0.0 else 1.0
    return sign


@kernel
def catch(part, i, s, angle, rate, time, sign):
    """Store that latch i of sample s catches at an angle (rad), rate (rad/s) and time (s)."""
    part.state[i, IS_CAUGHT, s] = part.state[i, NEWS, s] = 1.0
    part.state[i, HOLD_ANGLE, s] = angle
    part.state[i, SIGN, s] = sign
    part.state[i, CATCH_TIME, s] = time
    part.state[i, CATCH_RATE, s] = rate


@kernel
def miss(part, i, s, time):
    """Store that latch i of sample s misses at a time (s)."""
    part.state[i, NEWS, s] = 2.0
    part.state[i, CATCH_TIME, s] = time


@kernel
def follow_path(part, i, s, start, end, time, span):
    """Decide whether latch i of sample s catches or misses on the way of its coordinate from
    `start` to `end` (rad) in `span` seconds from a `time` (s) on: on the way to where it turns back
    and on the way from there, if it does. part.state: FIRST_RATE and CHANGE of its parabola; after
    the turn the way leads to `end`, which may have changed (friction that turns), or stays there
    (that holds)."""
    rate, change = part.state[i, FIRST_RATE, s], part.state[i, CHANGE, s]
    share, middle = 1.0, end
    if rate * (rate + change) < 0.0:
        share = -rate / change
        if part.state[i, MOVES, s] > 0.0:
            middle = start + 0.5 * share * span * rate
    pass_by(part, i, s, start, middle, rate, time, share * span)
    if share < 1.0 and part.state[i, NEWS, s] == 0.0:
        pass_by(part, i, s, middle, end, 0.0, time + share * span, (1.0 - share) * span)


@kernel
def pass_by(part, i, s, start, end, start_rate, time, span):
    """Decide whether latch i of sample s catches or misses on a way that its coordinate does not
    turn back on, from `start` to `end` (rad) in `span` seconds from a `time` (s) on, with a rate
    that changes evenly from `start_rate` (rad/s). Ways are measured from the edge of the capture
    range that is met first. Within the range the rate may fall to the largest one at which the
    latch catches. A way on which friction pushes along is none: it turns or holds first."""
    angle, reach = part.numbers[i, ANGLE, s], part.numbers[i, CAPTURE_RANGE, s]
    sign, most = direction_of(part, i, s, end - start), part.numbers[i, MAX_RATE, s]
    first, last = sign * (start - angle) + reach, sign * (end - angle) + reach
    is_inside = 0.0 <= first <= 2.0 * reach and reach > 0.0
    if last - first < -AT_REST or not (is_inside or first < 0.0 <= last):
        return
    if abs(end - start) > AT_REST and part.state[i, BRAKE_MOMENT, s] * (end - start) > 0.0:
        return
    begin_rate = max(sign * start_rate, 0.0)
    final = max(2.0 * (last - first) / span - begin_rate, 0.0)
    place = max(first, 0.0)
    rate = rate_after(begin_rate, final, place - first, span)
    if rate > most >= final:
        wait = (begin_rate - most) / (begin_rate - final) * span
        place, rate = first + 0.5 * (begin_rate + most) * wait, most
    if rate <= most and place <= max(2.0 * reach, first):
        wait = time_of(begin_rate, rate, place - first)
        catch(part, i, s, angle + sign * (place - reach), sign * rate, time + wait, sign)
    elif last > 2.0 * reach or reach == 0.0:
        end_rate = rate_after(begin_rate, final, 2.0 * reach - first, span)
        miss(part, i, s, time + time_of(begin_rate, end_rate, 2.0 * reach - first))


@kernel
def rate_after(begin_rate, final, distance, span):
    """Return the rate (rad/s) after a `distance` (rad) on which it changes evenly, from
    `begin_rate` to `final` in `span` seconds."""
    square = begin_rate * begin_rate + 2.0 * (final - begin_rate) / span * distance
    return math.sqrt(max(square, 0.0))


@kernel
def time_of(begin_rate, rate, distance):
    """Return the time (s) of a `distance` (rad) on which the rate (rad/s) changes evenly."""
    return 2.0 * distance / (begin_rate + rate) if begin_rate + rate > 0.0 else 0.0


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
