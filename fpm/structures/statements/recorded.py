"""Points that responses can name."""

from fpm.structures.keys import Part, Reference
from fpm.structures.statement import statement


@statement(
    "record",
    part=Part(about="what carries it", ground=True),
    at=Reference(group="points", about="one of its points"),
)
def recorded(build, it):
    """A point of a part whose motion is recorded under this name."""
    build.scene.add_point(it.name, it.part.particle(it.at.name), it.at.position)
