"""Points that responses can name."""

from fpm.structures.keys import Reference
from fpm.structures.statement import statement


@statement(
    "record",
    part=Reference(group="parts", about="a bar, or ground"),
    at=Reference(group="points", about="one of its points"),
)
def recorded(build, it):
    """A point of a part whose motion is recorded under this name."""
    build.scene.add_point(it.name, it.part.particle(it.at.name), it.at.position)
