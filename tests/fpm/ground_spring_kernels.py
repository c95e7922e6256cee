"""Kernels of the springs to the ground."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store
from fpm.kernels.layout import F, X
from fpm.kernels.record import note_crossings
from fpm.kernels.vectors import add3, dot, get3
from fpm.kernels.world import Log

NUMBERS = "anchor", "stiffness", "rest"
ANCHOR, STIFFNESS, REST = 0, 3, 4

NOW, BEFORE = 0, 1  # stretch (m) now and one step ago
STATE = 2

TRACK = 1  # recorded: length (m)


class GroundSprings(NamedTuple):
    particle: np.ndarray  # (s,)
    numbers: np.ndarray  # (s, 5, lanes)
    state: np.ndarray  # (s, STATE, lanes)
    track: np.ndarray  # ((instants + 1) s, TRACK, lanes)
    rows: np.ndarray  # (s, 1, lanes)
    log: Log


@hook(GroundSprings)
def forces(part, world, timing):
    for i in range(part.particle.shape[0]):
        away = get3(world.state, part.particle[i], X) - get3(part.numbers, i, ANCHOR)
        length = sqrt(dot(away, away))
        stretch = length - load(part.numbers, i, REST)
        store(part.state, i, BEFORE, load(part.state, i, NOW))
        store(part.state, i, NOW, stretch)
        pull = (-1.0 * load(part.numbers, i, STIFFNESS) * stretch / length) * away
        add3(world.state, part.particle[i], F, pull)


@hook(GroundSprings)
def note_events(part, world, timing):
    for i in range(part.particle.shape[0]):
        before, after = load(part.state, i, BEFORE), load(part.state, i, NOW)
        note_crossings(part.log, i, before, after, timing)


@hook(GroundSprings)
def energy_of(part, world, i):
    stretch = load(part.state, i, NOW)
    return 0.5 * load(part.numbers, i, STIFFNESS) * stretch * stretch


@hook(GroundSprings)
def record(part, world, row):
    count = part.particle.shape[0]
    for i in range(count):
        length = load(part.state, i, NOW) + load(part.numbers, i, REST)
        store(part.track, row * count + i, 0, length)
