"""Dead loads and their work."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.curves import kick_mean
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, store
from fpm.kernels.layout import BY_SPIN, D2, D3, HALF, F, M, P, X
from fpm.kernels.rotation import frame, half_turn
from fpm.kernels.vectors import add3, cross, dot, get3, put3, to_global, to_local

NUMBERS = "force", "moment", "arm"
FORCE, MOMENT, ARM = 0, 3, 6

# Of a load, at the start of the step: the end of its arm; then the particle's axes, at D2 and D3.
END = 0
STATE = 9


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
        for k in (D2, D3):
            put3(part.state, n, k, get3(state, i, k))


@hook(Loads)
def work_after(part, world, timing):
    """Add the work (J) of loads in this step: mean of the curve over both kicks, times force and
    moment, times the motion. That of a constant force is exact however its arm turns. Rotations
    follow from momenta, of driven particles from spins, so that whole turns in a step count."""
    state = world.state
    total = 0.0 * load(state, 0, X)
    for n in range(part.particle.shape[0]):
        i = part.particle[n]
        end = get3(state, i, X) + to_global(frame(state, i), get3(part.numbers, n, ARM))
        axes, spin = frame(part.state, n), get3(state, i, P)
        half = half_turn(to_local(axes, spin), get3(world.particles, i, HALF))
        by_spin = timing.step * load(world.particles, i, BY_SPIN)
        rotation = 2.0 * to_global(axes, half) + by_spin * spin
        factor = kick_mean(world, part.curve[n], timing)
        factor = 0.5 * (factor + kick_mean(world, part.curve[n], timing, 1))
        work = dot(get3(part.numbers, n, FORCE), end - get3(part.state, n, END))
        total = total + factor * (work + dot(get3(part.numbers, n, MOMENT), rotation))
    store(world.accounts, 0, part.account, load(world.accounts, 0, part.account) + total)
