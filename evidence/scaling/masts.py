"""Scissor masts of 1 to 100 units: what a step costs, how the energy balances, how joints gape."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import fpm
from evidence.benchmark.clock import best
from evidence.linkage.runs import build as linkage
from fpm import structures

UNITS = (1, 2, 5, 10, 20, 50, 100)
MAST = Path(__file__).parents[2] / "config" / "structures" / "scissor.yaml"
LANES = 8
ELEMENTS = 2
"""Beam elements of half a bar, eight for each unit."""


@dataclass(frozen=True)
class Size:
    """A structure as it was measured: 8 samples side by side.

    units: 0 for the linkage; elements and joints of it; step (s); steps of the run; cost (s) of a
    step; build_time (s) of one scene with its stable step; balance: largest imbalance over the
    largest kinetic energy; gap (m), tilt (rad): widest of any joint."""

    units: int
    elements: int
    joints: int
    step: float
    steps: int
    cost: float
    build_time: float
    balance: float
    gap: float
    tilt: float


def measure(units=UNITS, steps: int = 8000, repeats: int = 3) -> list[Size]:
    """The linkage and masts of some sizes, each over the same number of steps."""
    mast = structures.load(MAST)
    builds = {0: linkage}
    builds |= {n: lambda n=n: mast.build(n=n, elements=ELEMENTS) for n in units}
    return [_size(n, build, steps, repeats) for n, build in builds.items()]


def _size(units: int, build, steps: int, repeats: int) -> Size:
    copies: list[fpm.Scene] = []
    build_time = best({"build": lambda: copies.append(_check_scene(build()))}, repeats)["build"]
    scene = copies[-1]
    step = 0.9 * fpm.find_stable_step(scene).step
    scenes, instants = [scene] * LANES, 41
    duration = steps * step
    outcomes: list[fpm.Outcome] = []

    def run(long: float) -> None:
        outcomes[:] = fpm.simulate(scenes, duration=long * duration, instants=instants, step=step)

    run(0.1)  # compiles, or loads, the time loop
    seconds = best({"short": lambda: run(0.1), "whole": lambda: run(1.0)}, repeats)
    outcome = outcomes[0]
    if outcome.failure is not None:
        raise outcome.failure
    kinetic = outcome.energies["kinetic"].max()
    return Size(
        units=units,
        elements=sum(len(beams.length) for beams in scene.beams),
        joints=len(scene.hinges),
        step=step,
        steps=outcome.steps,
        cost=(seconds["whole"] - seconds["short"]) / (0.9 * outcome.steps),
        build_time=build_time,
        balance=float(np.abs(outcome.energies["balance"]).max() / kinetic),
        gap=_widest(outcome, "gap"),
        tilt=_widest(outcome, "axis_gap"),
    )


def _widest(outcome: fpm.Outcome, suffix: str) -> float:
    """The largest gap, or axis_gap, of all hinges and joints."""
    names = (f"hinge_{suffix}", f"joint_{suffix}")
    return float(max(outcome.records[n].values.max() for n in names if n in outcome.records))


def _check_scene(scene: fpm.Scene) -> fpm.Scene:
    fpm.find_stable_step(scene)
    return scene
