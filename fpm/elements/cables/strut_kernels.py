"""Forces, energies and losses of struts (theory: strut.py)."""

from typing import NamedTuple

import numpy as np

from fpm.elements.cables.cable_kernels import TINY
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store, where_negative
from fpm.kernels.layout import F, M, X
from fpm.kernels.record import edge
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import add3, cross, dot, get3, to_global

FIRST, SLOPE, LIFT, DAMPING = range(4)  # of a strut: Strut.numbers
PLACE, BEND = 0, 1  # of a point of a table: length, and change of slope there

# Of a strut, at the last positions: distance of its points (m), its rate in the middle of the last
# step (m/s; at first that at the start), force of the damper and of all (N).
LENGTH, RATE, DAMPER, FORCE = range(4)
STATE = 4
TRACK = 2


class Struts(NamedTuple):
    """Arrays of all s struts (lanes: samples); what stands in `numbers` and `state` is told
    above."""

    particle: np.ndarray  # (s, 2) particles of its points
    arms: np.ndarray  # (2 s, 3, lanes) from these to the points, in their axes (m)
    start: np.ndarray  # (s + 1,) first point of the table of each
    points: np.ndarray  # (p, 2, lanes) m, N/m
    numbers: np.ndarray  # (s, 4, lanes) N, N/m, J, N s/m: the first three at the first point
    state: np.ndarray  # (s, STATE, lanes)
    account: int  # index of the loss in World.accounts
    rows: np.ndarray  # (s, 1, lanes) energy of each (J)
    track: np.ndarray  # ((instants + 1) s, TRACK, lanes) recorded force (N) and length (m)


@hook(Struts)
def forces(part, world, timing):
    """Add the forces (N) and moments (N m) of struts, and what their dampers lose in the step (J);
    where a length passes a point of a table, `edge` corrects the work."""
    loss = load(world.accounts, 0, part.account)
    for n in range(part.particle.shape[0]):
        i, j = part.particle[n, 0], part.particle[n, 1]
        arm = to_global(frame(world.state, i), get3(part.arms, 2 * n, 0))
        second_arm = to_global(frame(world.state, j), get3(part.arms, 2 * n + 1, 0))
        chord = (get3(world.state, j, X) + second_arm) - (get3(world.state, i, X) + arm)
        length, old = sqrt(dot(chord, chord)), load(part.state, n, LENGTH)
        force = load(part.numbers, n, FIRST)
        reach = length - load(part.points, part.start[n], PLACE)
        force = force + load(part.numbers, n, SLOPE) * reach
        for k in range(part.start[n], part.start[n + 1]):
            new, last = length - load(part.points, k, PLACE), old - load(part.points, k, PLACE)
            ramp = where_negative(new, 0.0, new) + edge(new, last)
            force = force + load(part.points, k, BEND) * ramp
        rate = load(part.state, n, RATE)
        if timing.time > 0.0:
            half = (1.0 / timing.step) * (length - old)
            rate = 1.5 * half - 0.5 * rate
            store(part.state, n, RATE, half)
        damper = -1.0 * load(part.numbers, n, DAMPING) * rate
        loss = loss - 0.5 * (damper + load(part.state, n, DAMPER)) * (length - old)
        store(part.state, n, LENGTH, length)
        store(part.state, n, DAMPER, damper)
        store(part.state, n, FORCE, force + damper)
        push = ((force + damper) / (length + TINY)) * chord
        add3(world.state, j, F, push)
        add3(world.state, j, M, cross(second_arm, push))
        add3(world.state, i, F, -1.0 * push)
        add3(world.state, i, M, cross(push, arm))
    store(world.accounts, 0, part.account, loss)


@hook(Struts)
def energy_of(part, world, n):
    """Return the energy (J, lanes) stored in strut n, counted from its least value."""
    length = load(part.state, n, LENGTH)
    reach = length - load(part.points, part.start[n], PLACE)
    half = 0.5 * load(part.numbers, n, SLOPE) * reach
    energy = load(part.numbers, n, LIFT) - (load(part.numbers, n, FIRST) + half) * reach
    for k in range(part.start[n], part.start[n + 1]):
        reach = length - load(part.points, k, PLACE)
        ramp = where_negative(reach, 0.0, reach)
        energy = energy - 0.5 * load(part.points, k, BEND) * ramp * ramp
    return energy


@hook(Struts)
def record(part, world, row):
    count = part.particle.shape[0]
    for n in range(count):
        store(part.track, row * count + n, 0, load(part.state, n, FORCE))
        store(part.track, row * count + n, 1, load(part.state, n, LENGTH))
