"""In which part of the box something happens, told by the nearest runs or by its time."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ..designs.scan import scan_points
from ..errors import IntervalError
from ..models.spline import check_spline_runs, fit_spline

_POINTS = 8192
_SPLINED = 1000  # runs, of which a spline is fitted in a second
_LEAST = 5e-4  # radius of a gap between runs, below which none is sought, in unit coordinates


@dataclass(frozen=True)
class Occurrence:
    """Runs at unit points (N, k), and whether it happens (N) in each.

    At any other place it is taken to happen if it does in the nearest run. Places between two runs
    that differ, with none in between, are open: nothing is known of them. So are those of which
    the sign of a spline through all runs (1 where it happens, -1 elsewhere) tells otherwise: runs
    crowd where the border was sought, and away from there the nearest one may be far.
    """

    points: np.ndarray
    happens: np.ndarray

    @property
    def mixed(self) -> bool:
        """Whether it happens in some runs and not in others."""
        return bool(self.happens.any() and not self.happens.all())

    def evaluate(self, unit: np.ndarray) -> np.ndarray:
        """Mask (P) of unit coordinates (P, k)."""
        if not self.mixed:
            return np.full(len(unit), bool(self.happens.all()))
        return self.certainty(unit) >= 0

    def certainty(self, unit: np.ndarray) -> np.ndarray:
        """By how much the nearest run in which it happens is nearer than any other, (P), at unit
        coordinates (P, k); below 0 where it is farther. Only where runs differ (`mixed`)."""
        yes, no = self._distances(unit)
        return no - yes

    def share(self) -> tuple[float, float]:
        """Share of the box in which it happens, and the share that is open."""
        if not self.mixed:
            return float(self.happens.all()), 0.0
        spread = self._spread()
        open_ = np.zeros(len(spread), dtype=bool)
        for middle, radius in zip(*self._gaps(), strict=True):
            open_ |= ((spread - middle) ** 2).sum(axis=1) < radius**2
        there = self.certainty(spread) >= 0
        with suppress(IntervalError):  # too few for a spline, or all in one plane
            check_spline_runs(self.points)
            if len(self.points) <= _SPLINED:
                signs = fit_spline(self.points, np.where(self.happens, 1.0, -1.0)[:, None])
                open_ |= there != (signs.evaluate(spread)[:, 0] >= 0)
        return float(there.mean()), float(open_.mean())

    def between(self, count: int) -> np.ndarray:
        """Unit points (at most `count`, k) half way between runs of both kinds, farthest first, for
        runs that would narrow down where the border is."""
        if not self.mixed:
            return np.zeros((0, self.points.shape[1]))
        middles, radii = self._gaps()
        chosen: list[np.ndarray] = []
        for i in np.argsort(-radii, kind="stable"):
            if len(chosen) == count or radii[i] < _LEAST:
                break
            if all(np.linalg.norm(middles[i] - other) > radii[i] for other in chosen):
                chosen.append(middles[i])
        return np.array(chosen).reshape(-1, self.points.shape[1])

    def _gaps(self) -> tuple[np.ndarray, np.ndarray]:
        """Middles (G, k) and radii (G) of the balls between a run and the nearest one of the other
        kind, those with no run inside."""
        from scipy.spatial import cKDTree

        found = []
        for kind in (self.happens, ~self.happens):
            own, others = self.points[kind], self.points[~kind]
            _, near = cKDTree(others).query(own)
            found.append(np.stack([own, others[near]], axis=1))
        pairs = np.concatenate(found)
        middles = pairs.mean(axis=1)
        radii = np.linalg.norm(pairs[:, 0] - pairs[:, 1], axis=1) / 2
        nearest, _ = cKDTree(self.points).query(middles)
        empty = nearest > radii * (1 - 1e-9)
        _, first = np.unique(np.round(middles[empty], 9) + 0.0, axis=0, return_index=True)
        return middles[empty][first], radii[empty][first]

    def _spread(self) -> np.ndarray:
        """Points of the box, evenly spread."""
        free = np.ptp(self.points, axis=0) > 0
        if free.sum() == 1:
            points = np.zeros((_POINTS, len(free)))
            points[:, free] = -1 + (2 * np.arange(_POINTS)[:, None] + 1) / _POINTS
        else:
            points = scan_points(free, _POINTS, seed=2, corners=False)
        points[:, ~free] = self.points[0, ~free]
        return points

    def _distances(self, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances (P) to the nearest run in which it happens, and in which it does not."""
        from scipy.spatial import cKDTree

        return tuple(
            cKDTree(self.points[kind]).query(np.asarray(unit, dtype=float))[0]
            for kind in (self.happens, ~self.happens)
        )


@dataclass(frozen=True)
class Until(Occurrence):
    """It happens wherever a function foretells it by the time `latest`, when runs end.

    That agrees with all runs (`agrees`), and tells the border far better than the nearest runs do.
    """

    foretold: Callable[[np.ndarray], np.ndarray]
    error: float
    latest: float

    @property
    def agrees(self) -> bool:
        """Whether the function foretells of every run what happened in it."""
        late = self.foretold(self.points) - self.latest
        return bool((late[self.happens] <= self.error).all() and (late[~self.happens] > 0).all())

    def certainty(self, unit: np.ndarray) -> np.ndarray:
        return self.latest - self.foretold(np.asarray(unit, dtype=float))

    def share(self) -> tuple[float, float]:
        if not self.mixed:
            return super().share()
        early = self.certainty(self._spread())
        return float((early >= 0).mean()), float((np.abs(early) < self.error).mean())

    def between(self, count: int) -> np.ndarray:
        return np.zeros((0, self.points.shape[1]))
