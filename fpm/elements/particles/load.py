"""Gravity, the weight of every particle; and dead loads, scaled by a curve of time."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.declare import index, number
from fpm.elements.kind import ElementType, Energy, VirtualBeam
from fpm.errors import SceneError

LOAD_WORK = Energy("load_work", "load_work", "work of loads, weight and drives")


@dataclass(frozen=True)
class Gravity(ElementType):
    """Uniform gravity on all particles: acceleration (3,) m/s², in global axes; several add up.
    curve: index in Scene.curves of the curve that scales it, -1: none; one with a curve is alone.
    """

    acceleration: np.ndarray
    curve: int = index("curves", -1, default=-1)

    gives = LOAD_WORK
    resists_as = "I"
    has_memory = False
    noun = "weight"
    cost = 5.0  # of each particle

    @classmethod
    def find(cls, scene):
        return scene.kinds.get(cls, []) if np.any(scene.gravity != 0) else []

    def check(self, scene):
        super().check(scene)
        curves = [g.curve for g in scene.kinds.get(Gravity, []) if np.any(g.acceleration)]
        if curves and max(self.curve, *curves) >= 0:
            raise SceneError("gravity", self.acceleration.tolist(), "one, where it has a curve")

    @classmethod
    def curve_of(cls, scene) -> int:
        """Return the index of the curve of time that scales gravity in a scene; -1: none."""
        return max((gravity.curve for gravity in scene.kinds.get(cls, [])), default=-1)

    @classmethod
    def topology_of(cls, scene):
        curve = cls.curve_of(scene)
        return None if curve < 0 else curve

    @classmethod
    def cost_in(cls, scene):
        return cls.cost * len(scene.position)

    @classmethod
    def held_up(cls, scene):
        return float(scene.mass.sum() * np.linalg.norm(scene.gravity))

    @classmethod
    def weight(cls, scene, particle):
        """Weight (3,) N of the particle of index `particle`, in global axes, without the curve."""
        return scene.mass[particle] * scene.gravity

    @classmethod
    def pack(cls, batch):
        acceleration = batch.stack(1, 3, lambda s: s.gravity[None])
        account = batch.work_account(cls)
        if (curve := cls.curve_of(batch.scene)) >= 0:
            from fpm.elements.particles.gravity_kernels import VaryingWeight

            curves = batch.integers([curve])
            return VaryingWeight(acceleration, curves, batch.blank(1, 3), account)
        from fpm.elements.particles.gravity_kernels import Weight

        return Weight(acceleration, account)


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
