"""Drives: particles whose motion is given, scaled by a piecewise linear curve of time."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Kind
from fpm.elements.particles.gravity import LOAD_WORK
from fpm.errors import SceneError


@dataclass(frozen=True)
class Drive(Kind):
    """A particle whose velocity (3,) m/s and spin (3,) rad/s are given, times a curve (-1: 1)."""

    particle: int
    velocity: np.ndarray
    spin: np.ndarray
    curve: int

    gives = LOAD_WORK

    def add_to(self, scene):
        """Hold the particle as well; no other kind may move it."""
        for kind in scene.kinds:
            if kind is not Drive and not kind.joins and self.particle in kind.moved(scene):
                raise SceneError("driven particle", self.particle, "one that nothing else moves")
        scene.fix(self.particle)
        super().add_to(scene)

    def topology(self):
        """Particle and curve."""
        return self.particle, self.curve

    @classmethod
    def moved(cls, scene):
        """The driven particles."""
        return [drive.particle for drive in cls.of(scene)]

    @classmethod
    def motion(cls, scene, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The driven particles (d,), velocities (d, 3) m/s and spins (d, 3) rad/s at a time (s)."""
        particles = np.array(sorted(set(cls.moved(scene))), int)
        motion = np.zeros((2, len(particles), 3))
        for drive in cls.of(scene):
            factor = 1.0 if drive.curve < 0 else np.interp(time, *scene.curves[drive.curve])
            row = np.searchsorted(particles, drive.particle)
            motion[:, row] += factor * np.array([drive.velocity, drive.spin])
        return particles, motion[0], motion[1]

    @classmethod
    def prescribe(cls, scene, time, motion):
        """The motion of the driven particles is that prescribed."""
        particles, velocity, spin = cls.motion(scene, time)
        motion.velocity[particles], motion.spin[particles] = velocity, spin

    @classmethod
    def pack(cls, batch):
        from fpm.elements.particles.drive_kernels import Drives

        drives = cls.of(batch.one)
        return Drives(
            batch.integers(d.particle for d in drives),
            batch.integers(d.curve for d in drives),
            batch.table(cls, 6, lambda d: [*d.velocity, *d.spin]),
            batch.given_by(cls),
        )
