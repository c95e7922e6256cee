"""Guaranteed outer range of a composed event model at fixed instants.

On a sub-box the impact times, polynomials in the parameters, lie in known ranges; so do the pieces
that an instant can fall into and the stretched times s at which it meets them. Over such a window
of s a piece is, between two knots of its spline, a cubic in s times polynomials in the parameters:
its values lie between the least and the largest of the Bernstein coefficients in s, and each of
these, expanded in Chebyshev polynomials of the sub-box, within its mean plus or minus the sum of
the other coefficients. Halving the sub-boxes tightens this. Within one, s and the parameters
are taken as independent of each other, so the excess falls with its size, not with the square.
"""

from __future__ import annotations

import numpy as np

from .composed import EventModel

_CHUNK = 4000  # sub-boxes bounded at a time
_EPS = np.finfo(float).eps


def event_enclosure(
    model: EventModel,
    time: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    tolerance: float = 0.01,
    budget: int = 300,
) -> tuple[np.ndarray, np.ndarray]:
    """Bounds (T) which the model, over its element, does not leave.

    `low`, `high` (T) are attained values. Sub-boxes are halved until the bounds are within
    `tolerance` times the attained width of them, or there have been `budget` sub-boxes an instant.
    """
    time = np.asarray(time, dtype=float)
    low, high = low.astype(float).copy(), high.astype(float).copy()
    close = tolerance / 2 * (high - low)
    free = model.upper > model.lower
    owner = np.arange(len(time))
    centre = np.zeros((len(time), len(free)))
    half = np.where(free, 1.0, 0.0) * np.ones((len(time), 1))
    outer_low, outer_high = np.full(len(time), np.inf), np.full(len(time), -np.inf)
    left = budget * len(time)
    while len(owner):
        below, above, influence = _bound(model, time[owner], centre, half)
        middle = model.evaluate_pairs(_to_unit(model, centre), time[owner])
        np.minimum.at(low, owner, middle)
        np.maximum.at(high, owner, middle)
        left -= len(owner)
        excess = np.maximum(low[owner] - below, above - high[owner]) - close[owner]
        going = (excess > 0) & free.any()
        if 2 * going.sum() > left:
            # what is left goes to the sub-boxes that spoil the bounds most
            order = np.argsort(np.where(going, -excess, np.inf), kind="stable")
            going[order[max(left, 0) // 2 :]] = False
        np.minimum.at(outer_low, owner[~going], below[~going])
        np.maximum.at(outer_high, owner[~going], above[~going])
        direction = influence[going].argmax(axis=1)
        owner, centre, half = owner[going], centre[going], half[going].copy()
        rows = np.arange(len(owner))
        half[rows, direction] /= 2
        step = np.zeros_like(centre)
        step[rows, direction] = half[rows, direction]
        owner = np.concatenate([owner, owner])
        centre, half = np.concatenate([centre - step, centre + step]), np.concatenate([half, half])
    return np.minimum(outer_low, low), np.maximum(outer_high, high)


def _bound(model, time, centre, half):
    """Lower and upper bound (P) on sub-boxes, and the influence (P, k) of each direction."""
    parts = [
        _bound_some(model, time[i : i + _CHUNK], centre[i : i + _CHUNK], half[i : i + _CHUNK])
        for i in range(0, len(time), _CHUNK)
    ]
    return tuple(np.concatenate(rows) for rows in zip(*parts, strict=True))


def _bound_some(model, time, centre, half):
    indices = model.impacts.multi_indices
    shifts = [
        _expansions(centre[:, j], half[:, j], int(n)) for j, n in enumerate(indices.max(axis=0))
    ]
    first, last, effect = _edges(model, shifts)
    count, k = centre.shape
    below, above = np.full(count, np.inf), np.full(count, -np.inf)
    influence = np.zeros((count, k))
    margin = 64 * _EPS * (abs(model.start) + abs(model.end))
    for j, spline in enumerate(model.pieces):
        # an instant within rounding of an impact may fall on either side
        reached = (first[:, j] <= time + margin) & (time <= last[:, j + 1] + margin)
        rows = np.flatnonzero(reached)
        if not len(rows):
            continue
        t = time[rows]
        s_high = _ratio(t - first[rows, j], np.maximum(first[rows, j + 1], t) - first[rows, j], 1)
        begin = np.minimum(last[rows, j], t)
        s_low = _ratio(t - begin, last[rows, j + 1] - begin, 0)
        row, cubic, size = _window(spline, s_low, s_high)
        value = _expand(cubic, indices, [shift[rows[row]] for shift in shifts])
        mean, total = _mean(value), _total(value)
        rest = total - np.abs(mean) + (_rounding(indices) * size)[:, None]
        np.minimum.at(below, rows[row], (mean - rest).min(axis=1))
        np.maximum.at(above, rows[row], (mean + rest).max(axis=1))
        change = np.zeros((2, len(rows)))
        np.minimum.at(change[0], row, mean.min(axis=1) - mean[:, 0])
        np.maximum.at(change[1], row, mean.max(axis=1) - mean[:, 0])
        share = effect[rows] / np.maximum(effect[rows].sum(axis=1), 1e-300)[:, None]
        here = (change[1] - change[0])[:, None] * share
        for d in range(k):
            moving = np.zeros(len(rows))
            np.maximum.at(moving, row, _total(_without(value, d)).max(axis=1))
            here[:, d] += moving
        influence[rows] = np.maximum(influence[rows], here)
    return below, above, np.where(half > 0, influence + 1e-300, -1.0)


def _edges(model, shifts):
    """Least and largest ends of the pieces (P, J + 2), and each direction's effect (P, k)."""
    coefficients = model.impacts.coefficients
    count, k = len(shifts[0]), len(shifts)
    stacked = np.broadcast_to(coefficients.T, (count, *coefficients.T.shape))
    value = _expand(stacked, model.impacts.multi_indices, shifts)
    mean, total = _mean(value), _total(value)
    rest = (
        total
        - np.abs(mean)
        + _rounding(model.impacts.multi_indices) * np.abs(coefficients).sum(axis=0)
    )
    ends = []
    for times in (mean - rest, mean + rest):
        times = np.maximum.accumulate(np.clip(times, model.start, model.end), axis=1)
        one = np.ones((count, 1))
        ends.append(np.concatenate([model.start * one, times, model.end * one], axis=1))
    effect = [_total(_without(value, d)).sum(axis=1) for d in range(k)]
    return ends[0], ends[1], np.stack(effect, axis=1)


def _ratio(top, bottom, otherwise):
    """Stretched time in [0, 1]; `otherwise` where a piece may have no length."""
    safe = bottom > 0
    s = np.where(safe, top / np.where(safe, bottom, 1.0), otherwise)
    return np.clip(s + (64 * _EPS if otherwise else -64 * _EPS), 0.0, 1.0)


def _window(spline, low, high):
    """Cubics on the cells that windows [low, high] (W) touch, in Bernstein form.

    Returns the window (Q) of each cell, coefficients (Q, 4, M) on the part within the window, and
    the sum (Q) of the magnitudes of all terms that these and the spline's value are made of.
    """
    knots, cells = spline.x, len(spline.x) - 1
    first = np.clip(np.searchsorted(knots, low, side="right") - 1, 0, cells - 1)
    # a point within rounding of a knot may be evaluated with either cell
    last = np.clip(np.searchsorted(knots, high + 4 * _EPS, side="right") - 1, 0, cells - 1)
    number = last - first + 1
    row = np.repeat(np.arange(len(low)), number)
    cell = first[row] + np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    a = np.maximum(low[row], knots[cell]) - knots[cell]
    b = np.maximum(np.minimum(high[row], knots[cell + 1]) - knots[cell], a)
    c3, c2, c1, c0 = (spline.c[q][cell] for q in range(4))  # (Q, M) each
    size = sum((np.abs(c) * b[:, None] ** q).sum(axis=1) for q, c in enumerate((c0, c1, c2, c3)))
    a, w = a[:, None], (b - a)[:, None]
    p0 = c0 + a * (c1 + a * (c2 + a * c3))
    p1 = w * (c1 + a * (2 * c2 + 3 * a * c3))
    p2 = w**2 * (c2 + 3 * a * c3)
    p3 = w**3 * c3
    value = np.stack([p0, p0 + p1 / 3, p0 + 2 * p1 / 3 + p2 / 3, p0 + p1 + p2 + p3], axis=1)
    return row, value, size


def _rounding(indices):
    """Share of the terms' summed magnitudes that rounding may come to: terms cancel, it does not.

    The recurrence of the Chebyshev polynomials loses up to the square of the degree.
    """
    return (64 + 4 * int(indices.sum(axis=1).max()) ** 2 + len(indices)) * _EPS


def _expansions(centre, half, degree):
    """Matrices (P, n + 1, n + 1): T_i(centre + half y) as a Chebyshev sum in y."""
    out = np.zeros((len(centre), degree + 1, degree + 1))
    out[:, 0, 0] = 1.0
    if degree:
        out[:, 1, 0], out[:, 1, 1] = centre, half
    for i in range(2, degree + 1):
        now = out[:, i - 1]
        times_y = np.zeros_like(now)
        times_y[:, 1:] += now[:, :-1] / 2
        times_y[:, :-1] += now[:, 1:] / 2
        times_y[:, 1] += now[:, 0] / 2  # y T_0 = T_1
        moved = centre[:, None] * now + half[:, None] * times_y
        out[:, i] = 2 * moved - out[:, i - 2]
    return out


def _expand(coefficients, indices, shifts):
    """Tensors (P, q, n_1 + 1, ...) on the sub-boxes of coefficients (P, q, M) on the element."""
    shape = tuple(shift.shape[-1] for shift in shifts)
    value = np.zeros((*coefficients.shape[:2], *shape))
    value[(slice(None), slice(None), *indices.T)] = coefficients
    for shift in shifts:
        value = np.einsum("pqi...,pir->pq...r", value, shift)
    return value


def _mean(value):
    return value[(slice(None), slice(None), *[0] * (value.ndim - 2))]


def _total(value):
    return np.abs(value).sum(axis=tuple(range(2, value.ndim)))


def _without(value, direction):
    """The terms that vary along a direction."""
    return np.moveaxis(value, 2 + direction, 2)[:, :, 1:]


def _to_unit(model, local):
    return model.lower * (1 - local) / 2 + model.upper * (1 + local) / 2
