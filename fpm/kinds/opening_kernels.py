"""Openings as they are now, and moments that act on them: for kinds that sit on hinges."""

import math
from typing import NamedTuple

import numpy as np

from fpm.kernels.angles import arctan2
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import floor, load, store
from fpm.kernels.layout import M
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import cross, dot, get3, kernel, put3, to_global

TURN = 2 * math.pi

AXIS, REFERENCE = 0, 3  # of either side, in its particle's frame (3 each)
SIDE = 6

NOW, BEFORE = 0, 1  # fields of the angles


class Openings(NamedTuple):
    """Opening h has the sides 2h and 2h + 1."""

    ends: np.ndarray  # (2h,) particles of the sides
    sides: np.ndarray  # (2h, SIDE, lanes)
    angles: np.ndarray  # (h, 2, lanes) now and one step ago (rad)
    followed: bool  # whether they are needed in every step
    track: np.ndarray  # ((instants + 1) h, 1, lanes) recorded


@hook(Openings)
def forces(part, world, now):
    """None; but the kinds that act on openings follow, and need them."""
    if part.followed:
        update(part, world.state)


@kernel
def update(part, state):
    """New openings, which are functions of the configuration; the last only picks the turn."""
    sides, angles = part.sides, part.angles
    for h in range(angles.shape[0]):
        one, two = part.ends[2 * h], part.ends[2 * h + 1]
        axes = frame(state, one)
        axis = to_global(axes, get3(sides, 2 * h, AXIS))
        first = to_global(axes, get3(sides, 2 * h, REFERENCE))
        second = to_global(frame(state, two), get3(sides, 2 * h + 1, REFERENCE))
        angle = arctan2(dot(axis, cross(first, second)), dot(first, second))
        last = load(angles, h, NOW)
        store(angles, h, BEFORE, last)
        turns = floor((last - angle) * (1.0 / TURN) + 0.5)
        store(angles, h, NOW, angle + TURN * turns)


@kernel
def turn(openings, state, h, moment):
    """Add a moment about the axis of hinge h to its second particle, its opposite to the first."""
    one, two = openings.ends[2 * h], openings.ends[2 * h + 1]
    axis = to_global(frame(state, one), get3(openings.sides, 2 * h, AXIS))
    put3(state, two, M, moment * axis + get3(state, two, M))
    put3(state, one, M, (-1.0 * moment) * axis + get3(state, one, M))


@hook(Openings)
def record(part, world, row):
    """Record the openings."""
    if not part.followed:
        update(part, world.state)
    count = part.angles.shape[0]
    for h in range(count):
        store(part.track, row * count + h, 0, load(part.angles, h, NOW))
