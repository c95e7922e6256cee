"""Openings of hinges, and moments that act on them: for kinds that sit on hinges."""

import math

from fpm.kernels.angles import arctan2
from fpm.kernels.lanes import floor, load, store
from fpm.kernels.layout import M
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import cross, dot, get3, kernel, put3, to_global
from fpm.kinds.hinge_arrays import AXIS, BEFORE, NOW, REF

TURN = 2 * math.pi


@kernel
def update_openings(part, state):
    """New openings, which are functions of the configuration; the last only picks the turn."""
    bodies, openings = part.bodies, part.openings
    for h in range(openings.shape[0]):
        one, two = part.ends[2 * h], part.ends[2 * h + 1]
        axes = frame(state, one)
        axis = to_global(axes, get3(bodies, 2 * h, AXIS))
        first = to_global(axes, get3(bodies, 2 * h, REF))
        second = to_global(frame(state, two), get3(bodies, 2 * h + 1, REF))
        angle = arctan2(dot(axis, cross(first, second)), dot(first, second))
        last = load(openings, h, NOW)
        store(openings, h, BEFORE, last)
        turns = floor((last - angle) * (1.0 / TURN) + 0.5)
        store(openings, h, NOW, angle + TURN * turns)


@kernel
def turn_hinge(hinges, state, h, moment):
    """Add a moment about the axis of hinge h to its second particle, its opposite to the first."""
    one, two = hinges.ends[2 * h], hinges.ends[2 * h + 1]
    axis = to_global(frame(state, one), get3(hinges.bodies, 2 * h, AXIS))
    put3(state, two, M, moment * axis + get3(state, two, M))
    put3(state, one, M, (-1.0 * moment) * axis + get3(state, one, M))
