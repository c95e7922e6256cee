"""Supports: particles held along and about global axes.

Which axes are held is a property of the particles (`Scene.fixed`); what is held entirely has no
inverse mass and costs nothing. Only particles held along some axes need a kernel."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import AXES, ElementType
from fpm.errors import SceneError


@dataclass(frozen=True)
class Support(ElementType):
    """Particles that are held along and about global axes. particles: indices; translations,
    rotations: global axes along which, and about which, they are held, letters out of "xyz"."""

    particles: Sequence[int]
    translations: str = "xyz"
    rotations: str = "xyz"

    cost = 60.0

    def add_to(self, scene):
        """Mark the axes as held in `fixed` (n, 6); the support itself is not kept."""
        if set(self.translations + self.rotations) - set(AXES):
            axes = (self.translations, self.rotations)
            raise SceneError("fixed axes", axes, "letters out of 'xyz'")
        columns = [AXES.index(c) for c in self.translations]
        columns += [3 + AXES.index(c) for c in self.rotations]
        for particle in self.particles:
            scene.fixed[particle, columns] = True

    @classmethod
    def find(cls, scene):
        """Return the particles held along, or about, one or two of the global axes."""
        counts = scene.fixed.reshape(-1, 2, 3).sum(axis=2)
        return np.flatnonzero(((counts > 0) & (counts < 3)).any(axis=1)).tolist()

    @classmethod
    def topology_of(cls, scene):
        """Return nothing: held axes are compared elsewhere (solver/pack.py)."""

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.support_kernels import Supports

        particles = cls.find(batch.scene)
        free = batch.stack(len(particles), 6, lambda s: ~s.fixed[particles])
        return Supports(batch.integers(particles), free)
