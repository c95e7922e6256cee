"""A kind of a user's own: springs between particles and the ground."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import index, number, stiffness
from fpm.elements.kind import Deformations, ElementType, Energy


@dataclass(frozen=True)
class GroundSpring(ElementType):
    """From a particle to the point `anchor` (3,)."""

    particle: int = index("position")
    anchor: tuple[float, float, float] = number("m", count=3)
    stiffness: float = stiffness("N/m")
    rest: float = number("m", least=0.0, words="length at rest of {title}")

    stores = Energy("ground", "ground_energy", "energy of the springs to the ground")
    events = ("stretches", "slackens")
    series = {"spring_length": ("m", "length", "ground_spring")}  # noqa: RUF012
    noun = "ground spring"

    @classmethod
    def deformations(cls, scene):
        """Along all three axes, as the spring may turn anywhere."""
        springs = cls.find(scene)
        dofs = np.array([[6 * s.particle + k for k in range(6)] * 2 for s in springs])
        values = np.zeros((3, len(springs), 12))
        values[[0, 1, 2], :, [0, 1, 2]] = 1.0
        each = np.arange(len(springs))
        stiffness = np.array([s.stiffness for s in springs])
        return Deformations(
            np.tile(dofs, (3, 1)), values.reshape(-1, 12), np.tile(stiffness, 3), np.tile(each, 3)
        )
