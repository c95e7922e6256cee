"""Points that responses can name."""

from fpm.structures.keys import Reference
from fpm.structures.statement import Statement


class Recorded(Statement):
    """A point of a part whose motion is recorded under this name."""

    group = "record"
    keys = {
        "part": Reference(group="parts", about="a bar, or ground"),
        "at": Reference(group="points", about="one of its points"),
    }

    @staticmethod
    def build(build, it):
        build.scene.add_point(it.name, it.part.particle(it.at.name), it.at.position)
