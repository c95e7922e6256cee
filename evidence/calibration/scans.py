"""Which K_F, the spring stiffness that Table 1 of the paper leaves empty, fits what it prints.

The paper's campaign (side a ± 1 %, four Chebyshev roots, exact range of the cubic at each instant,
1 s) is repeated over K_F, and under every other open reading: start, supports, mesh, step.
docs/calibration.md says what came out."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

import fpm
from deployable.intervals import find_surrogate_range, fit, make_design
from evidence.linkage import runs as linkage

PAPER = {"BD": 0.063, "vBz": 4.38}
"""Largest differences of the bounds in m and m/s, section 4 of the paper."""
SIDE, HALF_WIDTH, ORDER = 0.035, 0.01, 3
DURATION, INSTANTS = 1.0, 2001
CLOSE = 0.25
"""Share by which a number may miss the paper's and still count as fitting."""
MAX_REOPENING = 0.5
"""Opening at B (rad) that must lie between two contacts for the second to be a new closure."""
SAME_TIME = 0.05
"""Two instants (s) that are no further apart belong to the same closure."""
CHUNK = 4
"""Values of K_F that are run at once: 16 samples, two full batches."""


@dataclass(frozen=True)
class Reading:
    """One way to read the paper: a label and the scene's parameters other than a and K_F."""

    label: str
    parameters: tuple[tuple[str, object], ...] = ()
    safety: float = 0.9


@dataclass(frozen=True)
class Numbers:
    """What the paper's campaign gives for one K_F (N/rad) under one reading.

    largest and times: response -> largest difference of the bounds and its time (s); first_width:
    the same before any sample's first closure; closures: one tuple of times (s) for each of the
    samples; step (s)."""

    K_F: float
    largest: dict[str, float]
    times: dict[str, float]
    first_width: dict[str, float]
    span: dict[str, float]
    closures: tuple[tuple[float, ...], ...]
    step: float

    @property
    def misfit(self) -> float:
        """Distance to the paper's two numbers in their logarithms: 0.1 is about 10 %."""
        return math.hypot(*(math.log(self.largest[name] / PAPER[name]) for name in PAPER))

    @property
    def fits(self) -> bool:
        """Both numbers are within CLOSE of the paper's."""
        return all(abs(self.largest[name] / PAPER[name] - 1) <= CLOSE for name in PAPER)

    @property
    def at_second_closure(self) -> bool:
        """Both largest differences lie at the second closure, as the paper tells it."""
        second = self.closure(1)
        return bool(
            np.isfinite(second).all()
            and all(abs(time - second.mean()) <= SAME_TIME for time in self.times.values())
        )

    def closure(self, index: int) -> np.ndarray:
        """Times (samples,) in s of the first (0), second (1) ... closure; NaN if there is none."""
        return np.array([c[index] if len(c) > index else np.nan for c in self.closures])


@dataclass
class Scan:
    """The numbers of one reading over ascending K_F."""

    reading: Reading
    numbers: list[Numbers] = field(default_factory=list)

    @property
    def K_F(self) -> np.ndarray:
        return np.array([n.K_F for n in self.numbers])

    @property
    def misfit(self) -> np.ndarray:
        return np.array([n.misfit for n in self.numbers])

    @property
    def fits(self) -> np.ndarray:
        return np.array([n.fits for n in self.numbers])

    @property
    def at_second_closure(self) -> np.ndarray:
        return np.array([n.at_second_closure for n in self.numbers])

    @property
    def best(self) -> Numbers:
        return min(self.numbers, key=lambda n: n.misfit)

    def numbers_at(self, K_F: float) -> Numbers:
        """The numbers of the scan's value next to K_F."""
        return min(self.numbers, key=lambda n: abs(n.K_F - K_F))


def scene(reading: Reading, a: float, stiffness: float) -> fpm.Scene:
    """The linkage of side a (m) and K_F (N/rad) under a reading."""
    return linkage.build(a=float(a), K_F=float(stiffness), **dict(reading.parameters))


@cache
def time_step(reading: Reading, stiffest: float) -> float:
    """Step (s) for all runs of a reading with K_F up to `stiffest`: no run depends on another."""
    sides = [SIDE * (1 + sign * HALF_WIDTH) for sign in (-1, 1)]
    limits = [fpm.find_stable_step(scene(reading, a, stiffest)).step for a in sides]
    return reading.safety * min(limits)


def closures(outcome: fpm.Outcome) -> tuple[float, ...]:
    """Times (s) at which the end faces of a run meet; the chatter of four contacts counts once."""
    opening, times, last = outcome.openings["B"], [], 0.0
    for time in np.sort(outcome.events[outcome.events[:, 2] == 1, 0]):
        span = opening[(outcome.time >= last) & (outcome.time <= time)]
        if not times or span.max(initial=0.0) > MAX_REOPENING:
            times.append(float(time))
        last = time
    return tuple(times)


def campaign(reading: Reading, stiffnesses: Sequence[float], stiffest: float) -> list[Numbers]:
    """The paper's campaign for each K_F (N/rad) in `stiffnesses`, all side by side."""
    design = make_design("tensor_roots", 1, ORDER)
    sides = SIDE * (1 + HALF_WIDTH * design.points[:, 0])
    outcomes = fpm.simulate(
        [scene(reading, a, k) for k in stiffnesses for a in sides],
        duration=DURATION, instants=INSTANTS, step=time_step(reading, stiffest),
    )  # fmt: skip
    for outcome in outcomes:
        if outcome.failure is not None:
            raise outcome.failure
    runs = [outcomes[i : i + len(sides)] for i in range(0, len(outcomes), len(sides))]
    return [_numbers(float(k), design, group) for k, group in zip(stiffnesses, runs, strict=True)]


def _numbers(stiffness: float, design, runs: list[fpm.Outcome]) -> Numbers:
    """The numbers of one campaign from its runs at the design's points."""
    time, closings = runs[0].time, tuple(closures(run) for run in runs)
    first = min((c[0] for c in closings if c), default=DURATION)
    curves = [linkage.curves(run) for run in runs]
    largest, instants, first_width, span = {}, {}, {}, {}
    for name in PAPER:
        bounds = find_surrogate_range(fit(design, np.array([curve[name] for curve in curves])))
        width = bounds.inner_upper - bounds.inner_lower
        largest[name], instants[name] = float(width.max()), float(time[width.argmax()])
        first_width[name] = float(width[time < first].max())
        span[name] = float(bounds.inner_upper.max() - bounds.inner_lower.min())
    return Numbers(stiffness, largest, instants, first_width, span, closings, runs[0].step)


def scan(reading: Reading, values: Iterable[float]) -> Scan:
    """The campaigns of a reading over values of K_F (N/rad)."""
    values = tuple(sorted(float(k) for k in values))
    chunks = (values[i : i + CHUNK] for i in range(0, len(values), CHUNK))
    return Scan(reading, [n for chunk in chunks for n in campaign(reading, chunk, values[-1])])


def from_plain(data: dict) -> Scan:
    """A scan from what `dataclasses.asdict` and a JSON file made of it."""
    reading = data["reading"]
    parameters = tuple((name, value) for name, value in reading["parameters"])
    numbers = [
        Numbers(**{**n, "closures": tuple(map(tuple, n["closures"]))}) for n in data["numbers"]
    ]
    return Scan(Reading(reading["label"], parameters, reading["safety"]), numbers)
