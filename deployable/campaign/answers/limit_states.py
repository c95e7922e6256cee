"""What mesh and step add to the border of where something happens: runs near it, with both finer.

Where these agree about what happens, the border fits the finer runs as well as it does the others.
Else it moves: by how much finer runs change what the border is told by, as the time of an event
that may come too late; or, where runs only tell whether it happens, to where finer ones cease to
differ. That is continued as if it fell at the first order: what happens or not tells no order."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.plan.plan import Plan
from deployable.intervals.estimates import extrapolate_error

_SIDE = 4  # runs at once on each side of a border: eight side by side cost what three do
_JUMP = 10.0  # times the median change of scores: more is a jump
_HALVINGS = 3  # of the stretch on which a border lies


def estimate_limit_state_error(
    model: ModelEvaluator, q: int, occurrence: Any, finest: Plan
) -> tuple[float, float]:
    """Estimate two errors by step and mesh near the border of where quantity `q` exists, by refined
    runs near it: of the decision function, whose sign tells the side, and of the quantity's value,
    NaN if no run has it. finest: plan with the finest step and mesh. If all runs have the quantity,
    or none, the first is the change of their event margins; 0 and NaN where these are not known."""
    happens = np.isfinite(model.numbers[:, q])
    if occurrence.is_mixed:
        scores, score = occurrence.decision(model.points), occurrence.run_decision
    elif np.isfinite(model.margins[:, q]).all():
        scores, score = model.margins[:, q], lambda numbers, margins: margins
    else:
        return 0.0, np.nan
    shift, number, test_rows, differs = 0.0, np.nan, np.zeros(0, int), np.zeros(0, bool)
    change = np.zeros(0)
    for rows in _iterate_rows(np.abs(scores), happens):
        if model.account.allowance < len(rows):
            break
        numbers, margins = (values[:, q] for values in model.evaluate(finest, model.points[rows]))
        previous = score(model.numbers[rows, q], model.margins[rows, q])
        switches = np.isfinite(numbers) != happens[rows]
        change = np.abs(score(numbers, margins) - previous)
        size = switches * np.abs(scores[rows])
        # Scores may jump, as where another event comes first: their change tells nothing then.
        is_jump = change > _JUMP * np.median(change)
        change = np.where(is_jump, 2 * size, change)
        shift = max(shift, float(np.where(np.isfinite(change), change, size).max()))
        number = np.fmax(number, np.fmax.reduce(np.abs(numbers - model.numbers[rows, q])))
        test_rows, differs = np.concatenate([test_rows, rows]), np.concatenate([differs, switches])
        if not switches.any() or (np.isfinite(change).all() and np.isfinite(number)):
            break
    if differs.any() and not np.isfinite(change).any():
        segments = _find_segments(
            model.points[test_rows], happens[test_rows], differs, np.abs(scores[test_rows])
        )
        shift = max(shift, _bisect_segments(model, q, occurrence, finest, *segments))
    shift, number = map(float, extrapolate_error(np.array([shift, number])))
    return shift, number


def _iterate_rows(size: np.ndarray, happens: np.ndarray) -> Iterator[np.ndarray]:
    """Runs on both sides of a border, the nearest by `size` (R) first, then twice as far on."""
    order = np.argsort(size, kind="stable")
    sides = order[happens[order]], order[~happens[order]]
    first, last = 0, _SIDE
    while first < max(map(len, sides)):
        stride = max(1, (last - first) // _SIDE)
        yield np.concatenate([side[first:last:stride] for side in sides])
        first, last = last, 2 * last


def _find_segments(
    points: np.ndarray, happens: np.ndarray, differs: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit points (P, k) with the largest differences in finer runs, and for each the
    nearest point where a finer run agrees."""
    starts, stops = [], []
    for row in np.flatnonzero(differs)[np.argsort(-size[differs], kind="stable")][: 2 * _SIDE]:
        peers = np.flatnonzero(~differs & (happens == happens[row]))
        if len(peers):
            distances = np.linalg.norm(points[peers] - points[row], axis=1)
            starts.append(points[row])
            stops.append(points[peers[distances.argmin()]])
    k = points.shape[1]
    return np.array(starts).reshape(-1, k), np.array(stops).reshape(-1, k)


def _bisect_segments(
    model: ModelEvaluator,
    q: int,
    occurrence: Any,
    finest: Plan,
    outer: np.ndarray,
    inner: np.ndarray,
) -> float:
    """Return the largest size of the decision value at which finer runs differ, between points (P,
    k)."""
    if not len(outer):
        return 0.0
    happens = occurrence.evaluate(outer)
    for _ in range(_HALVINGS):
        if model.account.allowance < len(outer):
            break
        middle = (outer + inner) / 2
        numbers, _ = model.evaluate(finest, middle)
        switches = (np.isfinite(numbers[:, q]) != happens)[:, None]
        outer, inner = np.where(switches, middle, outer), np.where(switches, inner, middle)
    return float(np.abs(occurrence.decision((outer + inner) / 2)).max())
