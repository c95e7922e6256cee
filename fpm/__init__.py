"""Finite particle method: motion of deployable structures of links, hinges, springs and contact.

    import fpm
    scene = fpm.scenes.get("bennett").build(a=0.035)
    outcome = fpm.simulate(scene, duration=1.0, instants=2001)[0]

Importing is cheap: numba and xarray are loaded when first needed.
"""

from fpm import responses, scenes, trajectory
from fpm.elements.beam import Material, Section
from fpm.errors import InstabilityError, SceneError
from fpm.scene import Link, Scene
from fpm.simulate import Outcome, divide_time, simulate
from fpm.timestep import StableStep, stable_step

DATA_VERSION = "1"
"""Changes whenever the same scene gives other numbers; part of a run's identity."""

__all__ = [
    "DATA_VERSION",
    "InstabilityError",
    "Link",
    "Material",
    "Outcome",
    "Scene",
    "SceneError",
    "Section",
    "StableStep",
    "divide_time",
    "responses",
    "scenes",
    "simulate",
    "stable_step",
    "trajectory",
    "warm_up",
]


def warm_up() -> None:
    """Compile the solver, or load it from the cache on disk, by a run of a few steps.

    Call it once before several processes start: numba's cache does not stand concurrent writers.
    """
    scene = Scene("warm-up")
    bar = scene.add_link(
        (0, 0, 0), (1, 0, 0), (0, 0, 1), Section.square(0.1), Material(1e9, 0.3, 1e3), 2
    )
    scene.add_point("tip", int(bar.particles[-1]))
    simulate(scene, duration=1e-3, instants=2)
