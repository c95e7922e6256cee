"""Local search for a bound of a quantity on real runs: from the extreme run to the best point that
a local model finds within a radius, and on from there (Conn, Gould and Toint, Trust-Region
Methods, 2000).

The model passes through the runs near by. Where some of them have no value, or are found beyond a
jump, the search keeps to the side of the extreme run by a smooth border: where a model of event
margins vanishes, if these are known and tell the sides, else half way to the runs beyond it, so
that it bisects towards that border and goes along it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy

from ..designs import spread_points
from .fits import level
from .occurrence import Occurrence, matern

TOLERANCE = 1e-3
"""A gain that does not exceed this fraction of the width of the runs is none."""

_MODEL_RUNS, _PARAMETER_RUNS = 12, 6  # runs of the model: this many, and so many for each parameter
_CLOUD, _SIZES = 256, (1.0, 0.4, 0.15, 0.05)  # trial points, and in which parts of the radius
_ZOOMS, _HALVINGS = 3, 12
_NOISE = 1e-8  # added to the kernel of the model
_GAP = 0.7  # least distance of a step from runs beyond the border, over that from others
_RADIUS, _LEAST_RADIUS = 0.5, 1e-3  # in normalized coordinates
_FALL = 0.1  # of the width: a run that is so far below the extreme one is beyond a jump,
_STEEP = 3.0  # if that is also more than so many times what it promised
_JUMP, _JUMP_GAP, _PROBES = 0.3, 0.2, 4  # of the width between two runs, their gap, runs for it
_SHARE = 0.1  # of such a gain, by a border, where the model, smooth, promises too little
_POLL = 0.05  # of the width, that a model may lose where a single parameter is moved
_NEAREST = 1e-6  # a point that near to a run needs none
_NEARER, _CORRECTION = 0.4, 0.3  # of what a run next to one beyond the border misses it by, so
# that there is a further one; how near it is, of the way from the extreme run
_AIM = 0.3  # of what such a run missed it by: margin that the next one should have
_FAILURES = 3  # steps without a gain, after which a search ends


@dataclass
class Climb:
    """Search for the upper (sign 1) or lower (sign -1) bound of a quantity, one run at a time."""

    sign: float
    radius: float = _RADIUS
    failures: int = 0
    misses: int = 0  # runs in a row beyond the border
    probes: int = 0  # runs made to find a jump
    end: float | None = None  # largest value (times the sign) when the search ended
    floor: float = -np.inf  # largest value (times the sign) of a run beyond a jump
    promise: tuple[np.ndarray, float, float] | None = None  # next run, its value; largest so far
    target: np.ndarray | None = None  # last run, just beyond the border, next to which one goes on
    depth: float = 0.0  # minus the margin of that run
    margins: Any = None  # (N) of the runs so far
    record: list[float] = field(default_factory=list)  # largest values (times the sign) so far

    @property
    def remainder(self) -> float:
        """Return by how much the bound may still be exceeded if the search did not finish: the
        promise of its last proposal, or the gain of the later half of its steps if that is more.
        Otherwise 0."""
        if self.end is not None or not self.record:
            return 0.0
        gain = self.record[-1] - self.record[len(self.record) // 2]
        return max(gain, 0.0 if self.promise is None else self.promise[1] - self.record[-1])

    def propose(
        self, points: np.ndarray, values: np.ndarray, margins: np.ndarray | None = None
    ) -> np.ndarray | None:
        """Next normalized point (k) at which a run may exceed all others by more than `TOLERANCE`;
        None where there is none. points (N, k): of the runs so far; values (N): of the quantity in
        these, NaN where a run has none; margins (N): event margins, above 0 where a run has the
        quantity, NaN where not known, None if of no run."""
        self.margins = np.full(len(values), np.nan) if margins is None else margins
        heights = self.sign * level(np.where(np.isfinite(values), values, np.nan))
        width = float(np.ptp(heights[np.isfinite(heights)])) if np.isfinite(heights).any() else 0.0
        if not width > 0:
            return None
        row = int(np.nanargmax(heights))
        self.record.append(float(heights[row]))
        if self.end is not None:
            if heights[row] - self.end <= TOLERANCE * width:
                return None
            self.end, self.radius, self.failures, self.probes = None, _RADIUS, 0, 0
        self._learn(points, heights, width)
        is_valid = np.isfinite(heights) & (heights > self.floor)
        is_valid[row] = True
        share = 1.0 if is_valid.all() else _SHARE
        while self.failures < _FAILURES and self.radius >= _LEAST_RADIUS:
            best, height = self._best(points, heights, is_valid, row)
            if height - heights[row] <= share * TOLERANCE * width:
                if self.target is None:
                    break
                self.target, self.radius = None, 0.5 * self.radius
                continue
            if np.abs(points - best).max(axis=1).min() > _NEAREST:
                self.promise = best, height, float(heights[row])
                return best
            self.failures, self.radius = self.failures + 1, 0.4 * self.radius
        point = self._probe(points, heights, is_valid, row, width)
        self.end = float(heights[row]) if point is None else None
        return point

    def _learn(self, points: np.ndarray, heights: np.ndarray, width: float) -> None:
        """Compare the last run with what it promised."""
        if self.promise is None:
            return
        best, height, base = self.promise
        self.promise = None
        run = int(np.abs(points - best).max(axis=1).argmin())
        gain, hope = heights[run] - base, height - base
        self.failures = 0 if gain > TOLERANCE * width else self.failures + 1
        is_fallen = -gain > max(_STEEP * hope, _FALL * width)
        if is_fallen:
            self.floor = max(self.floor, float(heights[run]))
            self.radius = max(self.radius, _RADIUS)  # what it failed by may have been the jump
        if is_fallen or not np.isfinite(gain):
            self.failures, self.misses = 0, self.misses + 1
            if self.margins[run] < 0:  # the border bends; the model of margins knows that now
                depth = -float(self.margins[run])
                if self.misses == 1 or (self.target is not None and depth < _NEARER * self.depth):
                    self.target, self.depth = best, depth
                else:
                    self.target, self.radius = None, 0.5 * self.radius
            return
        self.misses, self.target = 0, None
        if gain < 0.1 * hope:
            self.radius *= 0.4
        elif gain > 0.7 * hope:
            self.radius = min(2 * self.radius, 1.0)

    def _probe(
        self, points: np.ndarray, heights: np.ndarray, is_valid: np.ndarray, row: int, width: float
    ) -> np.ndarray | None:
        """Point (k) half way between two runs near the extreme one that may be on two sides of a
        jump; once such runs are near each other, the lower one is beyond it, and None is left."""
        if not self.probes and self.floor == -np.inf:
            self.probes = 1
            if (point := self._poll(points, heights, is_valid, row, width)) is not None:
                return point
        order = np.argsort(np.linalg.norm(points - points[row], axis=1), kind="stable")
        rows_near = order[is_valid[order]][: 3 + 2 * points.shape[1]]
        gaps = np.linalg.norm(points[rows_near][:, None] - points[rows_near], axis=2)
        drops = heights[rows_near][:, None] - heights[rows_near]
        steepness = np.where((drops > _JUMP * width) & (gaps < 1.0), drops / (gaps + 1e-9), 0.0)
        slopes = np.abs(drops) / (gaps + 1e-9)
        usual = (
            float(np.median(slopes[np.triu_indices(len(rows_near), 1)]))
            if len(rows_near) > 1
            else 0.0
        )
        steepness[steepness < _STEEP * usual] = 0.0
        high, low = np.unravel_index(steepness.argmax(), steepness.shape)
        if self.probes >= _PROBES or not steepness[high, low]:
            return None
        if gaps[high, low] < _JUMP_GAP:
            self.floor, self.probes = float(heights[rows_near[low]]), _PROBES
            self.failures, self.radius = 0, _RADIUS
            return self.propose(points, heights * self.sign, self.margins)
        self.probes += 1
        return (points[rows_near[high]] + points[rows_near[low]]) / 2

    def _poll(
        self, points: np.ndarray, heights: np.ndarray, is_valid: np.ndarray, row: int, width: float
    ) -> np.ndarray | None:
        """Return the extreme run's point (k) with one parameter moved half way or all the way to
        the centre of the box, where the model loses least. None if it loses much, or a run is
        near."""
        free = np.flatnonzero(np.ptp(points, axis=0) > 0)
        trial = np.repeat(points[row][None], 2 * len(free), axis=0)
        for i, j in enumerate(free):
            trial[2 * i : 2 * i + 2, j] *= [0.0, 0.5]
        gaps = scipy.spatial.cKDTree(points).query(trial)[0]
        trial = trial[gaps > 0.1]
        if not len(trial):
            return None
        model, _, offset = self._model(points, heights, is_valid, row)
        losses = heights[row] - model.evaluate(trial) - offset
        return trial[losses.argmin()] if losses.min() < _POLL * width else None

    def _model(
        self, points: np.ndarray, heights: np.ndarray, is_valid: np.ndarray, row: int
    ) -> tuple[_Model, _Border | None, float]:
        """Return the model of the runs near a run, the border beside it, if any, and by how much
        the model is below that run."""
        origin, free = points[row], np.ptp(points, axis=0) > 0
        count = _MODEL_RUNS + _PARAMETER_RUNS * int(free.sum())
        order = np.argsort(np.linalg.norm(points - origin, axis=1), kind="stable")
        rows_near = order[is_valid[order]][:count]
        rows = order[~is_valid[order]][:count]
        border: _Border | None = None
        if len(rows):
            near_count = 3 + 2 * int(free.sum())
            nearest = np.concatenate([rows_near[:near_count], rows[:near_count]])
            margins, signs = self.margins[nearest], np.where(is_valid[nearest], 1.0, -1.0)
            rows = np.concatenate([rows_near, rows])
            if (margins * signs > 0).all():
                border = _MarginBorder(points[nearest], margins)
            else:
                border = Occurrence(points[rows], is_valid[rows], reach=0.0)
        has_root = border is not None and not np.isfinite(heights[rows]).all()  # no mere jump
        model = _Model(points[rows_near], heights[rows_near], border if has_root else None)
        return model, border, float(heights[row] - model.evaluate(origin[None])[0])

    def _best(
        self, points: np.ndarray, heights: np.ndarray, is_valid: np.ndarray, row: int
    ) -> tuple[np.ndarray, float]:
        """Return the best point (k) within the radius of a run, and what the model promises there;
        next to a run just beyond the border, once there is one (a second-order correction)."""
        origin, free = points[row], np.ptp(points, axis=0) > 0
        model, border, offset = self._model(points, heights, is_valid, row)
        cloud = spread_points(free, _CLOUD, seed=3) * free
        best, height, radius = origin, heights[row], self.radius
        level, centre = 1.0 - 0.5**self.misses, origin
        if self.target is not None:
            centre = self.target
            radius = _CORRECTION * float(np.abs(self.target - origin).max())
            if isinstance(border, _MarginBorder):
                level = _AIM * self.depth / border.scale
        for _ in range(_ZOOMS):
            trial = np.concatenate([centre + size * radius * cloud for size in _SIZES] + [[origin]])
            trial = np.clip(trial, *np.clip([origin - self.radius, origin + self.radius], -1, 1))
            if border is not None:
                trial = _clip_to_border(trial, border, level)
            if isinstance(border, Occurrence):  # which knows the sides of runs alone
                gaps = [
                    scipy.spatial.cKDTree(border.points[kind]).query(trial)[0]
                    for kind in (border.happens, ~border.happens)
                ]
                trial = trial[gaps[1] >= _GAP * gaps[0]]
            if len(trial):
                forecast = model.evaluate(trial) + offset
                if forecast.max() > height:
                    best, height = trial[forecast.argmax()], float(forecast.max())
                    centre = best
            radius *= 0.2
        return best, height


def _clip_to_border(trial: np.ndarray, border: _Border, level: float) -> np.ndarray:
    """Return the trial points (P, k) inside a level of a border. Each point outside is replaced by
    one just inside, by bisection towards the nearest point inside."""
    is_inside = border.decision(trial) >= level
    inner, low = trial[is_inside], trial[~is_inside]
    if not len(inner) or not len(low):
        return inner
    high = inner[scipy.spatial.cKDTree(inner).query(low)[1]]
    for _ in range(_HALVINGS):
        middle = (high + low) / 2
        mask = (border.decision(middle) >= level)[:, None]
        high, low = np.where(mask, middle, high), np.where(mask, low, middle)
    return np.concatenate([inner, high])


class _Model:
    """A smooth function through heights (N) of runs at points (N, k), by a kernel as wide as these
    lie apart and a linear trend; with a border also in the root of the distance from it."""

    def __init__(self, points: np.ndarray, heights: np.ndarray, border: _Border | None) -> None:
        self.origin, self.border = points[0], border
        self.length = float(np.linalg.norm(points - points[0], axis=1).max()) or 1.0
        self.mean = float(heights.mean())
        self.rows = self._coordinates(points)
        kernel = self._kernel(self.rows) + _NOISE * np.eye(len(points))
        self.weights = scipy.linalg.solve(kernel, heights - self.mean, assume_a="pos")

    def _coordinates(self, points: np.ndarray) -> np.ndarray:
        rows = (points - self.origin) / self.length
        if self.border is None:
            return rows
        decision, step = self.border.decision(points), 1e-6
        slopes = [
            (self.border.decision(points + step * axis) - decision) / step
            for axis in np.eye(points.shape[1])
        ]
        distance = np.maximum(decision, 0.0) / np.maximum(np.linalg.norm(slopes, axis=0), 1e-9)
        return np.column_stack([rows, np.sqrt(np.minimum(distance, self.length) / self.length)])

    def _kernel(self, rows: np.ndarray) -> np.ndarray:
        return matern(rows, self.rows) + 10.0 * (1.0 + rows @ self.rows.T)

    def evaluate(self, trial: np.ndarray) -> np.ndarray:
        """Heights (P) at points (P, k)."""
        return self.mean + self._kernel(self._coordinates(trial)) @ self.weights


class _MarginBorder:
    """The border at which a model of event margins (N) of runs at points (N, k) vanishes, the first
    of which is the extreme run. Margins jump where another event comes first: those far below 0
    count as far below as the largest is above."""

    def __init__(self, points: np.ndarray, margins: np.ndarray) -> None:
        self.scale = float(margins[0])
        self.model = _Model(points, np.maximum(margins, -margins.max()), None)

    def decision(self, points: np.ndarray) -> np.ndarray:
        """Margins (P) at points (P, k) over that of the extreme run."""
        return self.model.evaluate(points) / self.scale


_Border = Occurrence | _MarginBorder
