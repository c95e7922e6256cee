"""Drag of air on points and lines of parts, by the square of the speed.

Theory: docs/mechanics.md, "From outside" (Hoerner, Fluid-Dynamic Drag, 1965, ch. III: the flow
along a rod drags little). Air that moves along with a part (added mass) and lift are left out."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fpm.declare import number, word
from fpm.elements.kind import Deformations, VirtualBeam
from fpm.elements.openings.opening import moving_at_start
from fpm.elements.particles.damping import Damping
from fpm.elements.particles.load import ArmElement

GAUSS = np.polynomial.legendre.leggauss(3)
"""Places from -1 to 1, and weights, of three points on a line: exact for polynomials of degree 5,
as those of a rod that turns about one of its ends (3); of one that turns about its middle 3 % too
much, as |u| has a kink there."""


@dataclass(frozen=True)
class Drag(ArmElement):
    """Drag of air at the end of a rigid arm on a particle. beam: that arm; factor: rho/2 Cd A, the
    force at 1 m/s (kg/m); axis (3,): unit vector in the particle's axes; component: of the
    velocity which drags, "across" that axis (all of it if the axis is zero) or "along" it; wind
    (3,): velocity of the air (m/s), global; name: of the statement to which it belongs."""

    beam: VirtualBeam
    factor: float = number("kg/m", 0.0)
    axis: np.ndarray = number(count=3, default=(0.0, 0.0, 0.0))
    component: str = word({"across": 1.0, "along": 0.0}, default="across")
    wind: np.ndarray = number("m/s", count=3, default=(0.0, 0.0, 0.0))
    name: str = ""

    takes = Damping.takes
    resists_as = ""
    noun, name_field = "drag", "name"
    cost = 55.0

    def topology(self):
        return self.particle

    @classmethod
    def dampings(cls, scene):
        """By the slope 2 rho/2 Cd A |u| at the start. What is faster later is not counted."""
        drags = cls.find(scene)
        p, count = np.array([drag.particle for drag in drags]), len(drags)
        factors, arms, winds = (
            np.array([getattr(drag, name) for drag in drags]) for name in ("factor", "arm", "wind")
        )
        turns = scene.frame[p] @ np.cross(np.eye(3), arms[:, None]).swapaxes(1, 2)
        slopes = 2 * factors * np.linalg.norm(_velocities_at_start(scene) - winds, axis=1)
        if not slopes.any():
            return None
        values = np.dstack([np.tile(np.eye(3), (count, 1, 1)), turns, np.zeros((count, 3, 6))])
        dofs = np.repeat(6 * p, 3)[:, None] + np.tile(np.arange(6), 2)
        element = np.repeat(np.arange(count), 3)
        return Deformations(dofs, values.reshape(-1, 12), np.repeat(slopes, 3), element)

    @classmethod
    def array(cls, name, batch):
        """ "state" has the velocity (m/s) of each place at t = 0."""
        array = super().array(name, batch)
        if name == "state":
            first = cls.kernels().VELOCITY
            array[:, first : first + 3] = batch.stack(len(array), 3, _velocities_at_start)
        return array


def _velocities_at_start(scene) -> np.ndarray:
    """Velocities (d, 3) m/s, global, of the places of all drags at t = 0."""
    motion, drags = moving_at_start(scene), Drag.find(scene)
    p = [drag.particle for drag in drags]
    arms = np.einsum("dij,dj->di", scene.frame[p], [drag.arm for drag in drags])
    return motion.velocity[p] + np.cross(motion.spin[p], arms)


def stations(
    scene, particles: Sequence[int], start: np.ndarray, stop: np.ndarray
) -> Iterator[tuple[int, np.ndarray, float]]:
    """Yield the points on a line of a part at which its drag acts, three for each particle: index
    of the particle, position (3,) m, and share of the line. particles: of the part; start, stop:
    ends of the line (m)."""
    span = stop - start
    position = scene.position if scene.unstrained_position is None else scene.unstrained_position
    places = (position[particles] - start) @ span / (span @ span)
    order = np.argsort(places, kind="stable")
    middles = (places[order][1:] + places[order][:-1]) / 2
    ends = np.clip([0.0, *middles, 1.0], 0.0, 1.0)
    for particle, first, length in zip(
        np.asarray(particles)[order], ends, np.diff(ends), strict=False
    ):
        for x, weight in zip(*GAUSS, strict=True) if length > 0 else ():
            yield int(particle), start + (first + length * (1 + x) / 2) * span, length * weight / 2
