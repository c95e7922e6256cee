"""The arrays of openings that are held exactly (turn.py), and where each quantity stands."""

from typing import NamedTuple

import numpy as np

HOLDS = 0  # -1 where the opening is held, 1 where it is free
TARGET = 1  # at which opening, at the end of the step (rad)
RATE = 2  # of the opening over the step, as the joints were solved last (rad/s)
IMPULSE = 3  # of the step, on the hinge's second particle (N m s)
NEEDED = 4  # the same as the joints were solved last
TURN = 5


class Turns(NamedTuple):
    """What holds openings, and the joints' solver, tell each other."""

    state: np.ndarray  # (t, TURN, lanes)
    blow: np.ndarray  # (1, 1, lanes) when a blow comes, in steps from the start of this one
