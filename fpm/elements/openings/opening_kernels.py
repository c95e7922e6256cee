"""Joint openings: their values now, and moments on them."""

import math
from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import floor, load, store
from fpm.kernels.layout import BY_SPIN, IJ, IM, F, M, P, V, X
from fpm.kernels.rotation import arctan2, frame
from fpm.kernels.vectors import (
    add3,
    cross,
    dot,
    get3,
    kernel,
    put3,
    times,
    to_global,
    to_local,
)

TURN = 2 * math.pi

AXIS, REFERENCE = 0, 3  # of either side, in its particle's frame (3 each); of slides a point
NORMAL = 6  # to both: axis x reference (3)
SIDE = 9

NEW, OLD = 0, 1  # fields of the angles

# Of a part of the moment on an opening: now and one step ago (N m), and its work so far (J).
MOMENT, MOMENT_BEFORE, WORK = 0, 1, 2
PART_FIELDS = 3


class Openings(NamedTuple):
    """Arrays of all h openings (joint coordinates), for kernels. Hinge i has the sides 2 i and 2 i
    + 1, one on each of its particles."""

    ends: np.ndarray  # (2h,) particles of the sides
    sides: np.ndarray  # (2h, SIDE, lanes) in the particles' axes
    axes: np.ndarray  # (h, 3, lanes) axis now, in global components
    angles: np.ndarray  # (h, 2, lanes) now and one step ago (rad, m)
    track: np.ndarray  # ((instants + 1) h, 1, lanes) recorded openings
    slides: np.ndarray  # (h,) 1 where the opening is a length
    moments: np.ndarray  # (h parts, PART_FIELDS, lanes) of each component, if recorded
    part_track: np.ndarray  # ((instants + 1) h parts, 2, lanes): moment, work
    parts: int  # number of components, 0: none are recorded
    part: int = 0  # which of them is the kind's own that takes these arrays


@kernel
def is_slide(slides, h):
    """Return whether the joint coordinate of hinge h is a length (m), as of a slide."""
    return slides[h] != 0


@hook(Openings)
def forces(part, world, timing):
    """Compute joint coordinates and axes in every step, as full turns count; begin moments anew."""
    update(part, world, timing)
    begin_parts(part.moments)


@kernel
def begin_parts(moments):
    """Make the moment of each component that of a step ago, and set the new one to 0."""
    for r in range(moments.shape[0]):
        store(moments, r, MOMENT_BEFORE, load(moments, r, MOMENT))
        store(moments, r, MOMENT, 0.0)


@kernel
def update(part, world, timing):
    """Compute the joint coordinates (rad, m) and axes (global) of all hinges. Of angles that differ
    by full turns, the one closest to the last and the way by the rate in the step is taken: there
    may be several turns in a step."""
    sides, angles, state = part.sides, part.angles, world.state
    step = timing.step if timing.time > 0.0 else 0.0
    for h in range(angles.shape[0]):
        first_end, second_end = part.ends[2 * h], part.ends[2 * h + 1]
        axes = frame(state, first_end)
        axis = to_global(axes, get3(sides, 2 * h, AXIS))
        put3(part.axes, h, 0, axis)
        first = get3(sides, 2 * h, REFERENCE)
        second_axes = frame(state, second_end)
        second = to_global(second_axes, get3(sides, 2 * h + 1, REFERENCE))
        if is_slide(part.slides, h):
            chord = (get3(state, second_end, X) + second) - (
                get3(state, first_end, X) + to_global(axes, first)
            )
            store(angles, h, OLD, load(angles, h, NEW))
            store(angles, h, NEW, dot(axis, chord))
            continue
        second = to_local(axes, second)  # where what it is compared with is constant
        angle = arctan2(dot(get3(sides, 2 * h, NORMAL), second), dot(first, second))
        last = load(angles, h, NEW)
        store(angles, h, OLD, last)
        spin = spin_of(world, second_end, second_axes) - spin_of(world, first_end, axes)
        turns = floor((last + step * dot(axis, spin) - angle) * (1.0 / TURN) + 0.5)
        store(angles, h, NEW, angle + TURN * turns)


@kernel
def spin_of(world, i, axes):
    """Return the angular velocity (rad/s) of particle i in the last step, by its `axes`."""
    momentum = get3(world.state, i, P)
    spin = to_global(axes, times(get3(world.particles, i, IJ), to_local(axes, momentum)))
    return load(world.particles, i, BY_SPIN) * momentum + spin


@kernel
def turn(openings, state, h, moment):
    """Apply a moment (N m, lanes) about the axis of hinge h to its second particle, its opposite to
    the first, and record it as of openings.part. On a slide it is a force (N) along the axis, on
    both at the second's point, so that they are in balance."""
    add_to_ends(openings, state, h, moment, M)
    if is_slide(openings.slides, h):
        force = moment * get3(openings.axes, h, 0)
        add3(state, openings.ends[2 * h + 1], F, force)
        add3(state, openings.ends[2 * h], F, -1.0 * force)
    add_moment(openings.moments, openings, h, moment)


@kernel
def push(openings, world, h, impulse):
    """Apply an impulse (N m s, on a slide N s; lanes) to both particles of hinge h as `turn`
    applies a moment, once the step's forces are in the momenta."""
    add_to_ends(openings, world.state, h, impulse, P)
    if is_slide(openings.slides, h):
        first, second = openings.ends[2 * h], openings.ends[2 * h + 1]
        kick = impulse * get3(openings.axes, h, 0)
        add3(world.state, second, V, load(world.particles, second, IM) * kick)
        add3(world.state, first, V, -1.0 * load(world.particles, first, IM) * kick)


@kernel
def add_to_ends(openings, state, h, moment, field):
    """Add a `moment` about the axis of hinge h to a field (M, P) of its second particle, and the
    opposite to the first; of a slide the moments of a force at the second's point."""
    first, second = openings.ends[2 * h], openings.ends[2 * h + 1]
    part = moment * get3(openings.axes, h, 0)
    if is_slide(openings.slides, h):
        arm = to_global(frame(state, second), get3(openings.sides, 2 * h + 1, REFERENCE))
        lever = get3(state, second, X) + arm - get3(state, first, X)
        add3(state, second, field, cross(arm, part))
        add3(state, first, field, -1.0 * cross(lever, part))
    else:
        add3(state, second, field, part)
        add3(state, first, field, -1.0 * part)


@kernel
def add_moment(moments, openings, h, moment):
    """Add a moment (N m; on a slide N) on hinge h to the component openings.part."""
    if openings.parts > 0:
        row = h * openings.parts + openings.part
        store(moments, row, MOMENT, load(moments, row, MOMENT) + moment)


@hook(Openings)
def work_before(part, world, timing):
    """Add the work (J) of each component in the last step, by the mean of its moments."""
    moments = part.moments
    for r in range(moments.shape[0]):
        h = r // part.parts
        angle = load(part.angles, h, NEW) - load(part.angles, h, OLD)
        total = load(moments, r, MOMENT) + load(moments, r, MOMENT_BEFORE)
        store(moments, r, WORK, load(moments, r, WORK) + 0.5 * total * angle)


@hook(Openings)
def record(part, world, row):
    count = part.angles.shape[0]
    for h in range(count):
        store(part.track, row * count + h, 0, load(part.angles, h, NEW))
    record_parts(part, row)


@hook(Openings)
def record_step(part, world, row, timing):
    """Record moments and works again, now that the step has found those of constraints."""
    record_parts(part, row)


@kernel
def record_parts(part, row):
    """Record the moment (N m) and work (J) of every component in part.part_track."""
    count = part.moments.shape[0]
    for r in range(count):
        store(part.part_track, row * count + r, 0, load(part.moments, r, MOMENT))
        store(part.part_track, row * count + r, 1, load(part.moments, r, WORK))
