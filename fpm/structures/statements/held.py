"""Supports: points of parts that are held."""

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
    build.scene.fix(it.part.particle(it.at.name), it.translations, it.rotations)
