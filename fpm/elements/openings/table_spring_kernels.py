"""Moments and energies of springs by tables: a sum of ramps, one from each point of a table."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.opening_kernels import NEW, OLD, Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, where_negative
from fpm.kernels.record import edge

ANGLE, BEND = 0, 1  # of a point: where, and by how much the slope of the moment changes there

NUMBERS = "first", "lift"
FIRST, LIFT = range(2)  # of a spring: moment up to the first point, and energy there


class TableSprings(NamedTuple):
    """Arrays of all s springs by tables (lanes: samples)."""

    hinge: np.ndarray  # (s,) index of its hinge
    start: np.ndarray  # (s + 1,) first point of each
    points: np.ndarray  # (p, 2, lanes) rad, N m/rad
    numbers: np.ndarray  # (s, 2, lanes) N m, J
    openings: Openings  # of all hinges
    rows: np.ndarray  # (s, 1, lanes) energy of each (J)


@hook(TableSprings)
def forces(part, world, timing):
    """Add the moments (N m); where an opening passes a point, `edge` corrects the work."""
    angles = part.openings.angles
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        moment = load(part.numbers, i, FIRST)
        for j in range(part.start[i], part.start[i + 1]):
            new = load(angles, h, NEW) - load(part.points, j, ANGLE)
            old = load(angles, h, OLD) - load(part.points, j, ANGLE)
            ramp = where_negative(new, 0.0, new) + edge(new, old)
            moment = moment + load(part.points, j, BEND) * ramp
        turn(part.openings, world.state, h, moment)


@hook(TableSprings)
def energy_of(part, world, i):
    """Return the energy (J, lanes) stored in spring i, counted from its least within the table."""
    psi = load(part.openings.angles, part.hinge[i], NEW)
    first = psi - load(part.points, part.start[i], ANGLE)
    energy = load(part.numbers, i, LIFT) - load(part.numbers, i, FIRST) * first
    for j in range(part.start[i], part.start[i + 1]):
        reach = psi - load(part.points, j, ANGLE)
        ramp = where_negative(reach, 0.0, reach)
        energy = energy - 0.5 * load(part.points, j, BEND) * ramp * ramp
    return energy
