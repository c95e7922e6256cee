"""Struts: a force along the line between two points, by their distance and its rate.

F(L) is piecewise linear, positive where it pushes the points apart: springs, one way or both,
tables, constant forces; gas springs follow theirs to GAS_POINTS points. A damper adds -c dL/dt, its
rate extrapolated from the last two steps. The energy is the exact integral of -F, least at 0."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpm.declare import number, plain_field, topology
from fpm.elements.cables.cable import Piece, bounding_springs, with_arms
from fpm.elements.kind import ElementType, Energy, VirtualBeam
from fpm.elements.openings.opening import moving_at_start
from fpm.elements.openings.table_spring import table_array
from fpm.elements.particles.damping import Damping
from fpm.errors import SceneError

GAS_POINTS = 129
"""Points of the table of a gas spring, whose force is off by at most (1 + 1/n)/8 (ln K/128)² of
itself: 3e-6 where it grows to K = 1.5 times, 1.4e-4 where to 20 times."""


@dataclass(frozen=True)
class Strut(ElementType):
    """Force along the line between two points, the free ends of `beams` (rigid arms from particles;
    VirtualBeam). name: no other strut's; lengths: one or more increasing distances (m); forces:
    there (N), linear between, positive ones push apart; slopes: of the force (N/m) below the first
    and above the last distance; damping: N s/m, both ways."""

    name: str = topology()
    beams: tuple[VirtualBeam, VirtualBeam] = plain_field()
    lengths: tuple[float, ...] = plain_field()
    forces: tuple[float, ...] = plain_field()
    slopes: tuple[float, float] = (0.0, 0.0)
    damping: float = number("N s/m", 0.0, default=0.0)

    series: ClassVar = {
        "strut_force": ("N", "force of the struts, above 0 where they push", "strut"),
        "strut_length": ("m", "length of the struts", "strut"),
    }
    noun, name_field = "strut", "name"
    resists_as = "S"
    cost = 60.0
    stores = Energy("strut", "strut_energy", "energy of the struts")
    takes = Damping.takes

    def check(self, scene):
        super().check(scene)
        if self.name in [strut.name for strut in Strut.find(scene)]:
            raise SceneError("strut", self.name, "a name that no other strut has")
        particles = [beam.particle for beam in self.beams]
        if len(set(particles)) < 2 or not self.distance(scene) > 0:
            allowed = "points of two particles, apart at the start"
            raise SceneError(f"points of {self.title(scene)}", particles, allowed)
        lengths, forces = np.array(self.lengths), np.array(self.forces)
        is_finite = np.isfinite([*lengths, *forces, *self.slopes]).all()
        if len(lengths) != len(forces) or not (
            is_finite and np.all(np.diff(lengths, prepend=0) > 0)
        ):
            allowed = "as many, finite, at increasing lengths above 0 m"
            raise SceneError(f"forces of {self.title(scene)}", list(self.forces), allowed)

    def topology(self):
        return self.name, tuple(beam.particle for beam in self.beams), len(self.lengths)

    @property
    def all_slopes(self) -> np.ndarray:
        """Slopes (n + 1,), N/m, of the force below, between and above the n distances stated."""
        inner = np.diff(self.forces) / np.diff(self.lengths)
        return np.concatenate([self.slopes[:1], inner, self.slopes[1:]])

    @property
    def numbers(self) -> list[float]:
        """Force (N), slope below (N/m), energy (J) at the first distance, and damping (N s/m)."""
        lengths, slopes, force = np.array(self.lengths), self.all_slopes, np.array(self.forces)
        works = np.cumsum([0.0, *np.diff(lengths) * (force[1:] + force[:-1]) / 2])
        starts, works = np.concatenate([force[:1], force]), np.concatenate([works[:1], works])
        ends = np.array([-np.inf, *np.diff(lengths), np.inf])
        with np.errstate(divide="ignore", invalid="ignore"):
            to_zero = np.where(slopes < 0, -starts / slopes, np.nan)
        is_there = (to_zero * np.sign(ends) > 0) & (np.abs(to_zero) < np.abs(ends))
        peaks = np.where(is_there, works + starts * to_zero / 2, works)
        return [self.forces[0], self.slopes[0], float(peaks.max()), self.damping]

    def distance(self, scene) -> float:
        """Return the distance (m) of the strut's two points, now in `scene`."""
        return float(np.linalg.norm(self._chord(scene)))

    def _chord(self, places) -> np.ndarray:
        first, second = (beam.end_in(places) for beam in self.beams)
        return second - first

    def force(self, length: float) -> float:
        """Return the elastic force (N) at a distance (m) of the points, above 0 where it pushes."""
        bends = np.diff(self.all_slopes)
        ramps = np.maximum(length - np.array(self.lengths), 0.0)
        first_slope_force = self.slopes[0] * (length - self.lengths[0])
        return float(self.forces[0] + first_slope_force + bends @ ramps)

    @classmethod
    def deformations(cls, scene):
        """Along by the steepest slope; across and, on arms, against turns by the largest force of
        the table or at the start (at the length then)."""
        struts = cls.find(scene)
        forces = [max(map(abs, (*s.forces, s.force(s.distance(scene))))) for s in struts]
        stiffness = [
            max(-s.all_slopes.min(), force / s.distance(scene), 0.0)
            for s, force in zip(struts, forces, strict=True)
        ]
        pairs = enumerate(zip(struts, forces, strict=True))
        pulls = ((i, beam, force) for i, (strut, force) in pairs for beam in strut.beams)
        return with_arms(cls._bounds(scene, stiffness), pulls)

    @classmethod
    def dampings(cls, scene):
        return cls._bounds(scene, [strut.damping for strut in cls.find(scene)])

    @classmethod
    def _bounds(cls, scene, values):
        pieces = zip(cls.find(scene), values, strict=True)
        return bounding_springs(scene, ([Piece(s.beams, x)] if x > 0 else [] for s, x in pieces))

    @classmethod
    def array(cls, name, batch):
        struts = cls.find(batch.scene)
        match name:
            case "particle":
                return batch.integers((b.particle for s in struts for b in s.beams), 2)
            case "arms":
                arms = lambda scene: [b.arm for s in cls.find(scene) for b in s.beams]  # noqa: E731
                return batch.stack(2 * len(struts), 3, arms)
            case "start" | "points":
                return table_array(name, batch, cls, lambda s: np.diff(s.all_slopes), "lengths")
            case "numbers":
                return batch.table(cls, len(struts[0].numbers), lambda strut: strut.numbers)
            case "state":
                return batch.stack(len(struts), cls.kernels().STATE, _start)
        return super().array(name, batch)


def gas_table(force: float, length: float, stroke: float, ratio: float, exponent: float):
    """Return lengths (m) and forces (N), GAS_POINTS each, of a gas spring: a gas in a closed
    volume, p V^n constant. force: at `length`, all the way out (N); stroke: travel to all the way
    in (m); ratio: force there over `force`, above 1; exponent: n, 1 (slow) to 1.4 (fast, air)."""
    volume = ratio ** (-np.linspace(1.0, 0.0, GAS_POINTS) / exponent)  # over that all the way out
    inward = stroke * (1 - volume) / (1 - volume[0])
    return length - inward, force * volume**-exponent


def _start(scene) -> np.ndarray:
    """Return the state of struts at t = 0: lengths (m), mean rate in the step before (m/s)."""
    from fpm.elements.cables.strut_kernels import LENGTH, RATE, STATE

    motion = moving_at_start(scene)
    state = np.zeros((len(Strut.find(scene)), STATE))
    for row, strut in zip(state, Strut.find(scene), strict=True):
        chord = strut._chord(motion)
        first, second = (
            motion.velocity[b.particle]
            + np.cross(motion.spin[b.particle], motion.frame[b.particle] @ b.arm)
            for b in strut.beams
        )
        row[LENGTH] = np.linalg.norm(chord)
        row[RATE] = chord @ (second - first) / row[LENGTH]
    return state
