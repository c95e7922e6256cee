"""Openings as they are now, and moments that act on them: for kinds that sit on hinges."""

import math
from typing import NamedTuple

import numpy as np

from fpm.kernels.angles import arctan2
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import floor, load, store
from fpm.kernels.layout import F, M, P, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import add3, cross, dot, get3, kernel, put3, to_global, to_local

TURN = 2 * math.pi

AXIS, REFERENCE = 0, 3  # of either side, in its particle's frame (3 each); of slides a point
NORMAL = 6  # to both: axis x reference (3)
SIDE = 9

NOW, BEFORE = 0, 1  # fields of the angles

# Of a part of the moment on an opening: now and one step ago (N m), and its work so far (J).
MOMENT, MOMENT_BEFORE, WORK = 0, 1, 2
TOLD = 3


class Openings(NamedTuple):
    """Opening h has the sides 2h and 2h + 1; of what is None nothing is compiled."""

    ends: np.ndarray  # (2h,) particles of the sides
    sides: np.ndarray  # (2h, SIDE, lanes)
    axes: np.ndarray  # (h, 3, lanes) axis now, in global components
    angles: np.ndarray  # (h, 2, lanes) now and one step ago (rad)
    followed: bool  # whether they are needed in every step
    track: np.ndarray  # ((instants + 1) h, 1, lanes) recorded
    slides: np.ndarray | None = None  # (h,) 1 where the opening is a length
    told: np.ndarray | None = None  # (h parts, TOLD, lanes) who acts on them, where told apart
    told_track: np.ndarray | None = None  # ((instants + 1) h parts, 2, lanes): moment, work
    parts: int = 0  # into which the moment is told apart
    which: int = 0  # of them is the kind's own that sees these openings


@kernel
def is_slide(slides, h):
    """Whether opening h is a length."""
    if slides is None:
        return False
    return slides[h] != 0


@hook(Openings)
def forces(part, world, timing):
    """No moments yet; but the kinds that act on openings follow, and need these."""
    if part.followed:
        update(part, world.state)
    begin_told(part.told)


@kernel
def begin_told(told):
    """Nobody acts yet."""
    if told is not None:
        for r in range(told.shape[0]):
            store(told, r, MOMENT_BEFORE, load(told, r, MOMENT))
            store(told, r, MOMENT, 0.0)


@kernel
def update(part, state):
    """New openings, which are functions of the configuration; the last only picks the turn."""
    sides, angles = part.sides, part.angles
    for h in range(angles.shape[0]):
        one, two = part.ends[2 * h], part.ends[2 * h + 1]
        axes = frame(state, one)
        axis = to_global(axes, get3(sides, 2 * h, AXIS))
        put3(part.axes, h, 0, axis)
        first = get3(sides, 2 * h, REFERENCE)
        second = to_global(frame(state, two), get3(sides, 2 * h + 1, REFERENCE))
        if is_slide(part.slides, h):
            between = (get3(state, two, X) + second) - (
                get3(state, one, X) + to_global(axes, first)
            )
            store(angles, h, BEFORE, load(angles, h, NOW))
            store(angles, h, NOW, dot(axis, between))
            continue
        second = to_local(axes, second)  # where what it is compared with is constant
        angle = arctan2(dot(get3(sides, 2 * h, NORMAL), second), dot(first, second))
        last = load(angles, h, NOW)
        store(angles, h, BEFORE, last)
        turns = floor((last - angle) * (1.0 / TURN) + 0.5)
        store(angles, h, NOW, angle + TURN * turns)


@kernel
def turn(openings, state, h, moment):
    """Add a moment about the axis of hinge h to its second particle, its opposite to the first; or
    a force along that of a slide, both at the second's point, so that they are in balance.
    """
    one, two = openings.ends[2 * h], openings.ends[2 * h + 1]
    axis = get3(openings.axes, h, 0)
    if is_slide(openings.slides, h):
        arm = to_global(frame(state, two), get3(openings.sides, 2 * h + 1, REFERENCE))
        force = moment * axis
        lever = get3(state, two, X) + arm - get3(state, one, X)
        add3(state, two, F, force)
        add3(state, two, M, cross(arm, force))
        add3(state, one, F, -1.0 * force)
        add3(state, one, M, -1.0 * cross(lever, force))
    else:
        couple = moment * axis
        put3(state, two, M, get3(state, two, M) + couple)
        put3(state, one, M, get3(state, one, M) - couple)
    tell(openings.told, openings, h, moment)


@kernel
def push(openings, state, h, impulse):
    """The same by an impulse (N m s), after the kick; not for slides."""
    one, two = openings.ends[2 * h], openings.ends[2 * h + 1]
    turned = impulse * get3(openings.axes, h, 0)
    put3(state, two, P, get3(state, two, P) + turned)
    put3(state, one, P, get3(state, one, P) - turned)


@kernel
def tell(told, openings, h, moment):
    """Count a moment as that of the kind that sees these openings, where they are told apart."""
    if told is not None:
        row = h * openings.parts + openings.which
        store(told, row, MOMENT, load(told, row, MOMENT) + moment)


@hook(Openings)
def work_before(part, world, timing):
    """Work of every part over the step up to now."""
    work_told(part.told, part)


@kernel
def work_told(told, part):
    """The same by the trapezium rule (losses_kernels.lose)."""
    if told is not None:
        for h in range(part.angles.shape[0]):
            turned = load(part.angles, h, NOW) - load(part.angles, h, BEFORE)
            for r in range(h * part.parts, (h + 1) * part.parts):
                both = load(told, r, MOMENT) + load(told, r, MOMENT_BEFORE)
                store(told, r, WORK, load(told, r, WORK) + 0.5 * both * turned)


@hook(Openings)
def record(part, world, row):
    """Record the openings, and the moment and work of every part."""
    if not part.followed:
        update(part, world.state)
    count = part.angles.shape[0]
    for h in range(count):
        store(part.track, row * count + h, 0, load(part.angles, h, NOW))
    record_told(part.told, part, row)


@hook(Openings)
def record_step(part, world, row, timing):
    """The latter with the moments of what holds openings exactly, which are known now."""
    record_told(part.told, part, row)


@kernel
def record_told(told, part, row):
    """Record the moment and work of every part."""
    if told is not None:
        count = told.shape[0]
        for r in range(count):
            store(part.told_track, row * count + r, 0, load(told, r, MOMENT))
            store(part.told_track, row * count + r, 1, load(told, r, WORK))
