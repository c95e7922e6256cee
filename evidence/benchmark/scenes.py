"""The scenes that are timed: samples of the paper's linkage."""

from collections.abc import Callable

import numpy as np

import fpm
from evidence.linkage.runs import build


def linkages(count: int, elements: int = 12) -> list[fpm.Scene]:
    """`count` samples of the paper's Bennett linkage, its section's side spread over ± 1 %."""
    sides = 0.035 * (1 + 0.01 * np.linspace(-1, 1, count)) if count > 1 else [0.035]
    return [build(elements=elements, a=float(a)) for a in sides]


def beam_count(scene: fpm.Scene) -> int:
    """Number of beam elements; the linkage's eight virtual beams are arms, and not counted."""
    return sum(len(beams.length) for beams in scene.beams)


def runner(scenes: list[fpm.Scene], steps: int, step: float, instants: int = 2) -> Callable:
    """A run of `steps` steps through the public interface, packing and recording included."""

    def run():
        for outcome in fpm.simulate(scenes, duration=steps * step, instants=instants, step=step):
            if outcome.failure is not None:
                raise outcome.failure

    return run
