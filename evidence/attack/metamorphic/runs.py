"""Structures of the language run, and their curves."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import fpm
from evidence.attack.metamorphic.drawn import DURATION, Draw
from evidence.attack.metamorphic.written import Structure, as_text
from fpm.errors import SceneError
from fpm.solver.pack import topology
from fpm.structures import StructureError, loads

STEPS, INSTANTS = 40, 9
"""Of runs of `DURATION`, halved up to `HALVINGS` times where such a step is not stable."""

HALVINGS = 3
Curves = dict[tuple[str, str], tuple[np.ndarray, str]]
"""Values (t,) or (t, 3) by what they are and of what, with their unit."""


@dataclass
class Run:
    """A structure and what came of it: curves of the last `INSTANTS`, or why there are none."""

    structure: Structure
    duration: float
    step: float
    instants: int = INSTANTS
    curves: Curves | None = None
    why: str = ""


def drawn(seed: str) -> tuple[Structure, float]:
    """The first structure from a seed that the language takes, and how long it runs (s)."""
    rng = random.Random(seed)
    while True:
        structure = Draw(rng).draw()
        try:
            limit = 0.5 * fpm.stable_step(scene_of(structure)).step
        except (StructureError, SceneError):
            continue
        for k in range(HALVINGS + 1):
            if DURATION / 2**k <= limit * STEPS:
                return structure, DURATION / 2**k


def scene_of(structure: Structure) -> fpm.Scene:
    """Its scene; StructureError or SceneError if the language refuses it."""
    return loads(as_text(structure)).build()


def simulate(runs: list[Run], beside: Callable[[Structure], Structure]) -> None:
    """Run them all, side by side where they can be; beside: adds what is to stand beside each."""
    batches: dict[tuple, list[tuple[Run, fpm.Scene]]] = {}
    for run in runs:
        try:
            scene = scene_of(beside(run.structure))
        except (StructureError, SceneError) as error:
            run.why = f"refused: {error}"
            continue
        key = topology(scene), run.duration, run.instants, run.step
        batches.setdefault(key, []).append((run, scene))
    for batch in batches.values():
        _simulate_alike(batch)


def _simulate_alike(batch: list[tuple[Run, fpm.Scene]]) -> None:
    """Run what differs in numbers alone; where one is refused only now, each by itself."""
    first = batch[0][0]
    try:
        outcomes = fpm.simulate(
            [scene for _, scene in batch], duration=first.duration, instants=first.instants,
            step=first.step, energy_tolerance=1.0,
        )  # fmt: skip
    except SceneError as error:
        if len(batch) == 1:
            first.why = f"refused: {error}"
        else:
            for one in batch:
                _simulate_alike([one])
        return
    for (run, _), outcome in zip(batch, outcomes, strict=True):
        if outcome.failure is None:
            run.curves = curves_of(outcome)
        else:
            run.why = str(outcome.failure)


def curves_of(outcome: fpm.Outcome) -> Curves:
    """All that is compared."""
    found: Curves = {}
    for name, (position, velocity) in outcome.points.items():
        found["position", name] = position[-INSTANTS:], "m"
        found["velocity", name] = velocity[-INSTANTS:], "m/s"
    for name, values in outcome.energies.items():
        if name != "balance":
            found["energy", name] = values[-INSTANTS:], "J"
    for name, recorded in outcome.recorded.items():
        if recorded.labels:
            for k, label in enumerate(recorded.labels):
                found[name, label] = recorded.values[-INSTANTS:, k], recorded.unit
    return found
