"""Moments of viscous dampers, and what they lose."""

from typing import NamedTuple

import numpy as np

from fpm.elements.openings.losses_kernels import add_loss, follow_rate
from fpm.elements.openings.opening_kernels import Openings, turn
from fpm.kernels.hooks import hook
from fpm.kernels.lanes import load

NUMBERS = ("damping",)
DAMPING = 0


class Dampers(NamedTuple):
    """Arrays of all d dampers (lanes: samples). hinge (d,): index of each one's hinge; numbers (d,
    1, lanes): damping (N m s/rad); openings: all joint coordinates; rates (d, 2, lanes): rate
    (rad/s) and moment (N m) of the last step; account: index in World.accounts of the loss."""

    hinge: np.ndarray
    numbers: np.ndarray
    openings: Openings
    rates: np.ndarray
    account: int


@hook(Dampers)
def forces(part, world, timing):
    for i in range(part.hinge.shape[0]):
        h = part.hinge[i]
        rate = follow_rate(part.openings, part.rates, i, h, timing)
        moment = -1.0 * load(part.numbers, i, DAMPING) * rate
        turn(part.openings, world.state, h, moment)
        add_loss(world, part.account, part.openings, part.rates, i, h, moment)
