"""A kind of a user's own: springs between particles and the ground."""

from dataclasses import dataclass

import numpy as np

import fpm
from fpm.elements.kind import Deformations, Energy, Kind, Recorded


@dataclass(frozen=True)
class GroundSpring(Kind):
    """From a particle to the point `anchor` (3,) m: stiffness (N/m), length at rest (m)."""

    particle: int
    anchor: tuple[float, float, float]
    stiffness: float
    rest: float

    stores = Energy("ground", "ground_energy", "energy of the springs to the ground")
    events = ("stretches", "slackens")

    def check(self, scene):
        if not self.stiffness > 0:
            raise fpm.SceneError("ground spring stiffness", self.stiffness, "a positive number")

    def topology(self):
        return self.particle

    @classmethod
    def names(cls, scene):
        return [f"ground spring {i}" for i in range(len(cls.of(scene)))]

    @classmethod
    def deformations(cls, scene):
        """Along all three axes, as the spring may turn anywhere."""
        springs = cls.of(scene)
        dofs = np.array([[6 * s.particle + k for k in range(6)] * 2 for s in springs])
        values = np.zeros((3, len(springs), 12))
        values[[0, 1, 2], :, [0, 1, 2]] = 1.0
        each = np.arange(len(springs))
        stiffness = np.array([s.stiffness for s in springs])
        return Deformations(
            np.tile(dofs, (3, 1)), values.reshape(-1, 12), np.tile(stiffness, 3), np.tile(each, 3)
        )

    @classmethod
    def pack(cls, batch):
        from ground_spring_kernels import GroundSprings

        springs = cls.of(batch.one)
        return GroundSprings(
            batch.integers(s.particle for s in springs),
            batch.table(cls, 5, lambda s: [*s.anchor, s.stiffness, s.rest]),
            batch.blank(len(springs), 2),
            batch.blank((batch.instants + 1) * len(springs), 1),
            batch.rows_of(cls),
            batch.log_of(cls),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        names = tuple(cls.names(scene))
        lengths = part.track[:, 0, lane].reshape(-1, len(names))
        return {"spring_length": Recorded(lengths, "m", "length", "ground_spring", names)}
