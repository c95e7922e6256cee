"""Dead loads and their work."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import kick_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import F, M, X
from fpm.kernels.rotation import frame
from fpm.kernels.vectors import add3, cross, dot, get3, put3, to_global

NUMBERS = "force", "moment", "arm"
FORCE, MOMENT, ARM = 0, 3, 6

# Of a load, at the start of the step: the end of its arm, and the particle's axes (3 each).
END, AXES = 0, 3
STATE = 12


class Loads(NamedTuple):
    """Arrays of all l loads (lanes: samples); what stands in `state` is told above."""

    particle: np.ndarray  # (l,) index of its particle
    curve: np.ndarray  # (l,) of its curve of time; -1: constant 1
    numbers: np.ndarray  # (l, 9, lanes) N, N m, in global axes; m, in the particle's
    state: np.ndarray  # (l, STATE, lanes)
    account: int  # index of their work in World.accounts


@hook(Loads)
def forces(part, world, timing):
    """Add the forces (N), at the ends of arms, and moments (N m) of loads; keep these ends and the
    particles' axes for `work_after`."""
    state = world.state
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        factor = kick_mean(world, part.curve[n], timing)
        force = factor * get3(part.numbers, n, FORCE)
        moment = factor * get3(part.numbers, n, MOMENT)
        axes = frame(state, i)
        arm = to_global(axes, get3(part.numbers, n, ARM))
        add3(state, i, F, force)
        add3(state, i, M, moment + cross(arm, force))
        put3(part.state, n, END, get3(state, i, X) + arm)
        for k in range(3):
            put3(part.state, n, AXES + 3 * k, axes[k])


@hook(Loads)
def work_after(part, world, timing):
    """Add the work (J) of loads in this step: mean of the curve over both kicks, times force and
    moment, times the motion. That of a constant force is exact however its arm turns. Of a rotation
    by t, the products of the axes give the sine, from which t follows by a series."""
    state = world.state
    total = 0.0 * load(state, 0, X)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        axes = frame(state, i)
        end = get3(state, i, X) + to_global(axes, get3(part.numbers, n, ARM))
        rotation = 0.5 * cross(get3(part.state, n, AXES), axes[0])
        for k in range(1, 3):
            rotation = rotation + 0.5 * cross(get3(part.state, n, AXES + 3 * k), axes[k])
        rotation = (1.0 + (1.0 / 6.0) * dot(rotation, rotation)) * rotation
        factor = kick_mean(world, part.curve[n], timing)
        factor = 0.5 * (factor + kick_mean(world, part.curve[n], timing, 1))
        work = dot(get3(part.numbers, n, FORCE), end - get3(part.state, n, END))
        total = total + factor * (work + dot(get3(part.numbers, n, MOMENT), rotation))
    store(world.accounts, 0, part.account, load(world.accounts, 0, part.account) + total)
