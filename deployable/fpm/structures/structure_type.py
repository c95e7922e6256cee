"""What a file with a structure gives."""

from dataclasses import dataclass

from deployable.fpm.scenes import SceneType


@dataclass(frozen=True)
class StructureType(SceneType):
    """A scene from a file. mesh: the parameter that sets the mesh, or None; content: its digest."""

    mesh: str | None = None
    content: str = ""
