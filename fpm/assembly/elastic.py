"""Strain energy of the beams of a scene, and its derivatives; theory: fpm/elements/bars/beam.py."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses, slopes
from fpm.assembly.matrices import Form, dofs_of, pair_matrix, sparse
from fpm.elements.bars.beam import Beams, elements_of, end_axes
from fpm.elements.cross import cross


class Shape(NamedTuple):
    """Deformed shape of e beam elements with ends a, b. chord (e, 3): unit vector from a to b;
    length (e,): of it (m); axes (e, 4, 3): a₂, a₃, b₂, b₃, transverse axes of the ends; sines (e,
    4): their products with the chord, 0 at right angles; twist (e,): its sine."""

    chord: np.ndarray
    length: np.ndarray
    axes: np.ndarray
    sines: np.ndarray
    twist: np.ndarray

    @property
    def turns(self) -> np.ndarray:
        """Angles (e, 4), rad, of the sines, by the first two terms of their series."""
        return self.sines * (1.0 + self.sines**2 / 6.0)


class Elastic(NamedTuple):
    """The beam elements of a scene. nodes (e, 2): particle indices of ends a, b; stiffness (e, 5):
    length l at rest (m), EA/l (N/m), 2 EIz/l, 2 EIy/l, GJ/l (N m); axes (e, 4, 3): local axes 2 and
    3 at a, then at b, in the particles' frames; half (e, 2): half width and height (m) of the
    rectangle with the section's radii of gyration, for strains at surfaces."""

    nodes: np.ndarray
    stiffness: np.ndarray
    axes: np.ndarray
    half: np.ndarray

    def energy(self, poses: ParticlePoses) -> float:
        """Return the strain energy (J) of all elements together, at poses of all particles."""
        if not len(self.nodes):
            return 0.0
        shape = self.shape(*poses.ends(self.nodes))
        rest, axial, *bending, torsion = self.stiffness.T
        turns = shape.turns
        total = 0.5 * axial * (shape.length - rest) ** 2 + 0.5 * torsion * shape.twist**2
        for plane, stiff in enumerate(bending):
            angle1, angle2 = turns[:, plane], turns[:, 2 + plane]
            total = total + stiff * (angle1**2 + angle1 * angle2 + angle2**2)
        return float(np.sum(total))

    def largest(self, poses: ParticlePoses) -> tuple[float, float]:
        """Return two largest values over all elements at poses of all particles: of a bend (sine of
        an end's angle) or twist (sine), and of the strain at a surface."""
        shape, rest = self.shape(*poses.ends(self.nodes)), self.stiffness[:, :1]
        curvatures = np.abs(shape.turns[:, 2:] - shape.turns[:, :2]) / rest
        strain = np.abs(shape.length / rest[:, 0] - 1) + (curvatures * self.half).sum(axis=1)
        bend = np.abs(np.column_stack([shape.sines, shape.twist]))
        return float(bend.max(initial=0.0)), float(strain.max(initial=0.0))

    def derivatives(self, poses: ParticlePoses, form: Form = sparse, convex: bool = False):
        """Return the gradient (6n,), N and N m, and the Hessian (6n, 6n) of the strain energy, by
        motions (m, rad) of all n particles at poses. form: of the Hessian (`sparse`, `full`);
        convex: True: without negative eigenvalues of any element (projected Newton method)."""
        count, ends = len(poses.position), poses.ends(self.nodes)
        gradient, blocks = np.zeros(6 * count), np.zeros((0, 12, 12))
        if len(self.nodes):
            np.add.at(gradient, dofs_of(self.nodes), self.gradient(*ends))
            blocks = slopes(self.gradient, *ends)
        if convex and np.isfinite(blocks).all():
            values, vectors = np.linalg.eigh((blocks + blocks.swapaxes(1, 2)) / 2)
            blocks = vectors * np.maximum(values, 0.0)[:, None] @ vectors.swapaxes(1, 2)
        return gradient, pair_matrix(blocks, self.nodes, count, form)

    def shape(self, first: ParticlePoses, second: ParticlePoses) -> Shape:
        """Return the shape of the elements between poses (..., e) of their ends; complex where
        these are."""
        chord = second.position - first.position
        length = np.sqrt(np.sum(chord * chord, axis=-1))
        chord = chord / length[..., None]
        axes = np.concatenate(
            [
                np.einsum("...eij,ekj->...eki", end.frame, local_axes)
                for end, local_axes in ((first, self.axes[:, :2]), (second, self.axes[:, 2:]))
            ],
            axis=-2,
        )
        a2, a3, b2, b3 = np.moveaxis(axes, -2, 0)
        twist = 0.5 * (np.sum(b2 * a3, axis=-1) - np.sum(b3 * a2, axis=-1))
        return Shape(chord, length, axes, np.einsum("...ei,...eki->...ek", chord, axes), twist)

    def gradient(self, first: ParticlePoses, second: ParticlePoses) -> np.ndarray:
        """Return the derivatives (..., e, 12), N and N m, of each element's energy by the motions
        (m, rad) of its ends, at poses (..., e) of these."""
        shape = self.shape(first, second)
        n, length, axes, sines, t = shape
        rest, axial, in_2, in_3, torsion = self.stiffness.T
        turns = shape.turns
        stiff = np.stack([in_2, in_3, in_2, in_3], axis=1)
        by_sine = stiff * (2 * turns + turns[..., [2, 3, 0, 1]]) * (1 + sines**2 / 2)
        by_axis = by_sine[..., None] * axes
        ga, gb = by_axis[..., 0, :] + by_axis[..., 1, :], by_axis[..., 2, :] + by_axis[..., 3, :]
        axial_force = axial * (length - rest) - np.sum(by_sine * sines, axis=-1) / length
        force = (ga + gb) / length[..., None] + axial_force[..., None] * n  # on the first
        a2, a3, b2, b3 = np.moveaxis(axes, -2, 0)
        twist = (0.5 * torsion * t)[..., None] * (cross(a3, b2) - cross(a2, b3))
        ends = [-force, twist - cross(n, ga), force, -twist - cross(n, gb)]
        return np.concatenate(ends, axis=-1)


def elastic_of(scene, groups: Sequence[Beams] | None = None) -> Elastic:
    """Return the beam elements of some groups of a scene, None: of all, as Elastic."""
    groups = Beams.find(scene) if groups is None else groups
    nodes, _, half = elements_of(groups)
    if not len(nodes):
        return Elastic(nodes, np.zeros((0, 5)), np.zeros((0, 4, 3)), half)
    stiffness = np.concatenate([beams.stiffness() for beams in groups])
    return Elastic(nodes, stiffness, end_axes(scene, groups).reshape(-1, 4, 3), half)
