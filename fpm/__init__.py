"""Finite particle method: motion of deployable structures of links, hinges, springs and contact.

    import fpm
    from fpm import structures
    scene = structures.load("config/structures/bennett.yaml").build(a=0.0352)
    outcome = fpm.simulate(scene, duration=1.0, instants=2001)[0]

Importing is cheap: numba and xarray are loaded when first needed."""

from importlib import import_module
from typing import Any

from fpm.elements.bars.beam import Material, Section
from fpm.errors import InstabilityError, SceneError
from fpm.files import trajectory
from fpm.files.outcome import Outcome
from fpm.reading import quantities, responses
from fpm.scenes.scene import Link, Scene
from fpm.scenes.timestep import SAFETY, StableStep, find_stable_step
from fpm.solver.simulate import divide_time, list_kinds_to_compile, simulate, warm_up

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
    "Structure",
    "divide_time",
    "find_stable_step",
    "list_kinds_to_compile",
    "quantities",
    "responses",
    "simulate",
    "trajectory",
    "warm_up",
]


def __getattr__(name: str) -> Any:
    if name != "Structure":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module("fpm.structures.structure").Structure
