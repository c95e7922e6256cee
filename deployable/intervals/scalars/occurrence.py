"""In which part of the box something happens: a smooth border between the runs, or its time.

The border is where the smoothest function vanishes that is at least 1 in all runs in which it
happens and at most -1 in all others, or less in proportion where these are near to each other: a
support vector machine with a hard margin (Cortes and Vapnik 1995), whose kernel is Matérn's for
functions with two derivatives. Open is where the size of the function is below those at the nearest
runs of both kinds. Further runs are sought about the border (Basudhar and Missoum 2010)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..box import FEW_PARAMETERS, is_general
from ..chebyshev import Formula
from ..designs import scan_points, spread_points
from ..spline_equations import distinct, in_blocks, remember, remember_latest, stands_alone

if TYPE_CHECKING:
    from .fits import Fit

_POINTS, _CANDIDATES = 8192, 2048
_MOST = 1000  # runs that a border is fitted to, in half a second: those nearest to unlike ones
_LENGTH = 2.0  # of the kernel: the side of the box
_NOISE = 1e-10  # added to the kernel of a run with itself, so that rounding is no obstacle
_LEAST = 5e-4  # unit distance of two runs about a border, below which none is sought
REACH = 0.25
"""Distance of two runs, one with the event and one without, in normalized coordinates, up to which
the function that separates them is at least in proportion to it."""

# By which volume fractions are uncertain, so that 95 % of those of known boxes lie within.
_CONFIDENCE = 1.8
_FOLDS, _DEVIATIONS = 8, 1.5  # of runs, left out in turn; of what is wrong there, likewise
_LEVELS = (-0.7, -0.35, 0.0, 0.35, 0.7)  # of the function, at which runs are sought


@dataclass(frozen=True)
class Occurrence:
    """In which part of the box of parameters an event occurs, by a smooth border between runs.
    points (N, k) in [-1, 1]^k: of the runs; happens (N): whether it occurs in each; reach: distance
    from runs that differ, up to which the function is at least in proportion to it, 0: at once."""

    points: np.ndarray
    happens: np.ndarray
    reach: float = field(default=REACH, kw_only=True)

    @cached_property
    def is_mixed(self) -> bool:
        """Whether the event occurs in some of the runs, but not in all."""
        return bool(self.happens.any() and not self.happens.all())

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Mask (P) of the points `points` (P, k) in [-1, 1]^k at which the event occurs, as the
        decision function (`decision`) has it."""
        return self.decision(points) >= 0

    @remember_latest
    def decision(self, points: np.ndarray) -> np.ndarray:
        """Decision function (P), no probability, at `points` (P, k) in [-1, 1]^k: above 0
        where the event occurs, below 0 where not, undecided where its size is below `band`.
        Everywhere plus infinity if it occurs in all runs, minus infinity if in none."""
        return self._decide(points)

    def _decide(self, points: np.ndarray) -> np.ndarray:
        if not self.is_mixed:
            return np.full(len(points), np.inf if self.happens.all() else -np.inf)
        return self._border(points)

    def band(self, points: np.ndarray) -> np.ndarray:
        """Half-width (P) of the undecided band at `points` (P, k) in [-1, 1]^k: where the
        decision function (`decision`) is smaller in size, the runs do not determine whether
        the event occurs; 0 if it occurs in all runs or in none."""
        if not self.is_mixed:
            return np.zeros(len(points))
        nearest = [decision[tree.query(points)[1]] for tree, decision in self._of_kinds]
        # Runs too close together, or too rough a border: some lie on the wrong side of it.
        least = 0.0 if self.reach else 1.0
        return np.maximum(np.minimum(*nearest), max(least, float(-self._decision.min())))

    def usual_band(self, points: np.ndarray) -> np.ndarray:
        """Half-width (P) of the band at `points` (P, k) in [-1, 1]^k by which volume fractions are
        uncertain: less than `band`, as stretches of the border err to either side, each by itself;
        there are as many as runs that hold it (support vectors) and are apart from each other, but
        fewer where runs stand beside others: times the square of the share that does not.
        1.8 over the root of their number times as much; in many directions at least what left-out
        runs show to be on the wrong side."""
        if not self.is_mixed:
            return np.zeros(len(points))
        least = 2.0 * self._missed_share / self.open_fraction if self._missed_share else 0.0
        return self.band(points) * max(min(1.0, _CONFIDENCE / np.sqrt(self.stretch_count)), least)

    @cached_property
    def _missed_share(self) -> float:
        """Share of the box by which that with the event is wrong where folds of runs are left out,
        with 1.5 deviations: in many directions, where all stretches may err to one side."""
        count, free = len(self.points), int(self._free.sum())
        rows = np.flatnonzero(is_general(self.points) & stands_alone(self.points))
        if free <= FEW_PARAMETERS or not len(rows):
            return 0.0
        wrong, folds = np.zeros(count), np.arange(count) % _FOLDS
        for fold in range(_FOLDS):
            x, happens = self.points[folds != fold], self.happens[folds != fold]
            sides = Occurrence(x, happens, reach=self.reach).evaluate(self.points[folds == fold])
            wrong[folds == fold] = sides.astype(float) - self.happens[folds == fold]
        nearest = scipy.spatial.cKDTree(self.points[rows]).query(self._spread())[1]
        wrong = wrong[rows] * np.bincount(nearest, minlength=len(rows)) / _POINTS
        return float(np.hypot(wrong.sum(), _DEVIATIONS * np.linalg.norm(wrong)))

    @cached_property
    def stretch_count(self) -> float:
        """How many stretches of the border err each by itself, at least 1."""
        spacing = len(self.points) ** (-1.0 / max(int(self._free.sum()), 1))
        cells = np.unique(np.round(self._support_vectors[0] / (2 * spacing)), axis=0)
        return max(1.0, len(cells) * float(stands_alone(self.points).mean()) ** 2)

    def run_decision(self, numbers: np.ndarray, margins: np.ndarray) -> np.ndarray:
        """Decision function (R) at R runs by their own results, to compare runs of two meshes: here
        NaN (R), as only whether the event occurs is known. numbers (R): values of the quantity;
        margins (R): event margins, above 0 where it occurs."""
        return np.full(len(numbers), np.nan)

    def run_margins(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Decision function (R) of runs at `points` (R, k), and as it is predicted of each from all
        others (R); the same twice where that is not known."""
        decision = self.decision(points)
        return decision, decision

    @cached_property
    def open_fraction(self) -> float:
        """Volume fraction of the box (8192 points) where runs do not decide if the event occurs."""
        return self._fraction_within(self.band)

    @cached_property
    def usual_open_fraction(self) -> float:
        """Volume fraction of the box as `open_fraction`, by the band of `usual_band`."""
        return self._fraction_within(self.usual_band)

    def _fraction_within(self, band: Callable[[np.ndarray], np.ndarray]) -> float:
        spread = self._spread()
        return float((np.abs(self.decision(spread)) < band(spread)).mean())

    @cached_property
    def cells(self) -> np.ndarray:
        """Volume fractions (N) of the box that are nearest to each run, by 8192 points."""
        rows = scipy.spatial.cKDTree(self.points).query(self._spread())[1]
        return np.bincount(rows, minlength=len(self.points)) / _POINTS

    def infill_points(self, count: int) -> np.ndarray:
        """Points (at most `count`, k) in [-1, 1]^k for further runs, near the border of where the
        event occurs, as far from all runs and each other as can be; none where all runs agree."""
        points = np.zeros((0, self.points.shape[1]))
        if not self.is_mixed:
            return points
        trials = self._trials
        gaps = scipy.spatial.cKDTree(self.points).query(trials)[0] if len(trials) else np.zeros(0)
        while len(points) < count and gaps.max(initial=0.0) > _LEAST:
            points = np.concatenate([points, trials[[gaps.argmax()]]])
            gaps = np.minimum(gaps, np.linalg.norm(trials - points[-1], axis=1))
        return points

    @cached_property
    def _trials(self) -> np.ndarray:
        return self._level_points(_LEVELS)

    @cached_property
    def surface_points(self) -> np.ndarray:
        """Points (P, k) in [-1, 1]^k on the border of where the event occurs (limit-state surface),
        on the side where it does; none where all runs agree."""
        return self._level_points((0.0,)) if self.is_mixed else self.points[:0]

    def _level_points(self, levels: Sequence[float]) -> np.ndarray:
        """Unit points (P, k) just above each level of the decision value over its band, each
        between two points of the box of which one is above and one below all levels."""
        spread = spread_points(self._free, _CANDIDATES)
        spread[:, ~self._free] = self.points[0, ~self._free]
        spread = np.concatenate([spread, self.points])
        ratios = self._ratios(spread)
        highs, lows = spread[ratios > max(levels)], spread[ratios < min(levels)]
        if not len(highs) or not len(lows):
            return spread[:0]
        lows, border_points = lows[scipy.spatial.cKDTree(lows).query(highs)[1]], []
        for level in levels:
            high, low = highs, lows
            for _ in range(30):
                middle = (high + low) / 2
                values = self._ratios(middle) if level else self.decision(middle)
                happens = (values >= level)[:, None]
                high, low = np.where(happens, middle, high), np.where(happens, low, middle)
            border_points.append(high)
        return np.concatenate(border_points)

    def _ratios(self, points: np.ndarray) -> np.ndarray:
        """Decision values (P) over the half-widths of the undecided band at points (P, k)."""
        return self.decision(points) / np.maximum(self.band(points), np.finfo(float).tiny)

    @cached_property
    def _free(self) -> np.ndarray:
        return np.ptp(self.points, axis=0) > 0

    def _border(self, x: np.ndarray) -> np.ndarray:
        """Evaluate the smoothest function that separates the runs with the event from those
        without."""
        points, weights = self._support_vectors
        return in_blocks(lambda block: matern(block, points) @ weights, x, len(points))

    def formula(self) -> Formula:
        """Write the decision function (`decision`) as a table for other programs; only for an
        event that occurs in some runs and not in all (`is_mixed`)."""
        points, weights = self._support_vectors
        k = points.shape[1]
        constant, scales = np.zeros((1, k), dtype=int), np.full(k, np.sqrt(5) / _LENGTH)
        return Formula(constant, np.zeros(1), points, scales, weights, "matern")

    @cached_property
    def _support_vectors(self) -> tuple[np.ndarray, np.ndarray]:
        """Return unit points (n, k) and weights (n) of the border's function. They solve the dual
        problem: minimise |L' a - b| with a >= 0, where L L' is the kernel with the runs' signs and
        L b = 1."""
        points, signs = self._training_runs()
        kernel = matern(points, points) * signs * signs[:, None]
        root = scipy.linalg.cholesky(kernel + _NOISE * np.eye(len(points)), lower=True)
        bound = scipy.linalg.solve_triangular(root, self._sizes(points, signs), lower=True)
        weights, _ = scipy.optimize.nnls(root.T, bound, maxiter=100 * len(points))
        is_support = weights > 0
        return points[is_support], (weights * signs)[is_support]

    def _sizes(self, points: np.ndarray, signs: np.ndarray) -> np.ndarray:
        """Least size (n) of the function at runs: below 1 in those near to others that differ, as
        it would else be so steep there that it bends far from them."""
        sizes = np.ones(len(points))
        if self.reach:
            for sign in (-1.0, 1.0):
                tree = scipy.spatial.cKDTree(points[signs == -sign])
                sizes[signs == sign] = tree.query(points[signs == sign])[0] / self.reach
        return np.minimum(sizes, 1.0)

    @cached_property
    def _decision(self) -> np.ndarray:
        """Return the border's function (N) at the runs, negative at runs on its wrong side."""
        return np.where(self.happens, 1.0, -1.0) * self._border(self.points)

    @cached_property
    def _of_kinds(self) -> list[tuple[scipy.spatial.cKDTree, np.ndarray]]:
        """Runs with the event and those without, as a tree with the values of `_decision`."""
        kinds = self.happens, ~self.happens
        return [(scipy.spatial.cKDTree(self.points[k]), self._decision[k]) for k in kinds]

    def _training_runs(self) -> tuple[np.ndarray, np.ndarray]:
        """Unit points (n, k) and signs (n) of the runs that a border is fitted to."""
        rows = distinct(self.points)
        if len(rows) > _MOST:
            distance = np.empty(len(rows))
            for kind in (True, False):
                mask = self.happens[rows] == kind
                rivals = self.points[self.happens != kind]
                distance[mask] = scipy.spatial.cKDTree(rivals).query(self.points[rows[mask]])[0]
            rows = rows[np.argsort(distance, kind="stable")[:_MOST]]
        return self.points[rows], np.where(self.happens[rows], 1.0, -1.0)

    def _spread(self) -> np.ndarray:
        """Points of the box, evenly spread."""
        free = self._free
        if free.sum() == 1:
            points = np.zeros((_POINTS, len(free)))
            points[:, free] = -1 + (2 * np.arange(_POINTS)[:, None] + 1) / _POINTS
        else:
            points = scan_points(free, _POINTS, seed=2, corners=False)
        points[:, ~free] = self.points[0, ~free]
        return points


@remember
def border_of_runs(points: np.ndarray, happens: np.ndarray) -> Occurrence:
    """Return the `Occurrence` of runs at points (N, k), which is the same for the same runs, so
    that quantities that exist in the same runs share what is computed of it."""
    return Occurrence(points, happens)


class NearestOccurrence(Occurrence):
    """In which part of the box an event occurs, if it does where it does in the nearest run: a
    rival of the smooth border, which tells what few runs leave open. The decision function is the
    difference of the distances from the nearest run without it and from the nearest with it."""

    def _border(self, x: np.ndarray) -> np.ndarray:
        kinds = (scipy.spatial.cKDTree(self.points[k]) for k in (~self.happens, self.happens))
        miss, hit = (tree.query(x)[0] for tree in kinds)
        return miss - hit


def matern(x: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Matérn's kernel (P, N) with two derivatives, of unit points (P, k) and (N, k)."""
    distance = scipy.spatial.distance.cdist(x, points) * (np.sqrt(5) / _LENGTH)
    return (1 + distance + distance**2 / 3) * np.exp(-distance)


@dataclass(frozen=True)
class FittedOccurrence(Occurrence):
    """In which part of the box of parameters an event occurs, by a fitted function: where `fit`, of
    an event margin, is not below 0, or, with `latest` (end of the runs, s), where `fit`, of the
    event's time, is not above that. The decision function is that margin, or the time left. error:
    that of the fit, in its unit, half the width of the undecided band; volume fractions are
    uncertain by `Fit.usual_errors`; points, happens: as in `Occurrence`. A margin or time locates
    the border better than whether the event occurs."""

    fit: Fit
    error: float
    latest: float | None = None

    def agrees(self, tolerance: float = 0.0) -> bool:
        """Return whether the decision function agrees with every run: it is at least minus `error`
        in runs with the event, and below `tolerance` (in its unit) in those without."""
        decision = self.decision(self.points)
        agreement = decision[self.happens] >= -self.error
        return bool(agreement.all() and (decision[~self.happens] < tolerance).all())

    def _decide(self, points: np.ndarray) -> np.ndarray:
        values = self.fit.evaluate(points)
        return values if self.latest is None else self.latest - values

    def formula(self) -> Formula:
        formula = self.fit.formula()
        return formula if self.latest is None else formula.shortfall(self.latest)

    def run_decision(self, numbers: np.ndarray, margins: np.ndarray) -> np.ndarray:
        return margins if self.latest is None else self.latest - numbers

    def run_margins(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rows = scipy.spatial.cKDTree(self.fit.points).query(points)[1]
        values, left_out = self.fit.values[rows], self.fit.left_out[rows]
        return values, values - left_out

    def band(self, points: np.ndarray) -> np.ndarray:
        return np.full(len(points), self.error)

    def usual_band(self, points: np.ndarray) -> np.ndarray:
        return self.fit.usual_errors(points)


@dataclass(frozen=True)
class JointOccurrence(Occurrence):
    """In which part of the box of parameters several events all occur, each with a border of its
    own (`parts`), as a difference of two times exists where both do. The decision function is the
    least of theirs, each over its largest size in the runs."""

    parts: tuple[FittedOccurrence, ...] = field(default=(), kw_only=True)

    def _decide(self, points: np.ndarray) -> np.ndarray:
        return self._decisions(points).min(axis=0)

    def band(self, points: np.ndarray) -> np.ndarray:
        return self._least_part(points, [part.band(points) for part in self.parts])

    def usual_band(self, points: np.ndarray) -> np.ndarray:
        return self._least_part(points, [part.usual_band(points) for part in self.parts])

    def _least_part(self, points: np.ndarray, rows: Sequence[np.ndarray]) -> np.ndarray:
        """Values (P) of the part whose decision function is least; rows: those (P) of each part."""
        least = self._decisions(points).argmin(axis=0)
        return self._over_sizes(rows)[least, np.arange(len(points))]

    def _decisions(self, points: np.ndarray) -> np.ndarray:
        """Decision functions (parts, P) at points, over their sizes."""
        return self._over_sizes([part.decision(points) for part in self.parts])

    def _over_sizes(self, rows: Sequence[np.ndarray]) -> np.ndarray:
        return np.array([row / size for row, size in zip(rows, self._part_sizes, strict=True)])

    @cached_property
    def _part_sizes(self) -> list[float]:
        return [float(np.abs(part.decision(self.points)).max()) or 1.0 for part in self.parts]
