"""Gravity: the weight of every particle."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import ElementType, Energy

LOAD_WORK = Energy("load_work", "load_work", "work of loads, weight and drives")


@dataclass(frozen=True)
class Gravity(ElementType):
    """Uniform gravity on all particles: acceleration (3,) m/s², in global axes; several add up."""

    acceleration: np.ndarray

    gives = LOAD_WORK
    resists_as = "I"
    noun = "weight"
    cost = 5.0  # of each particle

    @classmethod
    def find(cls, scene):
        """Return the Gravity elements of a scene; [] where they add up to 0: no weight."""
        return scene.kinds.get(cls, []) if np.any(scene.gravity != 0) else []

    @classmethod
    def topology_of(cls, scene):
        """Return None: scenes can be simulated side by side whether they have weight or not."""
        return None

    @classmethod
    def cost_in(cls, scene):
        return cls.cost * len(scene.position)

    @classmethod
    def held_up(cls, scene):
        """Return the weight (N) of all particles of a scene together, which joints may have to bear
        at rest; the tolerance of the energy balance follows from it."""
        return float(scene.mass.sum() * np.linalg.norm(scene.gravity))

    @classmethod
    def weight(cls, scene, particle):
        """Weight (3,) N of the particle of index `particle`, in global axes."""
        return scene.mass[particle] * scene.gravity

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.gravity_kernels import Weight

        return Weight(batch.stack(1, 3, lambda s: s.gravity[None]), batch.work_account(cls))
