"""Finite particle method: motion of deployable structures of links, hinges, springs and contact.

    import fpm
    scene = fpm.scenes.get("bennett").build(a=0.035)
    outcome = fpm.simulate(scene, duration=1.0, instants=2001)[0]

Importing is cheap: numba and xarray are loaded when first needed.
"""

from fpm import quantities, responses, scenes, trajectory
from fpm.errors import InstabilityError, SceneError
from fpm.kinds.beam import Material, Section
from fpm.outcome import Outcome
from fpm.scene import Link, Scene
from fpm.simulate import divide_time, simulate
from fpm.timestep import SAFETY, StableStep, stable_step
from fpm.warming import warm_up

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
