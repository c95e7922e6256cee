"""Boxes whose bounds are known: quantities as functions of unit coordinates, and their bounds.

Events that happen in a part of the box, with margins and without, races, jumps, kinks, several
maxima, resonances and smooth functions, of one to eight parameters.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Values = tuple[np.ndarray, np.ndarray]

DRAWS, BEST, TRIALS, ROUNDS = 400_000, 30, 400, 60
"""Points at which true bounds are sought, the best of them from which the search goes on, points
about each in a round, and rounds, each in a smaller neighbourhood."""


@dataclass(frozen=True)
class Box:
    """A quantity over the unit box of `dimension` k.

    function: values (P) and event margins (P) at unit points (P, k), NaN where there is none;
    is_time: whether the quantity is a time of a run of 10 s.
    """

    name: str
    dimension: int
    function: Callable[[np.ndarray], Values]
    is_time: bool = False

    def true_bounds(self) -> tuple[float, float]:
        """The least and largest value, by dense points and searches from the best of them."""
        generator, k = np.random.default_rng(0), self.dimension
        points = generator.uniform(-1, 1, (DRAWS, k))
        points = np.concatenate([points, list(itertools.product([-1.0, 1.0], repeat=k))])
        values = self.function(points)[0]
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
            trials = sign * self.function(trial.reshape(-1, self.dimension))[0]
            trials = np.where(np.isfinite(trials), trials, -np.inf).reshape(BEST, TRIALS)
            column = trials.argmax(axis=1)
            better = trials[np.arange(BEST), column] > best
            points[better] = trial[better, column[better]]
            best[better] = trials[better, column[better]]
        return float(sign * best.max())


def crossing(amplitude: np.ndarray, level: np.ndarray, rate: np.ndarray, margins: bool) -> Values:
    """Time at which amplitude sin(rate t) first reaches a level, and by how much it exceeds it."""
    excess = amplitude - level
    times = np.arcsin(np.clip(level / amplitude, -1, 1)) / rate
    return np.where(excess > 0, times, np.nan), excess if margins else np.full(len(excess), np.nan)


def edge(margin: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values where a margin is positive."""
    return np.where(margin > 0, values, np.nan)


def root(margin: np.ndarray) -> np.ndarray:
    """Root of a margin, 0 where it is negative."""
    return np.sqrt(np.maximum(margin, 0.0))


def one_parameter(margins: bool) -> Callable[[np.ndarray], Values]:
    """A crossing that happens in 60 % of an interval."""
    return lambda u: crossing(1 + 0.5 * u[:, 0], 0.9, 1.0, margins)


def two_parameters(margins: bool) -> Callable[[np.ndarray], Values]:
    """A crossing whose surface is curved."""
    return lambda u: crossing(
        1 + 0.3 * u[:, 0] - 0.1 * u[:, 1] ** 2, 1.0, 1 + 0.2 * u[:, 1], margins
    )


def three_parameters(margins: bool) -> Callable[[np.ndarray], Values]:
    """A crossing whose level varies."""
    return lambda u: crossing(
        1 + 0.2 * u[:, 0] + 0.1 * u[:, 2], 0.9 + 0.15 * u[:, 1], 1 + 0.3 * u[:, 2], margins
    )


def five_parameters(u: np.ndarray) -> Values:
    """The same with two more parameters, without margins."""
    amplitude = 1 + 0.2 * u[:, 0] + 0.1 * u[:, 2] - 0.05 * u[:, 3]
    return crossing(amplitude, 0.9 + 0.15 * u[:, 1], 1 + 0.3 * u[:, 2] + 0.2 * u[:, 4], False)


def race(u: np.ndarray) -> np.ndarray:
    """The first of two crossings, either of which may be missed."""
    first = crossing(1 + 0.4 * u[:, 0], 0.9, 1.3, False)[0]
    second = crossing(1.3 - 0.3 * u[:, 0] + 0.2 * u[:, 1], 1.05, 0.6, False)[0]
    return np.fmin(first, second)


def needle(u: np.ndarray) -> np.ndarray:
    """An event in 5 % of the box, away from its faces."""
    margin = 0.25 - np.hypot(u[:, 0] - 0.55, u[:, 1] + 0.4)
    return edge(margin, 1.2 - 0.4 * root(margin) + 0.1 * u[:, 1])


def thin_corner(u: np.ndarray) -> np.ndarray:
    """An event in a corner, 3 % of the box."""
    margin = u.sum(axis=1) - 1.9
    return edge(margin, 1.5 - 0.5 * root(margin) + 0.05 * u[:, 1])


def half(u: np.ndarray) -> np.ndarray:
    """An event in 63 % of the box."""
    margin = 0.8 * u[:, 0] + 0.3 * u[:, 1] + 0.25 - 0.15 * u[:, 1] ** 2
    return edge(margin, 2.0 - 0.6 * root(margin) - 0.1 * u[:, 1])


def capture_rate(u: np.ndarray) -> np.ndarray:
    """A rate that falls to 0 where it is no longer caught."""
    margin = 0.8 * u[:, 0] + 0.4 * u[:, 1] + 0.3
    return edge(margin, root(margin))


def separatrix(u: np.ndarray) -> np.ndarray:
    """A time that grows beyond the run."""
    times = 1 - np.log(np.maximum(0.4 + u[:, 0], 1e-300))
    return np.where(times < 10, times, np.nan)


def ratchet(u: np.ndarray) -> np.ndarray:
    """The opening at which one of some teeth holds."""
    tooth = np.floor(2.2 + 0.9 * u[:, 0] + 0.5 * u[:, 1])
    return (0.4 + 0.02 * u[:, 1]) * tooth


def stiction(u: np.ndarray) -> np.ndarray:
    """What sticks below a threshold, and moves like a root above."""
    return 0.3 * root(u[:, 0] - 0.37) + 0.01 * u[:, 0]


def slip(u: np.ndarray) -> np.ndarray:
    """A jump across the box."""
    side = u[:, 0] + 0.3 * u[:, 1] - 0.2
    return np.where(side > 0, 0.8 - 0.3 * side, 0.0) + 0.1 * u[:, 1]


def humps(u: np.ndarray) -> np.ndarray:
    """Two maxima, the lower one first."""
    low = np.exp(-6 * ((u[:, 0] + 0.6) ** 2 + (u[:, 1] + 0.5) ** 2))
    return 0.9 * low + np.exp(-6 * ((u[:, 0] - 0.5) ** 2 + (u[:, 1] - 0.4) ** 2))


def resonance(u: np.ndarray, damping: np.ndarray | float) -> np.ndarray:
    """Amplification of an oscillator whose resonance lies in the box."""
    ratio = 1 + 0.5 * u[:, 0]
    return 1 / np.sqrt((1 - ratio**2) ** 2 + (2 * damping * ratio) ** 2)


def interior(u: np.ndarray) -> np.ndarray:
    """A maximum inside the box."""
    waves = np.cos(1.2 * (u[:, 0] - 0.2)) * np.cos(1.5 * (u[:, 1] + 0.1))
    return waves - 0.3 * (u[:, 2] - 0.4) ** 2


def smooth_4(u: np.ndarray) -> np.ndarray:
    """A wave along two parameters, and a saddle along two."""
    saddle = 0.3 * u[:, 2] ** 2 - 0.2 * u[:, 2] * u[:, 3]
    return np.sin(1.5 * u[:, 0] + 0.5 * u[:, 1]) + saddle


def smooth_8(u: np.ndarray) -> np.ndarray:
    """A root of eight parameters, of which two act together."""
    linear = u @ [0.8, 0.6, -0.5, 0.4, -0.3, 0.2, 0.1, 0.1]
    return np.sqrt(4 + linear + 0.3 * u[:, 0] * u[:, 1])


def cut_off(u: np.ndarray) -> np.ndarray:
    """What a stop ends."""
    return np.minimum(1 + 0.5 * u[:, 0] + 0.2 * u[:, 1] ** 2 - 0.1 * u[:, 2], 1.2)


def silent(function: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], Values]:
    """A quantity without margins."""
    return lambda u: (function(u), np.full(len(u), np.nan))


WEIGHTS = np.array([1.0, 0.8, 0.6, 0.4, 0.2, 0.1])

BOXES = (
    Box("crossing of 1, margins", 1, one_parameter(True), True),
    Box("crossing of 2, margins", 2, two_parameters(True), True),
    Box("crossing of 3, margins", 3, three_parameters(True), True),
    Box("crossing of 1", 1, one_parameter(False), True),
    Box("crossing of 2", 2, two_parameters(False), True),
    Box("crossing of 3", 3, three_parameters(False), True),
    Box("crossing of 5", 5, five_parameters, True),
    Box("race", 2, silent(race), True),
    Box("needle", 2, silent(needle), True),
    Box("thin corner", 3, silent(thin_corner), True),
    Box("event in 63 %", 2, silent(half), True),
    Box("separatrix", 1, silent(separatrix), True),
    Box("capture rate", 2, silent(capture_rate)),
    Box("ratchet", 2, silent(ratchet)),
    Box("stiction", 1, silent(stiction)),
    Box("slip", 2, silent(slip)),
    Box("plateau", 2, silent(lambda u: np.clip(u[:, 0] + 0.3 * u[:, 1], -0.4, 0.5))),
    Box("two humps", 2, silent(humps)),
    Box("resonance of 1", 1, silent(lambda u: resonance(u, 0.05))),
    Box("resonance of 2", 2, silent(lambda u: resonance(u, 0.06 + 0.03 * u[:, 1]))),
    Box("stop", 3, silent(cut_off)),
    Box("slack", 2, silent(lambda u: np.maximum(0.3 * u[:, 0] - 0.2 * u[:, 1] + 0.05, 0.0))),
    Box("wave", 1, silent(lambda u: np.sin(14 * u[:, 0]) * (1 + 0.3 * u[:, 0]))),
    Box("interior", 3, silent(interior)),
    Box("smooth of 4", 4, silent(smooth_4)),
    Box(
        "smooth of 6", 6, silent(lambda u: 1 / (1.5 + 0.2 * u @ WEIGHTS) + 0.05 * u[:, 0] * u[:, 5])
    ),
    Box("smooth of 8", 8, silent(smooth_8)),
)
