"""Dead loads, scaled by a curve of time."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.declare import index, number
from fpm.elements.kind import ElementType, VirtualBeam
from fpm.elements.particles.gravity import LOAD_WORK


class ArmElement(ElementType):
    """Base class of what acts at the end of a rigid arm, `beam` (VirtualBeam), of a particle."""

    beam: Any

    @property
    def particle(self) -> int:
        """Index of the particle on which the element acts."""
        return self.beam.particle

    @property
    def arm(self) -> np.ndarray:
        """Return the arm (3,) m in the particle's own axes."""
        return self.beam.arm


@dataclass(frozen=True)
class Load(ArmElement):
    """A force and a moment on a particle, of constant direction (global axes), both scaled by a
    curve of time. beam: the particle, and its rigid arm to where the force acts; force (3,) N;
    moment (3,) N m; curve: index in Scene.curves of the curve that scales both, -1: none."""

    beam: VirtualBeam
    force: np.ndarray = number("N", count=3)
    moment: np.ndarray = number("N m", count=3)
    curve: int = index("curves", -1)

    gives = LOAD_WORK
    resists_as = "TL"
    noun = "load"

    def topology(self):
        return self.particle, self.curve

    @classmethod
    def held_up(cls, scene):
        return float(sum(np.linalg.norm(load.force) for load in cls.find(scene)))

    @classmethod
    def held_round(cls, scene):
        return float(sum(np.linalg.norm(load.moment) for load in cls.find(scene)))
