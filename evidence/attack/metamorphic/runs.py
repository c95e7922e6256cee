"""Structures of the language run, and their curves."""

import random
from dataclasses import dataclass

import numpy as np

import fpm
from evidence.attack.metamorphic.random_structures import DURATION, Draw
from evidence.attack.metamorphic.structure_text import Structure, as_text
from fpm.elements import KINDS, energies_of
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
    reason: str = ""


def draw_structure(seed: str) -> tuple[Structure, float]:
    """The first structure from a seed that the language takes, and how long it runs (s)."""
    rng = random.Random(seed)
    while True:
        structure = Draw(rng).draw()
        try:
            limit = 0.5 * fpm.find_stable_step(scene_of(structure)).step
        except (StructureError, SceneError):
            continue
        for k in range(HALVINGS + 1):
            if DURATION / 2**k <= limit * STEPS:
                return structure, DURATION / 2**k


def scene_of(structure: Structure) -> fpm.Scene:
    """Its scene; StructureError or SceneError if the language refuses it."""
    return loads(as_text(structure)).build()


def simulate(runs: list[Run]) -> None:
    """Run all, side by side where they can be."""
    batches: dict[tuple, list[tuple[Run, fpm.Scene]]] = {}
    for run in runs:
        try:
            scene = scene_of(run.structure)
        except (StructureError, SceneError) as error:
            run.reason = f"refused: {error}"
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
            first.reason = f"refused: {error}"
        else:
            for item in batch:
                _simulate_alike([item])
        return
    for (run, _), outcome in zip(batch, outcomes, strict=True):
        if outcome.failure is None:
            run.curves = curves_of(outcome)
        else:
            run.reason = str(outcome.failure)


def curves_of(outcome: fpm.Outcome) -> Curves:
    """All that is compared."""
    curves: Curves = {}
    for name, (position, velocity) in outcome.points.items():
        curves["position", name] = position[-INSTANTS:], "m"
        curves["velocity", name] = velocity[-INSTANTS:], "m/s"
    for name in ("kinetic", *(energy.name for energy in energies_of(KINDS))):
        curves["energy", name] = outcome.energies[name][-INSTANTS:], "J"
    for name, record in outcome.records.items():
        if record.labels:
            for k, label in enumerate(record.labels):
                curves[name, label] = record.values[-INSTANTS:, k], record.unit
    return curves
