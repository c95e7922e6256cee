"""Forces of drag by the square of the speed, and what they take out (theory: drag.py)."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store
from fpm.kernels.layout import F, M, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import add3, cross, dot, get3, put3, to_global

NUMBERS = "arm", "axis", "wind", "factor", "component"
ARM, AXIS, WIND, FACTOR, COMPONENT = 0, 3, 6, 9, 10

# Of a drag at the last positions: its place (m) and force (N), and the velocity of that place in
# the middle of the last step (m/s; at first that at the start).
PLACE, FORCE, VELOCITY = 0, 3, 6
STATE = 9


class Drags(NamedTuple):
    """Arrays of all d drags (lanes: samples); what stands in `state` is told above."""

    particle: np.ndarray  # (d,) index of its particle
    numbers: np.ndarray  # (d, 11, lanes) m, 1, m/s, kg/m, 1: the wind in global axes
    state: np.ndarray  # (d, STATE, lanes)
    account: int  # index of the loss in World.accounts


@hook(Drags)
def forces(part, world, timing):
    """Add the forces (N) and moments (N m) of all drags, and what they lose (J). Velocities are
    extrapolated from the last two steps; losses are by the trapezium rule along the paths."""
    state, numbers, history = world.state, part.numbers, part.state
    loss = load(world.accounts, 0, part.account)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        axes = frame(state, i)
        half = get3(history, n, VELOCITY)
        velocity = half
        arm = to_global(axes, get3(numbers, n, ARM))
        place = get3(state, i, X) + arm
        path = place - get3(history, n, PLACE)
        if timing.time > 0.0:
            half = (1.0 / timing.step) * path
            velocity = 1.5 * half - 0.5 * velocity
        axis = to_global(axes, get3(numbers, n, AXIS))
        component = load(numbers, n, COMPONENT)
        velocity = velocity - get3(numbers, n, WIND)
        # u - (a u) a across the axis a, (a u) a along it.
        velocity = component * velocity + ((1.0 - 2.0 * component) * dot(axis, velocity)) * axis
        force = (-1.0 * load(numbers, n, FACTOR) * sqrt(dot(velocity, velocity))) * velocity
        if timing.time > 0.0:
            loss = loss - 0.5 * dot(force + get3(history, n, FORCE), path)
        put3(history, n, PLACE, place)
        put3(history, n, FORCE, force)
        put3(history, n, VELOCITY, half)
        add3(state, i, F, force)
        add3(state, i, M, cross(arm, force))
    store(world.accounts, 0, part.account, loss)
