"""What mesh and step add to the border of the part of the box in which something happens: runs near
it again, with the finest of both.

Where these agree about what happens, the border fits the finer runs as well as it does the others.
Else it moves: by how much finer runs change what the border is told by, as the time of an event
that may come too late; or, where runs only tell whether it happens, to where finer ones cease to
differ. That is continued as if it fell at the first order: what happens or not tells no order.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import Bench
from deployable.campaign.plan.plan import Plan
from deployable.intervals.estimates import richardson_error

_SIDE = 4  # runs at once on each side of a border: eight side by side cost what three do
_HALVINGS = 3  # of the stretch on which a border lies


def moved(bench: Bench, q: int, occurrence: Any, finest: Plan) -> tuple[float, float]:
    """How far the border of quantity `q` moves, as a change of the certainty; and the change of the
    number next to it, NaN where no run there has it. Where all runs agree, by how much their
    margins change; 0 where they have none."""
    happens = np.isfinite(bench.numbers[:, q])
    if occurrence.is_mixed:
        certain, told = occurrence.certainty(bench.unit), occurrence.run_certainty
    elif np.isfinite(bench.margins[:, q]).all():
        certain, told = bench.margins[:, q], lambda numbers, margins: margins
    else:
        return 0.0, np.nan
    border, number, taken, differ = 0.0, np.nan, np.zeros(0, int), np.zeros(0, bool)
    for rows in _farther(np.abs(certain), happens):
        numbers, margins = (each[:, q] for each in bench.told(finest, bench.unit[rows]))
        before = told(bench.numbers[rows, q], bench.margins[rows, q])
        now = np.isfinite(numbers) != happens[rows]
        change = np.abs(told(numbers, margins) - before)
        lost = now * np.abs(certain[rows])
        border = max(border, float(np.where(np.isfinite(change), change, lost).max()))
        number = np.fmax(number, np.fmax.reduce(np.abs(numbers - bench.numbers[rows, q])))
        taken, differ = np.concatenate([taken, rows]), np.concatenate([differ, now])
        if not now.any() or (np.isfinite(change).all() and np.isfinite(number)):
            break
    if differ.any() and not np.isfinite(change).any():
        ends = _stretches(bench.unit[taken], happens[taken], differ, np.abs(certain[taken]))
        border = max(border, _ceases(bench, q, occurrence, finest, *ends))
    border, number = map(float, richardson_error(np.array([border, number])))
    return border, number


def _farther(size: np.ndarray, happens: np.ndarray) -> Iterator[np.ndarray]:
    """Rows of runs on both sides of a border, by the size (R) of what tells where they lie: the
    nearest first, then each time twice as far in their order."""
    order = np.argsort(size, kind="stable")
    sides = order[happens[order]], order[~happens[order]]
    first, last = 0, _SIDE
    while first < max(map(len, sides)):
        apart = max(1, (last - first) // _SIDE)
        yield np.concatenate([side[first:last:apart] for side in sides])
        first, last = last, 2 * last


def _stretches(
    unit: np.ndarray, happens: np.ndarray, differ: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Unit points (P, k) at which finer runs differ, the farthest from the border, and next to each
    one on its side at which none does."""
    from_, to = [], []
    for row in np.flatnonzero(differ)[np.argsort(-size[differ], kind="stable")][: 2 * _SIDE]:
        held = np.flatnonzero(~differ & (happens == happens[row]))
        if len(held):
            away = np.linalg.norm(unit[held] - unit[row], axis=1)
            from_.append(unit[row])
            to.append(unit[held[away.argmin()]])
    return np.array(from_).reshape(-1, unit.shape[1]), np.array(to).reshape(-1, unit.shape[1])


def _ceases(
    bench: Bench, q: int, occurrence: Any, finest: Plan, differs: np.ndarray, agrees: np.ndarray
) -> float:
    """The largest size of the certainty at which finer runs differ, between points (P, k)."""
    if not len(differs):
        return 0.0
    happens = occurrence.evaluate(differs)
    for _ in range(_HALVINGS):
        middle = (differs + agrees) / 2
        numbers, _ = bench.told(finest, middle)
        now = (np.isfinite(numbers[:, q]) != happens)[:, None]
        differs, agrees = np.where(now, middle, differs), np.where(now, agrees, middle)
    return float(np.abs(occurrence.certainty((differs + agrees) / 2)).max())
