"""Mass-proportional damping: the force -rate * mass * velocity, and its like for rotation."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import number
from fpm.elements.kind import ElementType, Energy


@dataclass(frozen=True)
class Damping(ElementType):
    """Mass-proportional damping of all particles: force -rate times mass times velocity, and moment
    -rate times angular momentum. rate: in 1/s, at least 0; several add up. Particles held in all
    ways, or moved by a drive, are not damped."""

    rate: float = number("1/s", 0.0, words="damping")

    takes = Energy("damping_work", "damping_work", "energy taken out by damping")
    moves_free = True
    cost = 6.0  # of each particle

    @classmethod
    def find(cls, scene):
        return scene.kinds.get(cls, []) if scene.damping > 0 else []

    @classmethod
    def topology_of(cls, scene):
        return None

    @classmethod
    def cost_in(cls, scene):
        return cls.cost * len(scene.position)

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.damping_kernels import DampingState

        fixed_set = set(np.flatnonzero(batch.scene.fixed.all(axis=1)))
        return DampingState(
            batch.stack(1, 1, lambda s: [[s.damping]]),
            batch.integers(batch.free),
            batch.integers(sorted(batch.moved_particles - fixed_set)),
            batch.loss_account(cls),
        )
