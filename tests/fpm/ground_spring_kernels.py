"""Kernels of the springs to the ground."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.events import note_crossing
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import any_negative, load, sqrt, store
from fpm.kernels.layout import F, X
from fpm.kernels.vectors import add3, dot, get3
from fpm.kernels.world import Log

ANCHOR, STIFFNESS, REST = 0, 3, 4
NOW, BEFORE = 0, 1


class GroundSprings(NamedTuple):
    on: np.ndarray  # (s,) particles
    spring: np.ndarray  # (s, 5, lanes)
    stretch: np.ndarray  # (s, 2, lanes) now and one step ago (m)
    track: np.ndarray  # ((instants + 1) s, 1, lanes) recorded lengths
    rows: np.ndarray  # (s, 1, lanes)
    log: Log


@hook(GroundSprings)
def forces(part, world, now):
    for i in range(part.on.shape[0]):
        away = get3(world.state, part.on[i], X) - get3(part.spring, i, ANCHOR)
        length = sqrt(dot(away, away))
        stretch = length - load(part.spring, i, REST)
        store(part.stretch, i, BEFORE, load(part.stretch, i, NOW))
        store(part.stretch, i, NOW, stretch)
        pull = (-1.0 * load(part.spring, i, STIFFNESS) * stretch / length) * away
        add3(world.state, part.on[i], F, pull)


@hook(GroundSprings)
def note_events(part, world, now):
    for i in range(part.on.shape[0]):
        if any_negative(load(part.stretch, i, NOW) * load(part.stretch, i, BEFORE)):
            for s in range(part.stretch.shape[2]):
                before, after = part.stretch[i, BEFORE, s], part.stretch[i, NOW, s]
                note_crossing(part.log, s, i, before, after, now)


@hook(GroundSprings)
def energy_of(part, world, i):
    stretch = load(part.stretch, i, NOW)
    return 0.5 * load(part.spring, i, STIFFNESS) * stretch * stretch


@hook(GroundSprings)
def record(part, world, row):
    count = part.on.shape[0]
    for i in range(count):
        length = load(part.stretch, i, NOW) + load(part.spring, i, REST)
        store(part.track, row * count + i, 0, length)
