"""Bulk viscosity of beams: a damper along every element, as explicit codes have it.

Leapfrog damps nothing, least of all the last modes of a mesh, in which the front of a wave rings: a
quarter too high in a rod that is pulled at once, and more the more elements it has. With a tension
of c dl/dt beside EA (l - l0)/l0,

    c = share A sqrt(E rho),

an element's own highest mode along its axis (its halves of the mass against each other) has that
share of critical damping, and modes that are long against elements next to none: linear bulk
viscosity, b1 rho c_d l de/dt (von Neumann, Richtmyer, J. Appl. Phys. 21 (1950) 232 for the idea;
Landshoff, LA-1930 (1955) for the linear term; Abaqus Analysis User's Guide, Explicit dynamic
analysis, with b1 = 0.06). It changes with the mesh: as this is refined it vanishes. Sections,
stresses and strain energy have no part of it. What bounds the step of slender elements is their
bending, so that a share of 0.2 costs no step there; 0.5 a third of it."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.bars.beam import Beams
from fpm.elements.kind import Deformations, ElementType
from fpm.elements.openings.opening import moving_at_start
from fpm.elements.particles.damping import Damping
from fpm.errors import SceneError


@dataclass(frozen=True)
class Viscosity(ElementType):
    """Bulk viscosity of all beam elements of a scene: a damper along each element, which damps
    waves of the size of the mesh. share: fraction of critical damping in an element's highest axial
    vibration, at least 0; several viscosities add up."""

    share: float

    takes = Damping.takes
    cost = 20.0  # of each beam element
    resists_as = ""

    def check(self, scene):
        """Check that `share` is a finite number >= 0; raises SceneError if not. scene: not used."""
        if not (np.isfinite(self.share) and self.share >= 0):
            raise SceneError("viscosity", self.share, "a finite number >= 0")

    @classmethod
    def find(cls, scene):
        """Return the bulk viscosities of a scene; [] where it has no beams."""
        return scene.kinds.get(cls, []) if scene.beams else []

    @classmethod
    def names(cls, scene):
        """Return the names of all beam elements of a scene, each of which has a damper."""
        return Beams.names(scene)

    @classmethod
    def dampings(cls, scene):
        """Return how motions of particles stretch all beam elements of a scene (Deformations), with
        the damping (N s/m) of each in the field `stiffness`, for the stable time step."""
        frame = scene.frame if scene.unstrained is None else scene.unstrained
        stretches = [beams.modes(frame)[0] for beams in Beams.find(scene)]
        counts = np.cumsum([0, *(len(beams.length) for beams in Beams.find(scene))])
        rows = [
            part._replace(element=part.element + count)
            for part, count in zip(stretches, counts, strict=False)
        ]
        modes = Deformations(*(np.concatenate(x) for x in zip(*rows, strict=True)))
        return modes._replace(stiffness=_dampings(scene)[:, 0])

    @classmethod
    def pack(cls, batch):
        from fpm.elements.bars.viscosity_kernels import HISTORY, Viscous

        nodes = np.concatenate([b.nodes for b in Beams.find(batch.scene)])

        def history(scene):
            first, second = nodes.T
            chord = scene.position[second] - scene.position[first]
            length = np.linalg.norm(chord, axis=1)
            velocities = moving_at_start(scene).velocity
            rate = np.sum(chord * (velocities[second] - velocities[first]), axis=1) / length
            return np.column_stack([rate, np.zeros(len(rate)), length])

        return Viscous(
            batch.integers(nodes, 2),
            batch.stack(len(nodes), 1, _dampings),
            batch.stack(len(nodes), HISTORY, history),
            batch.loss_account(cls),
        )


def _dampings(scene) -> np.ndarray:
    """Damping (m, 1) of the stretch of every beam element, N s/m."""
    share = sum(element.share for element in Viscosity.find(scene))
    waves = [
        np.full(len(b.length), b.section.A * np.sqrt(b.material.E * b.material.rho))
        for b in Beams.find(scene)
    ]
    return share * np.concatenate(waves)[:, None]
