"""True bounds of a model over the unit box, by dense points and searches from the best of them."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

DRAWS, BEST, TRIALS, ROUNDS = 400_000, 30, 400, 60
"""Points at which true bounds are sought, the best of them from which the search goes on, points
about each in a round, and rounds, each in a smaller neighbourhood."""


@dataclass(frozen=True)
class Box:
    """A quantity over the unit box of `dimension` k.

    function: values (P) at unit points (P, k), NaN where the quantity does not happen."""

    dimension: int
    function: Callable[[np.ndarray], np.ndarray]

    def true_bounds(self) -> tuple[float, float]:
        """The least and largest value, by dense points and searches from the best of them."""
        generator, k = np.random.default_rng(0), self.dimension
        points = generator.uniform(-1, 1, (DRAWS, k))
        points = np.concatenate([points, list(itertools.product([-1.0, 1.0], repeat=k))])
        values = self.function(points)
        return tuple(self._extreme(sign, points, values, generator) for sign in (-1.0, 1.0))

    def _extreme(
        self, sign: float, x: np.ndarray, values: np.ndarray, generator: np.random.Generator
    ) -> float:
        rows = np.argsort(np.where(np.isfinite(values), -sign * values, np.inf))[:BEST]
        points, best = x[rows], sign * values[rows]
        for number in range(ROUNDS):
            sizes = 0.1 * 0.82**number * generator.choice([1, 0.1, 0.01], (BEST, TRIALS, 1))
            steps = sizes * generator.normal(size=(BEST, TRIALS, self.dimension))
            trial = np.clip(points[:, None] + steps, -1, 1)
            trials = sign * self.function(trial.reshape(-1, self.dimension))
            trials = np.where(np.isfinite(trials), trials, -np.inf).reshape(BEST, TRIALS)
            column = trials.argmax(axis=1)
            better = trials[np.arange(BEST), column] > best
            points[better] = trial[better, column[better]]
            best[better] = trials[better, column[better]]
        return float(sign * best.max())
