"""Bounds of a composed model at fixed instants.

At a fixed instant the model is a smooth function of the parameters on each region between the
surfaces tau_j(p) = t. Its extreme values lie inside a region, on the box's surface, or on one of
those surfaces, where both one-sided values count. Lines through the box are searched for all three:
sampled, bisected where the piece changes, and refined around the best sample. In one dimension one
line is the whole box; in several, lines along the coordinates follow a scan. The result is attained
(an inner range); `enclosure` gives an outer one.
"""

from __future__ import annotations

import numpy as np

from ...points import corner_points, held_out_points
from .composed import EventModel

_LINE = {1: 129}
_LINE_MANY = 17
_SCAN = 500


def event_range(
    model: EventModel, time: np.ndarray, sweeps: int = 2
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Lowest and highest value (T) of the model over its element, and their arguments (T, k)."""
    time = np.asarray(time, dtype=float)
    free = np.flatnonzero(model.upper > model.lower)
    k = len(model.lower)
    centre = (model.lower + model.upper) / 2
    starts = np.repeat(centre[None], 1, axis=0)
    if len(free) > 1:
        mask = model.upper > model.lower
        local = np.concatenate([corner_points(mask), held_out_points(mask, _SCAN)])
        starts = centre + local * (model.upper - model.lower) / 2
    values = model.evaluate(starts, time)
    results = []
    for sign in (-1.0, 1.0):
        at = (sign * values).argmax(axis=0)
        best, x = sign * values[at, np.arange(len(time))], starts[at].copy()
        for _ in range(1 if len(free) == 1 else sweeps):
            for j in free:
                _search_line(model, time, sign, int(j), best, x, _LINE.get(len(free), _LINE_MANY))
        results.append((sign * best, x.reshape(len(time), k)))
    return results[0][0], results[1][0], results[0][1], results[1][1]


def _search_line(model, time, sign, direction, best, x, count) -> None:
    """Improve `best` (T) and `x` (T, k) on the lines through x along one direction, in place."""
    total = len(time)
    grid = _between(model, direction, -np.cos(np.linspace(0, np.pi, count)))
    lines = np.repeat(x[:, None, :], count, axis=1)
    lines[:, :, direction] = grid
    flat, instants = lines.reshape(-1, x.shape[1]), np.repeat(time, count)
    piece = model.piece_of(flat, instants)
    value = sign * model.evaluate_pairs(flat, instants, piece).reshape(total, count)
    piece = piece.reshape(total, count)
    rows = np.arange(total)
    at = value.argmax(axis=1)

    # refine inside the piece of the best sample: the neighbours bracket its maximum
    left, right = grid[np.maximum(at - 1, 0)], grid[np.minimum(at + 1, count - 1)]
    own, top, where = piece[rows, at], value[rows, at], grid[at]
    fine = 9
    for _ in range(4):
        share = np.linspace(0, 1, fine)
        trial = left[:, None] + (right - left)[:, None] * share
        points = np.repeat(x[:, None, :], fine, axis=1)
        points[:, :, direction] = trial
        flat = points.reshape(-1, x.shape[1])
        now = np.repeat(time, fine)
        inside = model.piece_of(flat, now) == np.repeat(own, fine)
        found = sign * model.evaluate_pairs(flat, now, np.repeat(own, fine))
        found = np.where(inside, found, -np.inf).reshape(total, fine)
        here = found.argmax(axis=1)
        better = found[rows, here] > top
        top = np.where(better, found[rows, here], top)
        where = np.where(better, trial[rows, here], where)
        half = (right - left) / (fine - 1)
        left, right = np.maximum(where - half, left), np.minimum(where + half, right)
    _keep(best, x, rows, direction, top, where)

    # both one-sided values where the piece changes between two samples
    row, cell = np.nonzero(piece[:, 1:] != piece[:, :-1])
    if not len(row):
        return
    low, high = grid[cell].copy(), grid[cell + 1].copy()
    first, second = piece[row, cell], piece[row, cell + 1]
    points = x[row].copy()
    for _ in range(40):
        points[:, direction] = (low + high) / 2
        same = model.piece_of(points, time[row]) == first
        low, high = (
            np.where(same, points[:, direction], low),
            np.where(same, high, points[:, direction]),
        )
    for side, edge in ((first, low), (second, high)):
        points[:, direction] = edge
        side_value = sign * model.evaluate_pairs(points, time[row], side)
        order = np.argsort(side_value, kind="stable")  # the best of a row comes last and stays
        _keep_many(best, x, row[order], direction, side_value[order], edge[order])


def _between(model, direction, local):
    low, high = model.lower[direction], model.upper[direction]
    return low * (1 - local) / 2 + high * (1 + local) / 2


def _keep(best, x, rows, direction, value, where):
    better = value > best[rows]
    best[rows[better]] = value[better]
    x[rows[better], direction] = where[better]


def _keep_many(best, x, rows, direction, value, where):
    """Like `_keep` where a row may occur several times, sorted by ascending value."""
    last = {int(r): i for i, r in enumerate(rows)}
    pick = np.array(list(last.values()), dtype=int)
    _keep(best, x, rows[pick], direction, value[pick], where[pick])
