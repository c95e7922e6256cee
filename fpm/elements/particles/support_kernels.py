"""Forces along held axes are taken out before the kick."""

from typing import NamedTuple

import numpy as np

from fpm.kernels.hooks import hook
from fpm.kernels.layout import F, M
from fpm.kernels.vectors import get3, put3, times

ALONG, ABOUT = 0, 3


class Held(NamedTuple):
    """on (f,) particles held along some axes only; free (f, 6, lanes): 1 free, 0 held."""

    on: np.ndarray
    free: np.ndarray


@hook(Held)
def restrain(part, world, now):
    """Take out forces and moments along held axes."""
    state = world.state
    for n in range(part.on.shape[0]):
        i = part.on[n]
        put3(state, i, F, times(get3(part.free, n, ALONG), get3(state, i, F)))
        put3(state, i, M, times(get3(part.free, n, ABOUT), get3(state, i, M)))
