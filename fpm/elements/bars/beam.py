"""Euler-Bernoulli beam elements between two particles.

Theory: docs/mechanics.md, "Beams". End forces are the exact gradient of the strain energy, from
which the rigid motion is taken out. Sources: Ting, Shih, Wang, J. Mech. 20 (2004) 113 (vector form
intrinsic finite element); corotational chord frame: Crisfield, Non-linear FEA vol. 2, ch. 17.

Masses: docs/mechanics.md, "Masses of a link" (Gregory's end corrections: Hildebrand, Introduction
to Numerical Analysis, 2nd ed., § 5.9). More differences than half of the link has room for, or than
four, do not pay. The excess (f - 1) rho I L of a factor f on the inertia of sections is taken back
by moving ``(f - 1) (r/l)² n / (2 (n - 1))`` from the ends, where these keep some mass."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fpm.elements.cross import columns, cross, length
from fpm.elements.kind import Deformations, ElementType, Energy, Watch
from fpm.errors import SceneError

BEND = Watch(
    "bend", 0.25, False,
    lambda values: (
        f"an element is bent or twisted by {values['bend']:.2g} rad, too much for linear theory",
        "refine the mesh: the bend and twist of an element fall with its length",
    ),
)  # fmt: skip
"""Largest sine of the angle between an element's chord and its ends, and of its twist. Whipping
links whose elements bend by so much have errors of some percent (docs/extremes.md); beyond that the
energy still balances, on a wrong curve. A finer mesh bends less."""

STRAIN = Watch(
    "strain", 0.5, False,
    lambda values: (
        f"the surface of an element is strained by {values['strain']:.2g}, which no beam bears",
        "no mesh or step helps where links are bent to a radius below their own height or "
        "stretched by half: stiffen their material, or soften what bends them",
    ),
)  # fmt: skip
"""Largest strain at the surface of an element: its stretch, and half its height over the radius to
which it is bent. At 0.5 that radius is the height: no beam, whatever the mesh. (A bar curved to
such a radius is 8 % stiffer than a straight one: Winkler's theory of curved bars.)"""


@dataclass(frozen=True)
class Material:
    """Linear elastic isotropic material; SceneError if an attribute is not as said.

    Attributes
    ----------
    E: Young's modulus (Pa), above 0.
    nu: Poisson's ratio, -1 < nu <= 0.5.
    rho: density (kg/m³), above 0.
    stiffness_damping: Rayleigh's beta (s), at least 0 (bar_damping.py)."""

    E: float
    nu: float
    rho: float
    stiffness_damping: float = 0.0

    def __post_init__(self):
        if not self.E > 0:
            raise SceneError("Young's modulus E", self.E, "a positive number (Pa)")
        if not -1 < self.nu <= 0.5:
            raise SceneError("Poisson's ratio nu", self.nu, "-1 < nu <= 0.5")
        if not self.rho > 0:
            raise SceneError("density rho", self.rho, "a positive number (kg/m3)")
        if not 0 <= self.stiffness_damping < np.inf:
            raise SceneError("stiffness damping", self.stiffness_damping, "a time >= 0 (s)")

    @property
    def G(self) -> float:
        """Shear modulus (Pa)."""
        return self.E / (2 * (1 + self.nu))


@dataclass(frozen=True)
class Section:
    """Cross-section of a bar.

    Attributes
    ----------
    A: area (m²).
    Iy, Iz: second moments of area ∫z² dA and ∫y² dA (m⁴).
    J: torsion constant (m⁴).
    outline: contour, for stresses (fpm/reading/bars.py): "rectangle", "round", or "" if unknown.
    width, height: of the contour along the local y and z axes (m), 0 if it is unknown."""

    A: float
    Iy: float
    Iz: float
    J: float
    outline: str = ""
    width: float = 0.0
    height: float = 0.0

    @staticmethod
    def rectangle(width: float, height: float) -> "Section":
        """Return the section of a solid rectangle. width (m): along the local y axis; height (m):
        along the local z axis; SceneError unless both are above 0. Torsion constant by the series
        of Timoshenko and Goodier, Theory of Elasticity, § 109."""
        if not (width > 0 and height > 0):
            raise SceneError("section width, height", (width, height), "positive lengths (m)")
        long, short = max(width, height), min(width, height)
        odd = np.arange(1, 40, 2)
        series = np.sum(np.tanh(odd * np.pi * long / (2 * short)) / odd**5)
        J = long * short**3 * (1 / 3 - 64 / np.pi**5 * short / long * series)
        Iy, Iz = width * height**3 / 12, height * width**3 / 12
        return Section(width * height, Iy, Iz, float(J), "rectangle", width, height)

    @staticmethod
    def square(side: float) -> "Section":
        """Return the section of a solid square; side: its length (m), above 0, else SceneError."""
        return Section.rectangle(side, side)

    @staticmethod
    def circle(radius: float) -> "Section":
        """Return the section of a solid circle; radius (m)."""
        return Section.tube(radius, 0.0)

    @staticmethod
    def tube(outer: float, inner: float) -> "Section":
        """Return the section of a round tube; outer, inner: radii (m); inner 0: a solid circle."""
        inertia = np.pi / 4 * (outer**4 - inner**4)
        area = np.pi * (outer**2 - inner**2)
        return Section(area, inertia, inertia, 2 * inertia, "round", 2 * outer, 2 * outer)


@dataclass(frozen=True)
class Beams(ElementType):
    """A group of m beam elements of one section and material, between particles of a scene. nodes
    (m, 2): particle indices of both ends; length (m,): undeformed lengths (m); triad (m, 3, 3):
    global axes at the start, as columns, the first along the chord (line from end to end); section:
    Section; material: Material; name: of the group, from which the elements' names are made; bow
    (rad): angle between ends and chord without stress, of the first end towards the third axis, of
    the second the other way; None: straight, in all samples of a batch."""

    nodes: np.ndarray
    length: np.ndarray
    triad: np.ndarray
    section: Section
    material: Material
    name: str
    bow: float | None = None

    stores = Energy("strain", "strain_energy", "strain energy of the beam elements")
    watches = (BEND, STRAIN)
    resists_as = ""
    cost = 105.0  # of each element, with one of its particles

    @staticmethod
    def create(scene, nodes, section, material, normal, name) -> "Beams":
        """Return a group of beam elements between particles of a scene, unstressed as these are
        placed now; `Scene.add_beams` adds it, and says what the arguments are."""
        nodes = np.atleast_2d(np.asarray(nodes, int))
        if nodes.shape[1] != 2 or nodes.min() < 0 or nodes.max() >= len(scene.position):
            raise SceneError(f"nodes of {name}", nodes.tolist(), "(m, 2) indices of particles")
        chord = scene.position[nodes[:, 1]] - scene.position[nodes[:, 0]]
        length = np.linalg.norm(chord, axis=1)
        if not np.all(length > 0):
            raise SceneError(f"length of {name}", length.min(), "two particles apart")
        normals = np.asarray(normal, float)
        if normals.shape == (3,):
            normals = np.tile(normals, (len(nodes), 1))
        axes = np.array([triad(c, z) for c, z in zip(chord, normals, strict=True)])
        return Beams(nodes, length, axes, section, material, name)

    def with_strain(self, strain: float, curvature: float | None) -> "Beams":
        """Return a copy of this group, whose elements have equal lengths, with another stress-free
        shape. strain: its relative elongation; curvature (1/m): of every element, above 0 if the
        side towards the local third axis is longer, 0 for a straight sample in a batch with curved
        ones; None: straight, as all samples of its batch are (kernels then compute less)."""
        length = self.length * (1.0 + strain)
        bow = None if curvature is None else float(curvature * length[0] / 2)
        return replace(self, length=length, bow=bow)

    def end_axes(self) -> np.ndarray:
        """Return the local axes 2 and 3 at both ends of these elements without stress, (2, m, 3,
        2): end, element, global component, axis. Normal to the chord, axis 3 turned by `bow`."""
        axes = self.triad[None, :, :, 1:].repeat(2, axis=0)
        if self.bow:
            turn = np.array([self.bow, -self.bow])[:, None, None]
            axes[..., 1] = np.cos(turn) * axes[..., 1] + np.sin(turn) * self.triad[:, :, 0]
        return axes

    def stiffness(self) -> np.ndarray:
        """Return a table (m, 5) with a row for each element, by which its stiffness matrix is
        built: undeformed length l0 (m), EA/l0 (N/m), 2 EIz/l0, 2 EIy/l0 and GJ/l0 (N m)."""
        s, m, n = self.section, self.material, len(self.length)
        table = np.empty((n, 5))
        table[:, 0] = self.length
        table[:, 1:] = [m.E * s.A, 2 * m.E * s.Iz, 2 * m.E * s.Iy, m.G * s.J]
        table[:, 1:] /= self.length[:, None]
        return table

    @classmethod
    def topology_of(cls, scene):
        """For each group the particles of its elements; then whether any has, or may have, axes
        other than its particles' (`has_frames`)."""
        return tuple(b.nodes.tobytes() for b in cls.find(scene)), has_frames(scene)

    @classmethod
    def names(cls, scene):
        """Name of the group and a number, as "link[0]"."""
        return [f"{b.name}[{i}]" for b in cls.find(scene) for i in range(len(b.length))]

    @classmethod
    def deformations(cls, scene):
        frame = scene.frame if scene.unstrained is None else scene.unstrained
        modes, count = [], 0
        for beams in cls.find(scene):
            modes += [d._replace(element=d.element + count) for d in beams.modes(frame)]
            count += len(beams.length)
        return Deformations(*(np.concatenate(x) for x in zip(*modes, strict=True)))

    def modes(self, frame: np.ndarray) -> list[Deformations]:
        """Return independent deformations of these m elements, six Deformations with m springs
        each: stretch, twist, sum and difference of the end rotations in both bending planes, by
        which the stiffness is diagonal. frame (n, 3, 3): particles' strain-free axes, columns."""
        table, (a, b) = self.stiffness(), self.nodes.T
        six = np.arange(6)
        dofs = np.concatenate([6 * a[:, None] + six, 6 * b[:, None] + six], axis=1)
        n, e2, e3 = np.moveaxis(self.triad, 2, 0)
        zero = np.zeros_like(n)

        def local(v, nodes):
            return np.einsum("mji,mj->mi", frame[nodes], v)

        def row(xa, ra, xb, rb):
            return np.concatenate([xa, local(ra, a), xb, local(rb, b)], axis=1)

        rows = [(row(-n, zero, n, zero), table[:, 1]), (row(zero, -n, zero, n), table[:, 4])]
        for axis, k in ((e2, table[:, 2]), (e3, table[:, 3])):
            moment_axis = np.cross(axis, n)
            # th_a^2 + th_a th_b + th_b^2 = 3/4 (th_a + th_b)^2 + 1/4 (th_a - th_b)^2
            slope = axis / self.length[:, None]
            rows.append((row(-2 * slope, moment_axis, 2 * slope, moment_axis), 1.5 * k))
            rows.append((row(zero, moment_axis, zero, -moment_axis), 0.5 * k))
        element = np.arange(len(self.length))
        return [Deformations(dofs, values, k, element) for values, k in rows]

    @classmethod
    def pack(cls, batch):
        from fpm.elements.bars.beam_kernels import (
            AXES,
            BEAM,
            SHARES,
            FramedElements,
            StraightElements,
        )

        def stiffness(scene):
            return np.concatenate([b.stiffness() for b in cls.find(scene)]) * SHARES

        nodes = np.concatenate([b.nodes for b in cls.find(batch.scene)])
        arrays = (
            batch.integers(nodes, 2),
            batch.stack(len(nodes), BEAM, stiffness),
            batch.peaks_of(cls),
            batch.rows_of(cls),
        )
        if has_frames(batch.scene):
            return FramedElements(*arrays, batch.stack(len(nodes), AXES, end_axes))
        return StraightElements(*arrays)


NO_TURN = np.array([0.0, 1, 0, 0, 0, 1] * 2)
"""Row of `end_axes` of an element whose axes are those of its particles."""


def has_frames(scene) -> bool:
    """Return whether some beam element of a scene has local axes other than those of its particles
    (to rounding), or may have, as with a bow; kernels then compute more. Decided for each scene
    alone, so that its last digits do not depend on those simulated with it."""
    has_bow = any(beams.bow is not None for beams in Beams.find(scene))
    return has_bow or bool(Beams.find(scene) and np.abs(end_axes(scene) - NO_TURN).max() >= 1e-12)


def end_axes(scene, groups: Sequence[Beams] | None = None) -> np.ndarray:
    """Return the stress-free local axes 2 and 3 of m beam elements of a scene at both ends a and b,
    in the axes of their particles: (m, 12), each row a2, a3, b2, b3. groups: None: all."""
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    groups = Beams.find(scene) if groups is None else groups
    nodes = np.concatenate([beams.nodes for beams in groups])
    axes = np.concatenate([beams.end_axes() for beams in groups], axis=1)
    pairs = zip(nodes.T, axes, strict=True)
    ends = [np.einsum("mji,mjk->mki", frame[end], square) for end, square in pairs]
    return np.hstack([end.reshape(-1, 6) for end in ends])


def triad(direction: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return right-handed orthonormal axes (3, 3), as columns: x along `direction` (3,), of any
    length, z in the plane of it and `normal` (3,), on its side. SceneError if they are parallel."""
    x = np.asarray(direction, float)
    x = x / length(x)
    y = cross(normal, x)
    size = length(y)
    if size < 1e-9:
        raise SceneError("normal", tuple(normal), f"a vector not parallel to the beam, {tuple(x)}")
    y = y / size
    return columns(x, y, cross(x, y))


def elements_of(groups: Sequence[Beams]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Join groups of beam elements. Returns of all m elements, group by group: nodes (m, 2),
    particle indices; undeformed lengths (m,) in metres; and half widths and heights (m, 2) in
    metres, along local y and z, of rectangles with the radii of gyration of the sections (the
    sections themselves if they are solid rectangles, else of another area)."""
    nodes, length, half = [np.zeros((0, 2), int)], [np.zeros(0)], [np.zeros((0, 2))]
    for beams in groups:
        nodes.append(beams.nodes)
        length.append(beams.length)
        radius = np.sqrt(np.array([beams.section.Iz, beams.section.Iy]) / beams.section.A)
        half.append(np.tile(np.sqrt(3.0) * radius, (len(beams.length), 1)))
    return np.concatenate(nodes), np.concatenate(length), np.concatenate(half)


GREGORY = (1 / 12, 1 / 24, 19 / 720, 3 / 160)
"""Coefficients of the differences in Gregory's end corrections of the trapezium rule."""

SMALLEST_END = 0.1
"""Least share of an element's mass that an end particle may keep."""


@lru_cache(64)
def end_weights(elements: int, order: int | None = None) -> np.ndarray:
    """Return the masses (n+1,) of the particles of a slender link, as fractions of the mass of one
    element. elements: their number n, at least 1; order: highest order of differences in Gregory's
    end corrections, 0 (the trapezium rule) to 4; None: n/2, but 2 to 4 (0 for one element)."""
    weights = np.ones(elements + 1)
    weights[[0, -1]] = 0.5
    if order is None:
        order = min(max(elements // 2, 2), len(GREGORY)) if elements >= 2 else 0
    for k in range(1, order + 1):
        for j in range(k + 1):
            # The share of particle j in the difference of order k, whose sign alternates.
            weight = -GREGORY[k - 1] * (-1) ** j * math.comb(k, j)
            weights[j] += weight
            weights[-1 - j] += weight
    weights.flags.writeable = False
    return weights


def lump(length: float, elements: int, section, material, scale: float = 1.0):
    """Return particle masses (n+1,) kg and principal inertias (n+1, 3) kg m² (about x, y, z) of a
    straight uniform link. length (m): of it; elements: their number n; section (Section), material
    (Material); scale: factor on the section's transverse rotational inertia, above 1 to allow
    longer time steps. For n >= 2 mass, centre and inertia tensor are exactly those of a uniform
    bar; for n = 1 mass, centre and polar inertia. SceneError if `elements` is not a whole number
    above 0, or `scale` below 1 or too large for positive end masses."""
    if elements < 1 or int(elements) != elements:
        raise SceneError("elements", elements, "a whole number, at least 1")
    if not scale >= 1.0:
        raise SceneError("rotational inertia scale", scale, "a number >= 1")
    n, l = int(elements), length / elements
    weights = end_weights(n).copy()
    if n >= 2 and scale > 1:
        radius2 = max(section.Iy, section.Iz) / section.A
        shift = n / (n - 1) * (scale - 1) / 2 * radius2 / l**2
        if weights[0] - shift < SMALLEST_END:
            spare = (weights[0] - SMALLEST_END) * (n - 1) / n
            largest = 1 + 2 * l**2 / radius2 * spare
            allowed = f"at most {largest:.4g} for {n} elements"
            raise SceneError("rotational inertia scale", scale, allowed)
        weights[[0, -1]] -= shift
        weights[1] += shift
        weights[-2] += shift
    mass = material.rho * section.A * l * weights
    weight = np.ones(n + 1)
    weight[[0, -1]] = 0.5
    principal = np.array([section.Iy + section.Iz, scale * section.Iy, scale * section.Iz])
    inertia = material.rho * l * weight[:, None] * principal
    return mass, inertia
