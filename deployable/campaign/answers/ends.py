"""The ends of each quantity's interval: sought with a surrogate, simulated, and sought again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import SAME, Bench
from deployable.campaign.answers.limits import Asked, judged

TOLD = 1e-3
"""An end has settled when the surrogate promises no more than this share of the width beyond what
was simulated. Also the share of the box that may remain open about where something happens."""

_BORDER = 8  # further runs in a round about where something happens: eight take what three do


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


def settle(bench: Bench, rounds: int, asked: Sequence[Asked] = ()) -> list[Ends]:
    """The ends of all quantities, after at most so many rounds of further runs: where surrogates
    have their ends, until they promise no more, about where something ceases to happen, and at the
    places that decide the limits that are asked."""
    for number in range(rounds + 1):
        surrogates = bench.surrogates()
        ends = [_ends(bench, q, s) for q, s in enumerate(surrogates)]
        if number == rounds:
            break
        points = [point for end in ends for point in _wanted(bench, end)]
        if asked:
            places = judged(bench, surrogates, asked).places
            points += [at for at in places if bench.nearest(at)[1] > SAME]
        if not points:
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
    if occurrence.open > TOLD:
        points += list(occurrence.infill_points(_BORDER))
    return points
