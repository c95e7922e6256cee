"""Dead loads, scaled by a piecewise linear curve of time."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.fields import index, number
from fpm.elements.kind import ElementType
from fpm.elements.particles.gravity import LOAD_WORK


@dataclass(frozen=True)
class Load(ElementType):
    """A force at the free end of a virtual beam, and a moment, in global axes.

    curve: index of the curve that scales both with time; -1 for a constant load."""

    beam: VirtualBeam
    force: np.ndarray = number("N", count=3)
    moment: np.ndarray = number("N m", count=3)
    curve: int = index("curves", -1)

    gives = LOAD_WORK
    resists_as = "TL"
    called = "load"

    @property
    def on(self) -> int:
        """Index of the particle on which the load acts."""
        return self.beam.particle

    @property
    def arm(self) -> np.ndarray:
        """Vector from the particle to where the force acts (3,) m, in the particle's own axes."""
        return self.beam.arm

    def topology(self):
        """What must be equal in scenes run side by side: indices of particle and curve."""
        return self.on, self.curve

    @classmethod
    def held_up(cls, scene):
        """Sum of the sizes of the forces (N) of a scene's loads, which joints may have to bear at
        rest: for the tolerance of the energy balance."""
        return float(sum(np.linalg.norm(load.force) for load in cls.of(scene)))

    @classmethod
    def held_round(cls, scene):
        """Sum of the sizes of the moments (N m) of a scene's loads: what exact holds of openings
        may have to bear at rest, by which the tolerance of the energy balance is set."""
        return float(sum(np.linalg.norm(load.moment) for load in cls.of(scene)))
