"""Finite particle method: motion of deployable structures of links, hinges, springs and contact.

    from deployable import fpm
    scene = fpm.scenes.get("bennett").build(a=0.035)
    outcome = fpm.simulate(scene, duration=1.0, instants=2001)[0]

Importing is cheap: numba and xarray are loaded when first needed.
"""

from deployable.fpm import quantities, responses, scenes, trajectory
from deployable.fpm.errors import InstabilityError, SceneError
from deployable.fpm.kinds.beam import Material, Section
from deployable.fpm.outcome import Outcome
from deployable.fpm.scene import Link, Scene
from deployable.fpm.simulate import divide_time, simulate
from deployable.fpm.timestep import SAFETY, StableStep, stable_step
from deployable.fpm.warming import warm_up

__all__ = [
    "SAFETY",
    "InstabilityError",
    "Link",
    "Material",
    "Outcome",
    "Scene",
    "SceneError",
    "Section",
    "StableStep",
    "divide_time",
    "quantities",
    "responses",
    "scenes",
    "simulate",
    "stable_step",
    "trajectory",
    "warm_up",
]
