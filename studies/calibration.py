"""Which K_F, the spring stiffness that Table 1 of the paper leaves empty, fits what it prints.

The paper's campaign (side a ± 1 %, four Chebyshev roots, exact range of the cubic at each instant,
1 s) is repeated over K_F, and under every other open reading: start, supports, mesh, step. Run as
``python -m studies.calibration --output results/calibration --workers 2``; it leaves summary.json,
table.md and plots. docs/calibration.md says what came out.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

import fpm

PAPER = {"BD": 0.063, "vBz": 4.38}
"""Largest differences of the bounds in m and m/s, section 4 of the paper."""
SIDE, HALF_WIDTH, ORDER = 0.035, 0.01, 3
DURATION, INSTANTS = 1.0, 2001
CLOSE = 0.25
"""Share by which a number may miss the paper's and still count as fitting."""
REOPENED = 0.5
"""Opening at B (rad) that must lie between two contacts for the second to be a new closure."""
SAME_TIME = 0.05
"""Two instants (s) that are no further apart belong to the same closure."""
CHUNK = 4
"""Values of K_F that one task of a worker takes: 16 samples, two full batches."""


@dataclass(frozen=True)
class Reading:
    """One way to read the paper: a label and the scene's parameters other than a and K_F."""

    label: str
    parameters: tuple[tuple[str, object], ...] = ()
    safety: float = 0.9


@dataclass(frozen=True)
class Numbers:
    """What the paper's campaign gives for one K_F (N/rad) under one reading.

    largest and at: response -> largest difference of the bounds and its time (s); early: the same
    before any sample's first closure; closures: one tuple of times (s) for each of the samples;
    step (s).
    """

    K_F: float
    largest: dict[str, float]
    at: dict[str, float]
    early: dict[str, float]
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
            and all(abs(time - second.mean()) <= SAME_TIME for time in self.at.values())
        )

    def closure(self, which: int) -> np.ndarray:
        """Times (samples,) in s of the first (0), second (1) ... closure; NaN if there is none."""
        return np.array([c[which] if len(c) > which else np.nan for c in self.closures])


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

    def at(self, K_F: float) -> Numbers:
        """The numbers of the scan's value next to K_F."""
        return min(self.numbers, key=lambda n: abs(n.K_F - K_F))

    def within(self, share: float) -> np.ndarray:
        """Where the misfit is at most (1 + share) times the least misfit, (values,) bool."""
        return self.misfit <= (1 + share) * self.misfit.min()


def default(name: str) -> object:
    """Default of one of the Bennett scene's parameters."""
    return fpm.scenes.get("bennett").parameters[name].default


@cache
def time_step(reading: Reading, stiffest: float) -> float:
    """Step (s) for all runs of a reading with K_F up to `stiffest`: no run depends on another."""
    scene_type = fpm.scenes.get("bennett")
    sides = [SIDE * (1 + sign * HALF_WIDTH) for sign in (-1, 1)]
    limits = [
        fpm.stable_step(scene_type.build(a=a, K_F=stiffest, **dict(reading.parameters))).step
        for a in sides
    ]
    return reading.safety * min(limits)


def closures(outcome: fpm.Outcome) -> tuple[float, ...]:
    """Times (s) at which the end faces of a run meet; the chatter of four contacts counts once."""
    opening, times, last = outcome.openings["B"], [], 0.0
    for time in np.sort(outcome.events[outcome.events[:, 2] == 1, 0]):
        between = opening[(outcome.time >= last) & (outcome.time <= time)]
        if not times or between.max(initial=0.0) > REOPENED:
            times.append(float(time))
        last = time
    return tuple(times)


def campaign(reading: Reading, stiffnesses: Sequence[float], stiffest: float) -> list[Numbers]:
    """The paper's campaign for each K_F (N/rad) in `stiffnesses`, all side by side."""
    from intervals import fit, make_design, surrogate_range

    scene_type = fpm.scenes.get("bennett")
    design = make_design("tensor_roots", 1, ORDER)
    sides = SIDE * (1 + HALF_WIDTH * design.points[:, 0])
    scenes = [
        scene_type.build(a=float(a), K_F=float(k), **dict(reading.parameters))
        for k in stiffnesses
        for a in sides
    ]
    step = time_step(reading, stiffest)
    outcomes = fpm.simulate(scenes, duration=DURATION, instants=INSTANTS, step=step)
    results = []
    for i, k in enumerate(stiffnesses):
        runs = outcomes[i * len(sides) : (i + 1) * len(sides)]
        for run in runs:
            if run.failure is not None:
                raise run.failure
        time, shut = runs[0].time, tuple(closures(run) for run in runs)
        first = min((c[0] for c in shut if c), default=DURATION)
        values = {
            "BD": [np.linalg.norm(r.points["B"][0] - r.points["D"][0], axis=1) for r in runs],
            "vBz": [r.points["B"][1][:, 2] for r in runs],
        }
        largest, at, early, span = {}, {}, {}, {}
        for name, samples in values.items():
            bounds = surrogate_range(fit(design, np.array(samples)))
            width = bounds.inner_upper - bounds.inner_lower
            largest[name], at[name] = float(width.max()), float(time[width.argmax()])
            early[name] = float(width[time < first].max())
            span[name] = float(bounds.inner_upper.max() - bounds.inner_lower.min())
        results.append(Numbers(float(k), largest, at, early, span, shut, runs[0].step))
    return results


def _task(task: tuple[Reading, tuple[float, ...], float]) -> list[Numbers]:
    return campaign(*task)


def scan(plan: Iterable[tuple[Reading, Sequence[float]]], workers: int = 1) -> list[Scan]:
    """Scan every reading over its values of K_F, on `workers` processes."""
    plan = [(reading, tuple(sorted(float(k) for k in values))) for reading, values in plan]
    tasks = [
        (reading, values[i : i + CHUNK], values[-1])
        for reading, values in plan
        for i in range(0, len(values), CHUNK)
    ]
    if workers > 1:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        # Compiled once before the workers start: they only read the cache.
        tiny = fpm.scenes.get("bennett").build(elements_per_link=2)
        fpm.simulate([tiny], duration=1e-4, instants=2)
        with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            done = list(pool.map(_task, tasks))
    else:
        done = [_task(task) for task in tasks]
    scans = {reading: Scan(reading) for reading, _ in plan}
    for (reading, _, _), numbers in zip(tasks, done, strict=True):
        scans[reading].numbers += numbers
    return list(scans.values())


def start_of_half_angle(degrees: float) -> float:
    """start_deg at which half the angle between two bars' axes at B is `degrees`.

    The reading of mu_B = 22.5° as the angle from which the paper starts.
    """
    from scipy.optimize import brentq

    from fpm.scenes.bennett_geometry import bennett_geometry

    geometry = bennett_geometry(
        default("L"), SIDE, default("lambda_deg"), default("mu_deg"), default("omega_deg")
    )

    def excess(opening):
        axis = geometry.pose(opening).rotation[0, :, 0]  # of bar AB; x = 0 is the plane at B
        return math.degrees(math.asin(abs(axis[0]))) - degrees

    return math.degrees(geometry.folded_opening_b - brentq(excess, 0.0, geometry.folded_opening_b))


def grid(first: float, last: float, spacing: float) -> np.ndarray:
    """Evenly spaced values, free of rounding noise in their decimals."""
    return np.round(np.arange(first, last + spacing / 2, spacing), 6)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the study and write its files."""
    from studies.calibration_report import plan, write

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=Path("results/calibration"))
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args(arguments)
    write(scan(plan(), options.workers), options.output)


if __name__ == "__main__":
    # Under its own name, so that workers can unpickle what it hands them.
    from studies.calibration import main as run

    run()
