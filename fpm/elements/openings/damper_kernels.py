"""Moments of viscous dampers, and what they lose."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import follow_rate, lose
from fpm.elements.openings.opening_kernels import Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load

NUMBERS = ("damping",)
DAMPING = 0


class Dampers(NamedTuple):
    """Arrays of all d dampers. on (d,): index of each one's hinge; numbers (d, 1, lanes): damping
    (N m s/rad); openings: arrays of all openings; past (d, HISTORY, lanes): rate and moment of the
    last step; account: index of the loss in World.accounts."""

    on: np.ndarray
    numbers: np.ndarray
    openings: Openings
    past: np.ndarray
    account: int


@hook(Dampers)
def forces(part, world, timing):
    """Add the moments (N m) of viscous dampers, -c times the rate of the opening, and their losses
    (J). part: all dampers (Dampers); world: solver state (World); timing: times of the step (s)."""
    for i in range(part.on.shape[0]):
        h = part.on[i]
        rate = follow_rate(part.openings, part.past, i, h, timing)
        moment = -1.0 * load(part.numbers, i, DAMPING) * rate
        turn(part.openings, world.state, h, moment)
        lose(world, part.account, part.openings, part.past, i, h, moment)
