"""The best choice of some parameters, judged by the worst case over the intervals about it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..designs.scan import scan_points
from .requirements import Limit
from .surrogate import ScalarSurrogate

_GRID, _ZOOMED, _ZOOMS, _SPREAD = 33, 7, 22, 128

# From choices (c) to the corners (k each), in unit coordinates, of the box that they leave.
BoxOf = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


ENDS = ("upper", "lower", "width")
"""What of a number's interval may be a goal."""


@dataclass(frozen=True)
class Goal:
    """What is to be small: `kind`, one of `ENDS`, of a number's interval over the box,
    times `sign`: -1 where it is to be large."""

    surrogate: ScalarSurrogate
    kind: str
    sign: float = 1.0

    def value(self, lower: np.ndarray, upper: np.ndarray) -> tuple[float, np.ndarray]:
        """The goal over a part (k each) of the box, and where its deciding end is (k)."""
        if self.kind == "width":
            found = self.surrogate.range(lower, upper, climbs=1)
            return found.width, found.argmax
        return self.surrogate.end(1.0 if self.kind == "upper" else -1.0, lower, upper)


@dataclass(frozen=True)
class Choice:
    """A choice (c): its goals (g), and its worst slack of all limits, with each one's (l) and where
    it is (l, k); `at` (g, k) are the places that decide the goals. Without limits the slack is
    infinite."""

    values: np.ndarray
    goals: np.ndarray
    slack: float
    slacks: np.ndarray
    worst: np.ndarray
    at: np.ndarray

    @property
    def is_allowed(self) -> bool:
        """Whether the whole box about the choice keeps every limit."""
        return self.slack >= 0


def judge(values: np.ndarray, goals: Sequence[Goal], limits: Sequence[Limit], box: BoxOf) -> Choice:
    """A choice (c) with its goals and its worst case."""
    lower, upper = box(values)
    found = [goal.value(lower, upper) for goal in goals]
    kept = [limit.worst(lower, upper) for limit in limits]
    slacks = np.array([slack for slack, _ in kept])
    return Choice(
        np.asarray(values, dtype=float),
        np.array([value for value, _ in found]),
        float(slacks.min(initial=np.inf)),
        slacks,
        np.array([at for _, at in kept]).reshape(len(kept), len(lower)),
        np.array([at for _, at in found]).reshape(len(found), len(lower)),
    )


def best_choice(
    goals: Sequence[Goal],
    limits: Sequence[Limit],
    ranges: Sequence[tuple[float, float]],
    box: BoxOf,
) -> tuple[Choice, list[Choice]]:
    """The choice within `ranges` (c pairs) that keeps every limit with the best first goal, or, if
    none does, the one that breaks them least; and all choices of the first grid.

    A grid (a Sobol sequence from three choices on), then finer and finer grids about the best.
    """
    ends = np.array(ranges, dtype=float)
    wide = ends[:, 1] > ends[:, 0]
    if len(ends) <= 2:
        count = _GRID if len(ends) == 1 else _ZOOMED + 6
        sizes = [count if free else 1 for free in wide]
        lines = [np.linspace(*end, size) for end, size in zip(ends, sizes, strict=True)]
        places = np.array(list(itertools.product(*lines)))
    else:
        unit = (scan_points(wide, _SPREAD) + 1) / 2
        places = ends[:, 0] + unit * (ends[:, 1] - ends[:, 0])

    def order(choice: Choice) -> tuple[bool, float]:
        value = goals[0].sign * choice.goals[0] if choice.is_allowed else -choice.slack
        return not choice.is_allowed, value if np.isfinite(value) else np.inf

    first = [judge(place, goals, limits, box) for place in places]
    best = min(first, key=order)
    reach = (ends[:, 1] - ends[:, 0]) * (1.5 / len(places) ** (1 / len(ends)))
    steps = np.linspace(-1.0, 1.0, _ZOOMED if len(ends) == 1 else 3)
    for _ in range(_ZOOMS):
        for offset in itertools.product(*[steps if free else [0.0] for free in wide]):
            place = np.clip(best.values + reach * offset, ends[:, 0], ends[:, 1])
            best = min(best, judge(place, goals, limits, box), key=order)
        reach = reach * (0.45 if len(ends) == 1 else 0.6)
    return best, first
