"""The ends of each quantity's interval: sought with a surrogate, simulated, and sought again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from campaign.answers.bench import SAME, Bench

TOLD = 1e-3
"""An end has settled when the surrogate promises no more than this share of the width beyond what
was simulated. Also the share of the box that may remain open about where something happens."""

_BORDER = 4  # further runs in a round about where something happens


@dataclass(frozen=True)
class Ends:
    """The interval of a quantity, by its surrogate and by the runs.

    surrogate: `intervals.scalars.ScalarSurrogate` from all runs; found: the `Extremes` of it.
    lower, upper: the least and largest simulated value, NaN where there is none; argmin, argmax
    (k): unit coordinates of the runs. moving (2): whether the surrogate promises more at an end.
    """

    surrogate: Any
    found: Any
    lower: float
    upper: float
    argmin: np.ndarray
    argmax: np.ndarray
    moving: tuple[bool, bool]

    @property
    def outer(self) -> tuple[float, float]:
        """The interval that contains both the simulated ends and the surrogate's."""
        return (
            float(np.fmin(self.lower, self.found.low)),
            float(np.fmax(self.upper, self.found.high)),
        )


def settle(bench: Bench, rounds: int) -> list[Ends]:
    """The ends of all quantities, after at most so many rounds of further runs: where surrogates
    have their ends, until they promise no more, and about where something ceases to happen."""
    for number in range(rounds + 1):
        ends = [_ends(bench, q, s) for q, s in enumerate(bench.surrogates())]
        points = [point for end in ends for point in _wanted(bench, end)]
        if number == rounds or not points:
            break
        before = len(bench.unit)
        bench.add(points)
        if len(bench.unit) == before:
            break
    return ends


def _ends(bench: Bench, q: int, surrogate: Any) -> Ends:
    found, values = surrogate.range(), bench.numbers[:, q]
    if not np.isfinite(values).any():
        nowhere = np.full(bench.unit.shape[1], np.nan)
        return Ends(surrogate, found, np.nan, np.nan, nowhere, nowhere, (False, False))
    at = int(np.nanargmin(values)), int(np.nanargmax(values))
    lower, upper = float(values[at[0]]), float(values[at[1]])
    slack = TOLD * max(upper - lower, found.width)
    moving = found.low < lower - slack, found.high > upper + slack
    return Ends(surrogate, found, lower, upper, *bench.unit[list(at)], moving)


def _wanted(bench: Bench, ends: Ends) -> list[np.ndarray]:
    """Where the next runs should be for one quantity."""
    points = []
    for moving, at in zip(ends.moving, (ends.found.argmin, ends.found.argmax), strict=True):
        if moving and bench.nearest(at)[1] > SAME:
            points.append(at)
    occurrence = ends.surrogate.occurrence
    if occurrence.share()[1] > TOLD:
        points += list(occurrence.between(_BORDER))
    return points
