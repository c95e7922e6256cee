"""Cables that rub at the points through which they run (theory: cable.py).

Every stretch has an unstrained length of its own. Once in a step, after the points have moved,
material slips over each point from the stretch with less tension to the one with more, as far as
Eytelwein's law asks: there and back along the cable, point by point (`slip_at`). That finds which
points slip and whereto; what these leave open of the law is then closed for all of them together
(`settle`), so that a cable that runs over many points has no friction beyond its own.
"""

from typing import NamedTuple

import numpy as np

from deployable.fpm.kernels.angles import arctan2
from deployable.fpm.kernels.hooks import hook
from deployable.fpm.kernels.lanes import absolute, load, sqrt, store, where_negative
from deployable.fpm.kernels.layout import F, M
from deployable.fpm.kernels.vectors import add3, cross, dot, get3, kernel, larger
from deployable.fpm.kernels.world import Log
from deployable.fpm.kinds.cable_kernels import (
    DIRECTION,
    EA,
    GLOBAL_ARM,
    LENGTH,
    LONGER,
    LONGER_BEFORE,
    TINY,
    UNSTRAINED,
    UNSTRAINED_BEFORE,
    energy_of_cable,
    find_pull,
    lay,
    list_excess,
    missing,
    note_events,
    pull_evenly,
    record_cable,
    unstrained_now,
    work_of_winch,
)

# Of a stretch, and of the point at which it begins.
MATERIAL = 0  # unstrained length
STRETCHED = 1  # length less that
STRETCHED_BEFORE = 2
TENSION = 3
GAIN, GAIN_BEFORE = 4, 5  # energy that leaves with a metre of unstrained length that comes
SLIPPED = 6  # unstrained length that slipped over the point into this stretch, in this step
RATIO = 7  # of the tensions on either side when it slips
SHARE, OWN = 8, 9  # more slips by SHARE of what the next point's does, and OWN
RUBBED = 10


class RubbingCables(NamedTuple):
    """Cables, of which those that rub have friction; fields as in Cables."""

    start: np.ndarray
    on: np.ndarray
    curve: np.ndarray
    arms: np.ndarray
    cables: np.ndarray
    stretches: np.ndarray
    now: np.ndarray
    account: int
    watched: np.ndarray
    rows: np.ndarray
    log: Log
    track: np.ndarray
    rubs: np.ndarray  # (c,) whether each has friction
    friction: np.ndarray  # (c, 1, lanes) its coefficient
    rubbed: np.ndarray  # (p, RUBBED, lanes)
    lost: int  # number of the account of what friction takes


@kernel
def exponential(x):
    """exp(x) to 1e-13 for 0 <= x <= 10: the series at x/256, squared eight times; exp(30) beyond
    30, which nothing slips against.
    """
    y = (1.0 / 256.0) * where_negative(x - 30.0, x, 30.0)
    found = 1.0 + y * (1.0 + y * (0.5 + y * (1 / 6 + y * (1 / 24 + y * (1 / 120 + y / 720)))))
    for _ in range(8):
        found = found * found
    return found


@kernel
def turned(part, j):
    """Angle (rad) by which the cable turns at point j."""
    one, two = get3(part.stretches, j - 1, DIRECTION), get3(part.stretches, j, DIRECTION)
    aside = cross(one, two)
    return arctan2(sqrt(dot(aside, aside)), dot(one, two))


@kernel
def slip(part, one, two, ratio):
    """Unstrained length that slips over a point out of stretch `one` into `two`, at least none.

    So much that the tension of `two` is `ratio` times that of `one`, or that both are slack.
    """
    n1, n2 = load(part.rubbed, one, MATERIAL), load(part.rubbed, two, MATERIAL)
    s1 = load(part.stretches, one, LENGTH) - n1
    s2 = load(part.stretches, two, LENGTH) - n2
    # (s2 - d)(n1 - d) = ratio (s1 + d)(n2 + d)
    a, b = 1.0 - ratio, (s2 + n1) + ratio * (s1 + n2)
    c = s2 * n1 - ratio * s1 * n2
    positive = where_negative(c, 0.0 * c, c)
    found = 2.0 * positive / (b + sqrt(b * b - 4.0 * a * positive))
    found = where_negative(s2 - found, s2, found)
    return where_negative(found, 0.0 * c, found)


@kernel
def slip_at(part, j):
    """Let material slip over point j, in the direction in which it wants to."""
    ratio = load(part.rubbed, j, RATIO)
    move(part, j, slip(part, j - 1, j, ratio) - slip(part, j, j - 1, ratio))


@kernel
def move(part, j, into):
    """Move unstrained length over point j."""
    store(part.rubbed, j - 1, MATERIAL, load(part.rubbed, j - 1, MATERIAL) - into)
    store(part.rubbed, j, MATERIAL, load(part.rubbed, j, MATERIAL) + into)
    store(part.rubbed, j, SLIPPED, load(part.rubbed, j, SLIPPED) + into)


@kernel
def strain_and_slope(part, j):
    """Strain of stretch j, and by how much it falls with a metre of unstrained length more."""
    material, length = load(part.rubbed, j, MATERIAL), load(part.stretches, j, LENGTH)
    return length / material - 1.0, length / (material * material)


@kernel
def settle(part, first, last):
    """Slip on where it slipped, so that the tensions have their ratios at all these points.

    With a, b the slopes of the strains e on either side, times the ratio on the side that gives,
    -a d(j-1) + (a + b) d(j) - b d(j+1) is what is missing; d = 0 where nothing slipped. Solved from
    the first point to the last, and back (Thomas). Points beside a slack stretch are left as they
    are: a cable that is hardly tight loses some energy over them, which is counted as friction.
    """
    share, own = 0.0 * load(part.rubbed, first, SLIPPED), 0.0 * load(part.rubbed, first, SLIPPED)
    for j in range(first + 1, last):
        ratio, slipped = load(part.rubbed, j, RATIO), load(part.rubbed, j, SLIPPED)
        e1, slope1 = strain_and_slope(part, j - 1)
        e2, slope2 = strain_and_slope(part, j)
        left, right = where_negative(slipped, 1.0, ratio), where_negative(slipped, ratio, 1.0)
        slips = where_negative(TINY - absolute(slipped), 1.0, 0.0 * e1)
        slips = where_negative(e1, 0.0, where_negative(e2, 0.0, slips))
        a, b = slips * left * slope1, slips * right * slope2
        inverse = 1.0 / ((a + b) + (1.0 - slips) - a * share)
        own = inverse * (slips * (right * e2 - left * e1) + a * own)
        share = inverse * b
        store(part.rubbed, j, SHARE, share)
        store(part.rubbed, j, OWN, own)
    more = 0.0 * own
    for j in range(last - 1, first, -1):
        more = load(part.rubbed, j, SHARE) * more + load(part.rubbed, j, OWN)
        move(part, j, more)


@kernel
def find_tensions(part, world, now, c):
    """Measure cable c, let it slip, and find the tension of every stretch."""
    first, last = part.start[c], part.start[c + 1] - 1
    lay(part, world.state, c)
    rest, friction = unstrained_now(part, world, now, c), load(part.friction, c, 0)
    reeled = rest - load(part.now, c, UNSTRAINED)
    store(part.now, c, UNSTRAINED_BEFORE, load(part.now, c, UNSTRAINED))
    store(part.now, c, UNSTRAINED, rest)
    store(part.rubbed, first, MATERIAL, load(part.rubbed, first, MATERIAL) + reeled)
    for j in range(first, last):
        store(part.rubbed, j, SLIPPED, 0.0)
    for j in range(first + 1, last):
        store(part.rubbed, j, RATIO, exponential(friction * turned(part, j)))
        slip_at(part, j)
    for j in range(last - 2, first, -1):
        slip_at(part, j)
    settle(part, first, last)
    most = load(part.stretches, first, LENGTH) - load(part.rubbed, first, MATERIAL)
    for j in range(first, last):
        material = load(part.rubbed, j, MATERIAL)
        after = load(part.stretches, j, LENGTH) - material
        before = load(part.rubbed, j, STRETCHED)
        tight = where_negative(after, 0.0, after) + missing(after, before)
        tension = load(part.cables, c, EA) / material * tight
        store(part.rubbed, j, STRETCHED_BEFORE, before)
        store(part.rubbed, j, STRETCHED, after)
        store(part.rubbed, j, TENSION, tension)
        store(part.rubbed, j, GAIN_BEFORE, load(part.rubbed, j, GAIN))
        store(part.rubbed, j, GAIN, tension * (1.0 + 0.5 * after / material))
        most = larger(most, after)
    store(part.now, c, LONGER_BEFORE, load(part.now, c, LONGER))
    store(part.now, c, LONGER, most)


@hook(RubbingCables)
def forces(part, world, now):
    """Pull all points towards their neighbours, each stretch with its own tension."""
    state = world.state
    for c in range(part.curve.shape[0]):
        if not part.rubs[c]:
            pull_evenly(part, state, c, find_pull(part, world, now, c))
            continue
        find_tensions(part, world, now, c)
        first, last = part.start[c], part.start[c + 1] - 1
        for j in range(first, last + 1):
            force = 0.0 * get3(part.stretches, j, DIRECTION)
            if j < last:
                force = force + load(part.rubbed, j, TENSION) * get3(part.stretches, j, DIRECTION)
            if j > first:
                pull = load(part.rubbed, j - 1, TENSION)
                force = force - pull * get3(part.stretches, j - 1, DIRECTION)
            add3(state, part.on[j], F, force)
            add3(state, part.on[j], M, cross(get3(part.stretches, j, GLOBAL_ARM), force))


@kernel
def gain(part, j):
    """Mean over the step of the energy that leaves stretch j with a metre that comes."""
    return 0.5 * (load(part.rubbed, j, GAIN) + load(part.rubbed, j, GAIN_BEFORE))


@hook(RubbingCables)
def work_before(part, world, now):
    """Work of the winches, and what friction took, over the step up to now."""
    given, lost = load(world.accounts, 0, part.account), load(world.accounts, 0, part.lost)
    for c in range(part.curve.shape[0]):
        first, last = part.start[c], part.start[c + 1] - 1
        if not part.rubs[c]:
            given = given + work_of_winch(part, c)
            continue
        taken = load(part.now, c, UNSTRAINED_BEFORE) - load(part.now, c, UNSTRAINED)
        given = given + taken * gain(part, first)
        for j in range(first + 1, last):
            slipped = load(part.rubbed, j, SLIPPED)
            lost = lost + slipped * (gain(part, j) - gain(part, j - 1))
    store(world.accounts, 0, part.account, given)
    store(world.accounts, 0, part.lost, lost)


@kernel
def energy_of_stretch(part, c, j):
    """Strain energy (J) of stretch j of cable c."""
    material, longer = load(part.rubbed, j, MATERIAL), load(part.rubbed, j, STRETCHED)
    longer = where_negative(longer, 0.0, longer)
    return 0.5 * load(part.cables, c, EA) / material * longer * longer


@hook(RubbingCables)
def energy_of(part, world, c):
    """Strain energy of cable c (J)."""
    total = energy_of_cable(part, c)
    if part.rubs[c]:
        total = 0.0 * total
        for j in range(part.start[c], part.start[c + 1] - 1):
            total = total + energy_of_stretch(part, c, j)
    return total


@hook(RubbingCables)
def record(part, world, row):
    """Tension of the first stretch, and length."""
    count = part.curve.shape[0]
    for c in range(count):
        if not part.rubs[c]:
            record_cable(part, c, row * count + c)
            continue
        first = part.start[c]
        longer, length = load(part.rubbed, first, STRETCHED), load(part.stretches, first, LENGTH)
        tension = load(part.cables, c, EA) * longer / load(part.rubbed, first, MATERIAL)
        for j in range(first + 1, part.start[c + 1] - 1):
            length = length + load(part.stretches, j, LENGTH)
        store(part.track, row * count + c, 0, where_negative(tension, 0.0, tension))
        store(part.track, row * count + c, 1, length)


for _name, _kernel in {"note_events": note_events, "list_excess": list_excess}.items():
    hook(RubbingCables, _name)(_kernel)
