"""Dead loads, scaled by a piecewise linear curve of time."""

from dataclasses import dataclass

import numpy as np

from deployable.fpm.errors import SceneError
from deployable.fpm.kinds.drive import Drive
from deployable.fpm.kinds.gravity import LOAD_WORK
from deployable.fpm.kinds.kind import Kind
from deployable.fpm.kinds.virtual_beam import VirtualBeam


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

    def check(self, scene):
        """Refuse arm and moment on a particle that a drive turns.

        The work of loads is added up without the spin of such a particle.
        """
        turned = any(d.particle == self.beam.particle and np.any(d.spin) for d in Drive.of(scene))
        if turned and (np.any(self.beam.arm) or np.any(self.moment)):
            raise SceneError(
                f"load on driven particle {self.beam.particle}",
                (self.beam.arm.tolist(), self.moment.tolist()),
                "no arm and no moment: drive the particle at the other end of an element",
            )

    @classmethod
    def check_all(cls, scene):
        """The same when a drive is added."""
        for element in cls.of(scene):
            element.check(scene)

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
        from deployable.fpm.kinds.load_kernels import Loads

        loads = cls.of(batch.one)
        return Loads(
            batch.integers(x.beam.particle for x in loads),
            batch.integers(x.curve for x in loads),
            batch.table(cls, 9, lambda x: [*x.force, *x.moment, *x.beam.arm]),
            batch.given_by(cls),
        )
