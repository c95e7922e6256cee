"""Frames of particles, their momenta and forces, kept at instants (probe.py)."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.layout import D2, D3, F, M, P, V, X
from fpm.kernels.vectors import get3, put3

# Of a particle whose frame is kept.
PLACE, SECOND, THIRD = 0, 3, 6  # position and directors (3 each)
FRAME = 9

# Of one whose forces are kept (3 each).
VELOCITY, MOMENTUM = 0, 3  # means of the half steps before and after the instant
ACCELERATION, CHANGE = 6, 9  # their changes over the step around it, of velocity and momentum
FORCE, MOMENT = 12, 15  # at the instant, before those of supports, damping and joints
FORCES = 18


class Probes(NamedTuple):
    """Arrays in which motion and forces of chosen particles are recorded; columns: above."""

    frames_of: np.ndarray  # (p,) indices of particles
    forces_of: np.ndarray  # (q,)
    frames: np.ndarray  # ((instants + 1) p, FRAME, lanes)
    forces: np.ndarray  # ((instants + 1) q, FORCES, lanes) m/s, N m s, m/s², N m, N, N m


@hook(Probes)
def record(part, world, row):
    """Record the forces (N) and moments (N m) on chosen particles, before the step clears them."""
    count = part.forces_of.shape[0]
    for n in range(count):
        i, index = part.forces_of[n], row * count + n
        put3(part.forces, index, FORCE, get3(world.state, i, F))
        put3(part.forces, index, MOMENT, get3(world.state, i, M))


@hook(Probes)
def record_step(part, world, row, timing):
    """Record poses of chosen particles in part.frames; in part.forces their velocities (m/s) and
    angular momenta (N m s), means over both half steps, and the changes of both (m/s², N m)."""
    start, state = world.start_state, world.state
    count = part.frames_of.shape[0]
    for n in range(count):
        i, index = part.frames_of[n], row * count + n
        put3(part.frames, index, PLACE, get3(start, i, X))
        put3(part.frames, index, SECOND, get3(start, i, D2))
        put3(part.frames, index, THIRD, get3(start, i, D3))
    count = part.forces_of.shape[0]
    for n in range(count):
        i, index = part.forces_of[n], row * count + n
        for k, mean, change in ((V, VELOCITY, ACCELERATION), (P, MOMENTUM, CHANGE)):
            old, new = get3(start, i, k), get3(state, i, k)
            put3(part.forces, index, mean, 0.5 * (old + new))
            put3(part.forces, index, change, (1.0 / timing.step) * (new - old))
