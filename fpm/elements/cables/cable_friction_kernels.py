"""Cables that rub at the points through which they run, by Euler and Eytelwein's law as a whole.

Theory: docs/mechanics.md, "Cables", where it is shown that there is one solution, and that these
steps find it.

Where such a cable turns tight or slack in a step, all its stretches do so at one time, which the
lengths at both ends of the step tell, as if changing evenly. What slips does so after or before,
and the forces are corrected as `edge` does those of other cables."""

from typing import NamedTuple

import numpy as np

from fpm.elements.cables import cable_kernels as cable
from fpm.elements.cables.cable_kernels import LENGTH, TINY
from fpm.elements.openings.opening_kernels import Openings
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import absolute, any_negative, load, sqrt, store, where_negative
from fpm.kernels.record import note_crossings
from fpm.kernels.rotation import arctan2
from fpm.kernels.vectors import cross, dot, get3, kernel, larger
from fpm.kernels.world import Log

# Of a stretch, and of the point at which it begins.
START = 0  # unstrained length before anything slips in this step
FREE_STRAIN = 1  # strain, if nothing could slip over the point after it
RATIO, INVERSE = 2, 3  # of the tensions on either side when it slips
MATERIAL = 4  # unstrained length; the length, where the cable is slack
TENSION, TENSION_BEFORE = 5, 6
SLIP = 7  # unstrained length that came over the point, or from the winch, while tight
SLIP_BEFORE = 8  # size of that in the step before, for events
SLIP_SIZE = 9

CLOSE = 1e-13
"""What may be left over in the search for a strain, as a share of the cable's unstrained length."""

MOST = 60
"""Steps of Newton's, or halvings, at most; one or two do in a smooth motion."""


FLOOR = 1e-200
"""Least strain, behind points that much friction holds, as a share of the largest that may be."""


@kernel
def positive(x):
    """Return the larger of x and 0; x: a number or lanes."""
    return where_negative(x, 0.0, x)


@kernel
def find_flow(part, first, j, strain):
    """Return the unstrained length (m) that slips from the stretches `first` to j over the point at
    j's end if j has this `strain`, and its derivative by it (m). part: RubbingCables."""
    flow, follows = 0.0 * strain, 0.0 * strain + 1.0
    slope, link = flow, follows
    for k in range(j, first - 1, -1):
        local, scale = follows * strain, 1.0 / (1.0 + follows * strain)
        start, length = load(part.slip, k, START), load(part.stretches, k, LENGTH)
        flow = flow + link * (scale * (start * local - (length - start)))  # start - length scale
        slope = slope + link * (follows * length * scale * scale)
        if k > first:
            free_strain, ratio = load(part.slip, k - 1, FREE_STRAIN), load(part.slip, k, RATIO)
            inverse = load(part.slip, k, INVERSE)
            low, high = inverse * local - free_strain, free_strain - ratio * local
            link = where_negative(low, where_negative(high, 0.0, link), link)
            follows = follows * where_negative(low, ratio, inverse)
            if not any_negative(-link):
                break
    return flow, slope


@kernel
def find_free_strain(part, first, j, tight, slope, close):
    """Return the strain of stretch j > first if nothing could slip over the point at its end (0:
    slack), at which `find_flow` is 0, and the derivative of that (m): by Newton's method between
    bounds. tight: length less unstrained length (m) of the stretches up to j; slope: derivative (m)
    for those before j; close: flow (m) near enough to 0."""
    start, length = load(part.slip, j, START), load(part.stretches, j, LENGTH)
    free_strain = load(part.slip, j - 1, FREE_STRAIN)
    stick_strain = positive((length - start) / start)
    ratio, inverse = load(part.slip, j, RATIO), load(part.slip, j, INVERSE)
    least, most = inverse * stick_strain - free_strain, free_strain - ratio * stick_strain
    follows = where_negative(least, ratio, inverse)
    slope = where_negative(least, where_negative(most, 0.0, slope), slope)
    strain = (start * stick_strain + slope * free_strain) / (start + slope * follows)
    is_open = where_negative(-tight, 1.0, 0.0)
    strain = is_open * strain
    high = larger(stick_strain, free_strain)
    low = FLOOR * high
    for _ in range(MOST):
        flow, steep = find_flow(part, first, j, strain)
        low, high = where_negative(flow, strain, low), where_negative(flow, high, strain)
        better, bisection = strain - flow / steep, sqrt(low * high)
        better = where_negative(low - better, better, bisection)
        better = where_negative(better - high, better, bisection)
        slope = where_negative(-is_open, steep, slope)
        is_open = where_negative(absolute(flow) - close, 0.0, is_open)
        strain = where_negative(-is_open, better, strain)
        if not any_negative(-is_open):
            break
    return strain, slope


@kernel
def strain_before(part, j, strain):
    """Return the strain of the stretch before point j by the law of friction, after it `strain`."""
    least, most = load(part.slip, j, INVERSE) * strain, load(part.slip, j, RATIO) * strain
    free_strain = load(part.slip, j - 1, FREE_STRAIN)
    return larger(least, where_negative(most - free_strain, most, free_strain))


@kernel
def find_free_strains(part, first, last, close):
    """Store in FREE_STRAIN the strain of each stretch if it slipped over the points before, but
    nothing over that at its end. first, last: the cable's first and last point; close: error of
    unstrained length (m) at which the iteration ends."""
    start, length = load(part.slip, first, START), load(part.stretches, first, LENGTH)
    tight = length - start
    strain, slope = positive(tight) / larger(start, 0.0 * start + TINY), length
    store(part.slip, first, FREE_STRAIN, strain)
    for j in range(first + 1, last):
        tight = tight + (load(part.stretches, j, LENGTH) - load(part.slip, j, START))
        strain, slope = find_free_strain(part, first, j, tight, slope, close)
        store(part.slip, j, FREE_STRAIN, strain)


STICK = 10 * CLOSE
"""Largest slip in a step, as a share of the cable's unstrained length, that counts as none."""


class RubbingCables(NamedTuple):
    """Arrays of all c cables, with p points, where some have friction (lanes: samples): those of
    Cables, and further ones."""

    start: np.ndarray
    particle: np.ndarray
    curve: np.ndarray
    arms: np.ndarray
    cables: np.ndarray
    stretches: np.ndarray
    state: np.ndarray
    account: int
    peaks: np.ndarray
    rows: np.ndarray
    log: Log
    track: np.ndarray
    stretch_track: np.ndarray
    drum: np.ndarray
    openings: Openings | None
    has_friction: np.ndarray  # (c,) whether each has friction
    friction: np.ndarray  # (c, 1, lanes) coefficient
    slip: np.ndarray  # (p, SLIP_SIZE, lanes) m, N, of the constants above
    loss: int  # index of friction's loss in World.accounts


@kernel
def exponential(x):
    """Return exp(x) to a relative error of 1e-11 for 0 <= x <= 10, and exp(30) above 30, where no
    cable slips, for ratios of tensions at points: the series at x/256, squared eight times."""
    y = (1.0 / 256.0) * where_negative(x - 30.0, x, 30.0)
    result = 1.0 + y * (1.0 + y * (0.5 + y * (1 / 6 + y * (1 / 24 + y * (1 / 120 + y / 720)))))
    for _ in range(8):
        result = result * result
    return result


@kernel
def turn_angle(part, j):
    """Return the angle (rad, 0 to pi) by which a cable turns at its point j, between its ends."""
    first = get3(part.stretches, j - 1, cable.DIRECTION)
    second = get3(part.stretches, j, cable.DIRECTION)
    normal = cross(first, second)
    return arctan2(sqrt(dot(normal, normal)), dot(first, second))


@kernel
def length_at(part, j, soft, fraction):
    """Return the length (m) of stretch j at a `fraction` of the step. soft: 1/EA (1/N)."""
    length = load(part.slip, j, MATERIAL) * (1.0 + soft * load(part.slip, j, TENSION))
    return length + fraction * (load(part.stretches, j, cable.LENGTH) - length)


@kernel
def slip(part, c, rest, excess, turn):
    """Let cable c slip over its points by the law of friction: store FREE_STRAIN of every stretch.
    rest: unstrained length now (m); excess: length less unstrained length a step ago (m); turn:
    fraction of the step after which the cable turns tight, if it was slack."""
    first, last = part.start[c], part.start[c + 1] - 1
    soft, rest_sum = 1.0 / load(part.cables, c, cable.EA), 0.0 * rest
    for j in range(first + 1, last):
        ratio = exponential(load(part.friction, c, 0) * turn_angle(part, j))
        store(part.slip, j, RATIO, ratio)
        store(part.slip, j, INVERSE, 1.0 / ratio)
        start = length_at(part, j, soft, turn)
        start = where_negative(excess, start, load(part.slip, j, MATERIAL))
        store(part.slip, j, START, start)
        rest_sum = rest_sum + start
    store(part.slip, first, START, rest - rest_sum)
    find_free_strains(part, first, last, CLOSE * rest)


@kernel
def pull_on(part, c, excess, turn, slack):
    """Store tension (N), slipped and unstrained length (m) and pull (N) of every stretch of cable
    c. excess: length less unstrained length now (m); turn: fraction of the step after which it
    turns slack, if it is now; slack: fraction of the step in which it is slack."""
    first, last = part.start[c], part.start[c + 1] - 1
    stiffness = load(part.cables, c, cable.EA)
    soft = 1.0 / stiffness
    strain = load(part.slip, last - 1, FREE_STRAIN)
    inflow = 0.0 * excess
    for j in range(last - 1, first - 1, -1):
        length = load(part.stretches, j, cable.LENGTH)
        old_tension = load(part.slip, j, TENSION)
        end = where_negative(excess, length_at(part, j, soft, turn), length / (1.0 + strain))
        inflow = inflow + (end - load(part.slip, j, START))
        tension = where_negative(excess, 0.0, stiffness * strain)
        store(part.slip, j, SLIP, inflow)
        store(part.slip, j, MATERIAL, where_negative(excess, length, end))
        store(part.slip, j, TENSION_BEFORE, old_tension)
        store(part.slip, j, TENSION, tension)
        store(part.stretches, j, cable.PULL, tension - 0.5 * slack * (tension + old_tension))
        if j > first:
            strain = strain_before(part, j, strain)


@kernel
def find_tensions(part, world, timing, c):
    """Measure cable c, which has friction, let it slip, and store its tensions (N) in part.slip."""
    length = cable.measure_path(part, world.state, c)
    rest = cable.find_unstrained_length(part, world, timing, c)
    last, excess = load(part.state, c, cable.LONGER), length - rest
    reel_length = rest - load(part.state, c, cable.UNSTRAINED)
    store(part.state, c, cable.LONGER_BEFORE, last)
    store(part.state, c, cable.LONGER, excess)
    store(part.state, c, cable.UNSTRAINED_BEFORE, load(part.state, c, cable.UNSTRAINED))
    store(part.state, c, cable.UNSTRAINED, rest)
    inverse = 1.0 / (absolute(last) + absolute(excess) + cable.TINY)
    turn = inverse * absolute(last)
    slack = inverse * (positive(-last) + positive(-excess))
    if any_negative(-larger(last, excess)):
        slip(part, c, rest, last, turn)
    pull_on(part, c, excess, turn, slack)
    store(part.slip, part.start[c], SLIP, (1.0 - slack) * reel_length)


@hook(RubbingCables)
def forces(part, world, timing):
    for c in range(part.curve.shape[0]):
        if part.has_friction[c]:
            find_tensions(part, world, timing, c)
            strain = load(part.slip, part.start[c], TENSION) / load(part.cables, c, cable.EA)
            pull = load(part.stretches, part.start[c], cable.PULL) * (1.0 + 0.5 * strain)
            store(part.state, c, cable.WINCH, pull)
        else:
            cable.find_pull(part, world, timing, c)
        cable.pull_points(part, world.state, c)
        cable.turn_drum(part.openings, part, world.state, c, load(part.state, c, cable.WINCH))


@kernel
def gain(part, j, soft):
    """Return the energy (J/m) that unstrained cable brings into stretch j, a mean over the step."""
    tension, last = load(part.slip, j, TENSION), load(part.slip, j, TENSION_BEFORE)
    return 0.5 * (tension + last) + 0.25 * soft * (tension * tension + last * last)


@hook(RubbingCables)
def work_before(part, world, timing):
    """Add the winches' work (J) in the step, and the energy (J) that friction took."""
    work, loss = load(world.accounts, 0, part.account), load(world.accounts, 0, part.loss)
    for c in range(part.curve.shape[0]):
        if not part.has_friction[c]:
            if part.curve[c] >= 0:
                work = work + cable.work_of_winch(part, c)
            continue
        first, soft = part.start[c], 1.0 / load(part.cables, c, cable.EA)
        last_gain = gain(part, first, soft)
        if part.curve[c] >= 0:
            work = work - load(part.slip, first, SLIP) * last_gain
        for j in range(first + 1, part.start[c + 1] - 1):
            factor = gain(part, j, soft)
            loss = loss + load(part.slip, j, SLIP) * (factor - last_gain)
            last_gain = factor
    store(world.accounts, 0, part.account, work)
    store(world.accounts, 0, part.loss, loss)


@hook(RubbingCables)
def energy_of(part, world, c):
    total = cable.energy_of_cable(part, c)
    if part.has_friction[c]:
        total = 0.0 * total
        for j in range(part.start[c], part.start[c + 1] - 1):
            tension = load(part.slip, j, TENSION)
            total = total + tension * tension * load(part.slip, j, MATERIAL)
        total = 0.5 / load(part.cables, c, cable.EA) * total
    return total


@hook(RubbingCables)
def record(part, world, row):
    """Store tension (N), of the first stretch, and strained length (m) of each cable."""
    count = part.curve.shape[0]
    for c in range(count):
        if not part.has_friction[c]:
            cable.record_cable(part, c, row)
            continue
        length = load(part.state, c, cable.LONGER) + load(part.state, c, cable.UNSTRAINED)
        store(part.track, row * count + c, 0, load(part.slip, part.start[c], TENSION))
        store(part.track, row * count + c, 1, length)
        for j in range(part.start[c], part.start[c + 1] - 1):
            cable.record_stretch(part, j, row, load(part.slip, j, TENSION))
        cable.record_drum(part.openings, part, c)


@hook(RubbingCables, "note_events")
def note_slips(part, world, timing):
    """Note which cables turned tight (0) or slack (1), and where they stick (0) or slip (1)."""
    cable.note_events(part, world, timing)
    number = part.curve.shape[0]
    for c in range(part.curve.shape[0]):
        if part.has_friction[c]:
            last = load(part.state, c, cable.LONGER_BEFORE)
            tight = larger(load(part.state, c, cable.LONGER), last)
            least = STICK * load(part.state, c, cable.UNSTRAINED)
            for j in range(part.start[c] + 1, part.start[c + 1] - 1):
                # Without any tension nothing was found to slip, and SLIP says nothing.
                size = where_negative(-tight, absolute(load(part.slip, j, SLIP)), 0.0)
                previous = load(part.slip, j, SLIP_BEFORE)
                note_crossings(part.log, number, least - previous, least - size, timing)
                store(part.slip, j, SLIP_BEFORE, size)
                number += 1


hook(RubbingCables, "list_excess")(cable.list_excess)
