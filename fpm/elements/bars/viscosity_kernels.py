"""Forces of the bulk viscosity of beams, and what they take out (theory: viscosity.py)."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load, sqrt, store
from fpm.kernels.layout import F, X
from fpm.kernels.vectors import add3, dot, get3

# Kept of an element: the rate of its length in the middle of the last step (m/s; at first that at
# the start), its tension at the last positions (N), and its length there (m).
RATE, TENSION, LENGTH = 0, 1, 2
HISTORY = 3


class Viscous(NamedTuple):
    """Arrays of m beam elements' dampers (lanes: samples). nodes (m, 2): particle indices of both
    ends; damping (m, 1, lanes): N s/m; history (m, 3, lanes): rate of the length (m/s) in the last
    step's middle, tension (N), length (m) at its end; account: index of the loss in accounts."""

    nodes: np.ndarray
    damping: np.ndarray
    history: np.ndarray
    account: int


@hook(Viscous)
def forces(part, world, timing):
    """Add the tensions (N) of all beam elements' dampers, damping times rate of the length, to the
    forces on their end particles, and what they lose in the step that ends now (J) to
    World.accounts. part: their arrays (Viscous); world: solver state, changed; timing: StepTime
    (s). The rate is extrapolated from the last two steps; losses are by the trapezium rule."""
    state, history = world.state, part.history
    loss = load(world.accounts, 0, part.account)
    for e in range(part.nodes.shape[0]):
        a, b = part.nodes[e, 0], part.nodes[e, 1]
        chord = get3(state, b, X) - get3(state, a, X)
        length = sqrt(dot(chord, chord))
        last = load(history, e, RATE)
        rate = last
        growth = length - load(history, e, LENGTH)
        if timing.time > 0.0:
            half = growth * (1.0 / timing.step)
            rate = 1.5 * half - 0.5 * last
            store(history, e, RATE, half)
        tension = load(part.damping, e, 0) * rate
        loss = loss + 0.5 * (tension + load(history, e, TENSION)) * growth
        store(history, e, TENSION, tension)
        store(history, e, LENGTH, length)
        force = (tension / length) * chord
        add3(state, a, F, force)
        add3(state, b, F, -1.0 * force)
    store(world.accounts, 0, part.account, loss)
