"""What a run costs: seconds of a core for its steps and instants, from what a scene has.

Costs are those of eight runs side by side, in nanoseconds, as measured where a register holds 256
bits (an AMD EPYC without 512), accurate to a factor of two; `machine` is the factor for this one.
Kinds of elements state theirs (`ElementType.cost`). Joints that are solved together are counted
out, as it depends on their coupling: twenty on one body cost far more than in a chain."""

from collections.abc import Iterable
from functools import cache

import numpy as np

from fpm.elements import Hinge, Joint, kinds_of
from fpm.scenes.scene import Scene

STEP = 400.0
"""Of a step, whatever is in it."""

INSTANT = 4000.0
"""Of an instant that is recorded, with the check of the balance."""

PARTICLE = 25.0
"""Of a particle, as a rigid body that is on no beam."""

PER_SCENE, PER_STATEMENT = 0.4e-3, 0.05e-3
"""Seconds to pack a run and hand it back, and more for each thing that the scene states: a bar, a
hinge, a spring on it."""


COMPILE: dict[type | None, float] = {None: 1.2, Hinge: 2.5, Joint: 4.0}
COMPILE_OTHER = 0.6
"""Seconds to compile the time loop (None) and some kinds, and each other kind."""


def compile_seconds(kinds: Iterable[type | None]) -> float:
    """Return the estimated time (s) to compile element types once, or the time loop (None)."""
    return sum(COMPILE.get(kind, COMPILE_OTHER) for kind in kinds)


def step_seconds(scene: Scene) -> float:
    """Return the estimated core time (s) of one time step of eight runs of a scene side by side, on
    a machine with 256-bit vector units. Multiply it by `machine()` for this one."""
    on_beams = {int(p) for beams in scene.beams for p in np.unique(beams.nodes)}
    cost = STEP + PARTICLE * (len(scene.position) - len(on_beams))
    return 1e-9 * (cost + sum(kind.cost_in(scene) for kind in kinds_of([scene])))


def run_seconds(scene: Scene, steps: int, instants: int) -> float:
    """Estimate the core time (s) of one run, an eighth of eight side by side, on a machine with
    256-bit vector units; on this one, times `machine()`. steps, instants: numbers."""
    seconds = PER_SCENE + PER_STATEMENT * sum(map(len, scene.kinds.values()))
    return (steps * step_seconds(scene) + instants * 1e-9 * INSTANT) / 8 + seconds


@cache
def machine() -> float:
    """Return the factor from core times on a machine with 256-bit vector units to those on this
    one: 1/2.9 (measured) with 512 bits, 2 below 256, else 1."""
    from llvmlite.binding import get_host_cpu_features

    features = get_host_cpu_features()
    if features.get("avx512f"):
        return 1 / 2.9
    return 1.0 if features.get("avx2") else 2.0  # 128 bits: twice the instructions
