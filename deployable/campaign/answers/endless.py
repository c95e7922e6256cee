"""Whether a time has no upper end, as that of a pendulum that hardly passes its top.

Such a time grows by as much, or more, with each halving of the distance from a place. The time of
an event that ceases grows by a fixed part of the last growth, and has an end. Runs on a line tell
them apart: first they enclose the place, then they stand at three distances from it."""

from typing import Any

import numpy as np

from deployable.campaign.answers.evaluations import SAME_RUN

_FINEST = 1e-5  # distance between two runs that enclose a place, in normalized coordinates
_REACH, _STEP = 0.25, 0.05  # farthest run without the event; first runs beside a largest time
_DISTANCES = np.array([4.0, 64.0, 1024.0])  # from the place, in distances of the runs about it
_STEADY, _GROWTH = 0.75, 0.01  # of the growth before, and of the width: growth without an end
_STEEP = 50.0  # widths in one unit of distance
_FLAT = 0.002  # of the width: difference of runs that is none
_MOST_MOVES = 8  # to a larger time


def grows_without_end(model: Any, q: int, place: np.ndarray, width: float) -> bool | None:
    """Make runs on a line through the normalized point `place` (k), at which quantity `q`, a time,
    is largest in the runs of `model` (`ModelEvaluator`), and tell whether the time grows without an
    end; where the runs are not allowed or do not tell, whether it falls so steeply beside the place
    that it may, or None. width: of the time's range."""
    misses = model.points[np.isnan(model.numbers[:, q])]
    gaps = np.abs(misses - place).max(axis=1)
    is_border = gaps.min(initial=np.inf) <= _REACH
    if is_border:
        lines = _enclose_border(model, q, place, misses[gaps.argmin()])
    else:
        lines = _enclose_peak(model, q, place, width)
    verdicts = [_is_steady(model, q, width, *line) for line in lines]
    if True in verdicts or (verdicts and None not in verdicts):
        return True in verdicts
    distances = np.abs(model.points - place).max(axis=1)
    falls = np.nanmax(model.numbers[:, q]) - model.numbers[distances > 0, q]
    steepness = np.nanmax(falls / distances[distances > 0], initial=0.0)
    return True if not is_border and steepness > _STEEP * width else None


def _values(model: Any, q: int, points: np.ndarray) -> np.ndarray | None:
    """Return the quantity (P) in runs at points (P, k), made unless present, or None where one of
    them is not allowed or fails."""
    rows = model.add(points)
    is_made = np.abs(model.points[rows] - points).max() <= SAME_RUN
    return model.numbers[rows, q] if is_made else None


def _is_steady(
    model: Any, q: int, width: float, origin: np.ndarray, offset: np.ndarray
) -> bool | None:
    """Tell whether the time grows by as much from the second to the first of three distances from a
    point `origin` as from the third to the second, in the direction and unit of `offset`."""
    points = origin + _DISTANCES[:, None] * offset
    if np.abs(points).max() > 1.0 or (values := _values(model, q, points)) is None:
        return None
    if not np.isfinite(values).all():
        return None
    last, first = values[:-1] - values[1:]
    return bool(last >= max(_STEADY * first, _GROWTH * width))


def _enclose_border(model: Any, q: int, inner: np.ndarray, outer: np.ndarray) -> list:
    """Bisect between a run with the event and one without; return the last one without, and the
    way to the last one with it, or no line."""
    while np.abs(inner - outer).max() > _FINEST:
        middle = (inner + outer) / 2
        if (values := _values(model, q, middle[None])) is None:
            return []
        inner, outer = (middle, outer) if np.isfinite(values[0]) else (inner, middle)
    return [(outer, inner - outer)]


def _enclose_peak(model: Any, q: int, place: np.ndarray, width: float) -> list:
    """Enclose a largest time between two runs with less, along the parameter with the steepest
    fall to both sides; return the place and the ways to both runs, or no line. Where runs about the
    place differ as little as those of a smooth time, the ways have no length."""
    height = model.numbers[model.nearest(place)[0], q]
    for _ in range(_MOST_MOVES):
        drop, points, values = 0.0, place[None], np.array([height])
        highest = height, place
        for axis in np.eye(len(place))[(np.ptp(model.points, axis=0) > 0) & (np.abs(place) < 1.0)]:
            ends = np.clip(place + _STEP * np.outer([-1.0, 1.0], axis), -1.0, 1.0)
            if (heights := _values(model, q, ends)) is None:
                return []
            if np.isnan(heights).any():
                return _enclose_border(model, q, place, ends[np.isnan(heights).argmax()])
            if height - heights.max() > drop:
                drop, points, values = height - heights.max(), ends, heights
            if heights.max() > highest[0]:
                highest = heights.max(), ends[heights.argmax()]
        if highest[0] == height:
            break
        height, place = highest
    if len(points) == 1:
        return [(place, 0.0 * place)]
    points, values = np.insert(points, 1, place, axis=0), np.insert(values, 1, height)
    while np.abs(points[2] - points[0]).max() > _FINEST:
        middles = (points[:-1] + points[1:]) / 2
        if (heights := _values(model, q, middles)) is None:
            return []
        if np.isnan(heights).any():
            return _enclose_border(model, q, points[1], middles[np.isnan(heights).argmax()])
        growth = heights.max() - values[1]
        points = np.insert(points, [1, 2], middles, axis=0)
        values = np.insert(values, [1, 2], heights)
        row = int(values[1:-1].argmax()) + 1
        points, values = points[row - 1 : row + 2], values[row - 1 : row + 2]
        if max(growth, values[1] - max(values[0], values[2])) <= _FLAT * width:
            return [(place, 0.0 * place)]
    half = (points[2] - points[0]) / 2
    return [(points[1], half), (points[1], -half)]
