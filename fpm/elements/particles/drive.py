"""Drives: particles whose motion is given, scaled by a curve of time."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import index, number
from fpm.elements.kind import ElementType
from fpm.elements.particles.load import LOAD_WORK
from fpm.errors import SceneError


@dataclass(frozen=True)
class Drive(ElementType):
    """A particle that moves as prescribed, whatever acts on it. particle: index; velocity (3,) m/s
    and spin (3,) rad/s: in global axes, both multiplied with a curve of time; curve: its index in
    Scene.curves, -1: constant factor 1. Several drives of one particle add up."""

    particle: int = index("position")
    velocity: np.ndarray = number("m/s", count=3)
    spin: np.ndarray = number("rad/s", count=3)
    curve: int = index("curves", -1)

    gives = LOAD_WORK
    noun = "drive"

    def add_to(self, scene):
        self.check(scene)
        for kind in scene.kinds:
            if (
                kind is not Drive
                and not kind.joins
                and self.particle in kind.moved_particles(scene)
            ):
                raise SceneError("driven particle", self.particle, "one that nothing else moves")
        scene.fix(self.particle)
        super().add_to(scene)

    @classmethod
    def moved_particles(cls, scene):
        return [drive.particle for drive in cls.find(scene)]

    @classmethod
    def array(cls, name, batch):
        if name == "kinetic":
            return batch.blank(1, 1)
        if name != "inertia":
            return super().array(name, batch)
        particles = cls.moved_particles(batch.scene)
        return batch.stack(len(particles), 3, lambda scene: scene.inertia[particles])

    @classmethod
    def motion(cls, scene, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the motion that a scene's drives prescribe at a `time` (s): indices of particles
        (d,), each once, velocities (d, 3) m/s, spins (d, 3) rad/s global, summed over drives."""
        particles = np.array(sorted(set(cls.moved_particles(scene))), int)
        motion = np.zeros((2, len(particles), 3))
        for drive in cls.find(scene):
            factor = scene.curve(drive.curve).value(time)
            row = np.searchsorted(particles, drive.particle)
            motion[:, row] += factor * np.array([drive.velocity, drive.spin])
        return particles, motion[0], motion[1]

    @classmethod
    def prescribe(cls, scene, time, motion):
        """Write the velocities (m/s) and spins (rad/s) that a scene's drives prescribe at a `time`
        (s) into motion.velocity and motion.spin, arrays (n, 3) of all particles, global axes."""
        if not cls.find(scene):
            return
        particles, velocity, spin = cls.motion(scene, time)
        motion.velocity[particles], motion.spin[particles] = velocity, spin
