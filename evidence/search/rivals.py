"""Runs that other searches take until both bounds of a box are within 1 % of its width.

Each is told by an oracle, which knows the true bounds, when it is there; where a quantity does not
exist, it gets the worst value so far. A search of expected improvement by kriging (Jones, Schonlau
and Welch 1998), SLSQP from several starts (Kraft 1988) and DIRECT (Jones, Perttunen and Stuckman
1993), in both its forms."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import numpy as np
import scipy

from deployable.intervals.designs import scan_points
from evidence.search.boxes import Box

CLOSE = 0.01  # of the width: so near a bound counts as found
SEEDS = 3
MOST_KRIGING, MOST = 150, 6000  # runs
_REFIT, _CANDIDATES = 4, 1500


class _SearchEnd(Exception):
    """A bound is found, or a search has spent its runs."""


class _Oracle:
    """Counts runs of a box, and tells which bounds are not yet within 1 % of its width."""

    def __init__(self, box: Box, true: tuple[float, float], most: int):
        self.box, self.true, self.most = box, true, most
        self.points: list[np.ndarray] = []
        self.values: list[float] = []

    def run(self, point: np.ndarray) -> float:
        """Value at a unit point (k), NaN where there is none."""
        if len(self.values) >= self.most:
            raise _SearchEnd
        self.points.append(np.array(point, dtype=float))
        self.values.append(float(self.box.function(self.points[-1][None])[0][0]))
        return self.values[-1]

    @property
    def missing(self) -> list[float]:
        """Signs of the bounds that no run has come near to."""
        low, high = self.true
        values = np.array(self.values)
        tolerance = CLOSE * (high - low)
        ends = (
            (-1.0, (values <= low + tolerance).any()),
            (1.0, (values >= high - tolerance).any()),
        )
        return [sign for sign, is_there in ends if not is_there]

    def losses(self, sign: float) -> np.ndarray:
        """What is to be made small to find the bound on one side: of all runs, without NaN."""
        losses = -sign * np.array(self.values)
        return np.where(np.isfinite(losses), losses, np.nanmax(losses, initial=0.0))

    def loss(self, sign: float, point: np.ndarray) -> float:
        """The same at a further point (k); raises where that bound is found."""
        self.run(point)
        if sign not in self.missing:
            raise _SearchEnd
        return float(self.losses(sign)[-1])


def seek_by_improvement(oracle: _Oracle, sign: float, seed: int) -> None:
    """Run where expected improvement is largest, for the bounds that are missing in turn."""
    k = oracle.box.dimension
    generator = np.random.default_rng(seed)
    scales = np.ones(k)
    for point in scan_points(np.ones(k, bool), 2 * k + 2, seed=seed, corners=False):
        oracle.run(point)
    for number in range(oracle.most):
        if not oracle.missing:
            return
        sign = oracle.missing[number % len(oracle.missing)]
        points, losses = np.array(oracle.points), oracle.losses(sign)
        losses = (losses - losses.mean()) / (losses.std() or 1.0)
        if number % _REFIT == 0:
            start = np.log(scales)
            scales = np.exp(
                scipy.optimize.minimize(
                    lambda s: _likelihood(np.exp(s), points, losses),  # noqa: B023
                    start, bounds=[(-3.5, 2.0)] * k, method="L-BFGS-B", options={"maxiter": 15},
                ).x
            )  # fmt: skip
        best = points[losses.argmin()]
        sizes = generator.choice([0.3, 0.1, 0.02, 0.003], (_CANDIDATES // 2, 1))
        neighbours = np.clip(best + sizes * generator.normal(size=(_CANDIDATES // 2, k)), -1, 1)
        trial = np.concatenate([generator.uniform(-1, 1, (_CANDIDATES, k)), neighbours])
        root = scipy.linalg.cholesky(_kernel(points, points, scales, 1e-8), lower=True)
        cross = scipy.linalg.solve_triangular(root, _kernel(points, trial, scales), lower=True)
        weights = scipy.linalg.solve_triangular(root, losses, lower=True)
        variance = _amplitude(weights)
        deviation = np.sqrt(np.maximum(1 - (cross**2).sum(axis=0), 1e-14) * variance)
        gain = losses.min() - weights @ cross
        ratio = gain / deviation
        normal = scipy.stats.norm
        oracle.run(trial[(gain * normal.cdf(ratio) + deviation * normal.pdf(ratio)).argmax()])


def _kernel(a: np.ndarray, b: np.ndarray, scales: np.ndarray, noise: float = 0.0) -> np.ndarray:
    distance = np.sqrt(5) * scipy.spatial.distance.cdist(a / scales, b / scales)
    kernel = (1 + distance + distance**2 / 3) * np.exp(-distance)
    return kernel + noise * np.eye(len(a)) if noise else kernel


def _amplitude(weights: np.ndarray) -> float:
    return max(float(weights @ weights) / len(weights), 1e-12)


def _likelihood(scales: np.ndarray, points: np.ndarray, losses: np.ndarray) -> float:
    root = scipy.linalg.cholesky(_kernel(points, points, scales, 1e-8), lower=True)
    weights = scipy.linalg.solve_triangular(root, losses, lower=True)
    return 0.5 * len(losses) * np.log(_amplitude(weights)) + np.log(np.diag(root)).sum()


def seek_by_slopes(oracle: _Oracle, sign: float, seed: int) -> None:
    """SLSQP with differences, from the middle and then from spread points, for one bound."""
    bounds = [(-1.0, 1.0)] * oracle.box.dimension
    starts = scan_points(np.ones(len(bounds), bool), 512, seed=seed, corners=False)
    for start in [np.zeros(len(bounds)), *starts]:
        scipy.optimize.minimize(
            lambda x: oracle.loss(sign, x), start, bounds=bounds, method="SLSQP"
        )


def seek_by_rectangles(oracle: _Oracle, sign: float, seed: int) -> None:
    """DIRECT for one bound: its first form (seed 0), or the locally biased one (seed 1)."""
    scipy.optimize.direct(
        lambda x: oracle.loss(sign, x),
        [(-1.0, 1.0)] * oracle.box.dimension, maxfun=oracle.most, maxiter=10_000, vol_tol=0.0,
        len_tol=0.0, locally_biased=bool(seed),
    )  # fmt: skip


def rival_runs(box: Box, true: tuple[float, float]) -> dict[str, float]:
    """Runs of each rival until both bounds of a box are found, infinite where they are not; of
    those that begin at random the median of three."""

    def count(seek: Callable[[_Oracle, float, int], None], most: int, seed: int) -> float:
        oracle = _Oracle(box, true, most)
        for sign in (-1.0, 1.0):
            if sign in oracle.missing:
                with contextlib.suppress(_SearchEnd):
                    seek(oracle, sign, seed)
        return np.inf if oracle.missing else len(oracle.values)

    rivals = {
        "expected improvement": (seek_by_improvement, MOST_KRIGING, range(SEEDS)),
        "SLSQP": (seek_by_slopes, MOST, range(SEEDS)),
        "DIRECT": (seek_by_rectangles, MOST, (0,)),
        "DIRECT, local": (seek_by_rectangles, MOST, (1,)),
    }
    return {
        name: float(np.median([count(seek, most, seed) for seed in seeds]))
        for name, (seek, most, seeds) in rivals.items()
    }
