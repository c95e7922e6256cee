"""Point masses on bars."""

import numpy as np

from fpm.structures.builder import APART
from fpm.structures.keys import Number, Part, Reference
from fpm.structures.statement import statement


@statement(
    "masses",
    part=Part(about="what carries it"),
    at=Reference(group="points", about="a point that the part goes through"),
    mass=Number(unit="kg", above=0, about="its mass"),
    inertia=Number(0.0, "its moment of inertia, about every axis", unit="kg m2", least=0),
)
def mass(build, it):
    """A mass at a point of a part, with its centre there."""
    scene, particle = build.scene, it.part.particle(it.at.name)
    off = float(np.linalg.norm(it.at.position - scene.position[particle]))
    if off > APART * build.size:
        build.refuse("at", it.at.name, f"a point on the axis of {it.part.name}, or its centre", off)
    scene.mass[particle] += it.mass
    scene.inertia[particle] += it.inertia
