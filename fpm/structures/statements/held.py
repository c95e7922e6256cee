"""Supports: points of parts that are held."""

import numpy as np

from fpm.structures.builder import APART
from fpm.structures.keys import Letters, Part, Reference
from fpm.structures.statement import statement


@statement(
    "supports",
    part=Part(about="what is held"),
    at=Reference(group="points", about="one of its points"),
    translations=Letters("xyz", "axes along which it is held"),
    rotations=Letters("xyz", "axes about which it is held"),
)
def support(build, it):
    """Holds a point of a part along and about global axes."""
    scene, particle = build.scene, it.part.particle(it.at.name)
    scene.supports[it.name] = scene.arm_to(particle, it.at.position)
    off = np.linalg.norm(it.at.position - scene.position[particle])
    whole = len(it.translations) == len(it.rotations) == len("xyz")
    if whole or off <= APART * build.size or not it.translations:
        scene.fix(particle, it.translations, it.rotations)
    else:
        scene.hold_point(it.name, particle, it.at.position, it.translations)
        build.joined.setdefault(particle, []).append(it.name)
        scene.fix(particle, "", it.rotations)
