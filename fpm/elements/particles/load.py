"""Dead loads, scaled by a piecewise linear curve of time."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.kind import Kind
from fpm.elements.particles.gravity import LOAD_WORK


@dataclass(frozen=True)
class Load(Kind):
    """A force (3,) N at the free end of a virtual beam and a moment (3,) N m, in global axes.

    curve: index of the curve that scales both with time; -1 for a constant load.
    """

    beam: VirtualBeam
    force: np.ndarray
    moment: np.ndarray
    curve: int

    gives = LOAD_WORK

    def topology(self):
        """Particle and curve."""
        return self.beam.particle, self.curve

    @classmethod
    def held_up(cls, scene):
        """All forces."""
        return float(sum(np.linalg.norm(load.force) for load in cls.of(scene)))

    @classmethod
    def held_round(cls, scene):
        """All moments."""
        return float(sum(np.linalg.norm(load.moment) for load in cls.of(scene)))

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.load_kernels import PAST, Loads

        loads = cls.of(batch.one)
        return Loads(
            batch.integers(x.beam.particle for x in loads),
            batch.integers(x.curve for x in loads),
            batch.table(cls, 9, lambda x: [*x.force, *x.moment, *x.beam.arm]),
            batch.blank(len(loads), PAST),
            batch.given_by(cls),
        )
