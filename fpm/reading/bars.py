"""Bars of a scene: their elements in a row, and the forces in their sections.

Forces and moments in a section are those of the part beyond on the part before, along the axes of
the section: x along the bar, y across the section's width, z along its height. At the ends of an
element they are its end force F_a and moments M_a, -M_b, gradient of its energy (theory:
elements/bars/beam.py), along the particles' axes there; between, components are linear.

Stresses: docs/responses.md (Timoshenko, Strength of Materials II, § 83). Round sections are exact
at any point; rectangles at corners, and at the middles of the sides by the series of Timoshenko and
Goodier, Theory of Elasticity, § 109; others are as the rectangle with the same radii of gyration,
mostly too large."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.assembly.elastic import elastic_of
from fpm.elements.bars.beam import Beams, Section
from fpm.scenes.scene import Scene

FORCES = ("axial", "shear_y", "shear_z")
MOMENTS = ("torsion", "bending_y", "bending_z")
"""Components of forces and moments in a section, in the order of the axes."""


class Bar(NamedTuple):
    """A bar (beam member) of a scene. name: its name; groups: its beam elements in groups (Beams)
    of one section and material each, in order from its start to its end."""

    name: str
    groups: tuple[Beams, ...]

    @property
    def particles(self) -> list[int]:
        """Indices of all particles of the bar, increasing."""
        return sorted({int(p) for beams in self.groups for p in beams.nodes.ravel()})

    @property
    def ends(self) -> np.ndarray:
        """Distances (m,), in m, of its m elements' far ends from the bar's start, undeformed."""
        return np.cumsum(np.concatenate([beams.length for beams in self.groups]))


class Sections(NamedTuple):
    """Section forces and moments of a bar's m elements at t instants: `force` (N) and `moment` (N
    m), each (t, m, 2, 3): at both ends, along and about the section's axes (x along the bar, y, z),
    by the part of the bar beyond the section on the part before it."""

    force: np.ndarray
    moment: np.ndarray


def bar_of(name: str) -> str:
    """Return the name of the bar to which a beam element, or group of them between two points,
    belongs. name: theirs: "panel from knee[3]" is of the bar "panel", "AB[0]" of "AB"."""
    return name.rsplit("[", 1)[0].partition(" from ")[0]


def bars_of(scene: Scene) -> dict[str, Bar]:
    """Return the bars (Bar) of a scene by name, with all groups of elements in order."""
    groups: dict[str, list[Beams]] = {}
    for beams in scene.beams:
        groups.setdefault(bar_of(beams.name), []).append(beams)
    return {name: Bar(name, tuple(group)) for name, group in groups.items()}


def ends_of(scene: Scene, beams: Beams, place, axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return, for the start and the end of m beam elements, positions (t, m, 3) m, and global axes
    y and z (t, m, 3, 2) of the sections. place(particle), axes(particle): positions (t, 3) m and
    frames (t, 3, 3) at t instants (`Recording`)."""
    start, ends = scene.frame if scene.unstrained is None else scene.unstrained, []
    for nodes, square in zip(beams.nodes.T, beams.end_axes(), strict=True):
        frames = np.stack([axes(int(p)) for p in nodes], axis=1)
        section_axes = frames @ (start[nodes].transpose(0, 2, 1) @ square)
        ends.append((np.stack([place(int(p)) for p in nodes], axis=1), section_axes))
    return ends


def sections(scene: Scene, beams: Beams, place, axes) -> Sections:
    """Return forces and moments (t, m, 2, 3), N and N m, at both ends of `beams`, m elements, in
    the section's axes. place, axes: as in `ends_of`."""
    ends = [
        ParticlePoses(*(np.stack([read(int(p)) for p in nodes], axis=1) for read in (place, axes)))
        for nodes in beams.nodes.T
    ]
    loads = np.split(elastic_of(scene, [beams]).gradient(*ends), 4, axis=-1)
    start = scene.frame if scene.unstrained is None else scene.unstrained
    end_values = []
    for nodes, end, moment in zip(beams.nodes.T, ends, (-loads[1], loads[3]), strict=True):
        section = end.frame @ (start[nodes].transpose(0, 2, 1) @ beams.triad)
        end_values.append([np.einsum("tmk,tmki->tmi", v, section) for v in (loads[2], moment)])
    return Sections(*(np.stack(values, axis=2) for values in zip(*end_values, strict=True)))


def sections_of(scene: Scene, bar: Bar, place, axes) -> Sections:
    """Return forces and moments in the sections of all elements of a bar; place(particle),
    axes(particle): positions (t, 3) m and frames (t, 3, 3) of a particle (index) at t instants."""
    groups = [sections(scene, beams, place, axes) for beams in bar.groups]
    return Sections(*(np.concatenate(arrays, axis=1) for arrays in zip(*groups, strict=True)))


def at_fraction(bar: Bar, sections: Sections, fraction: float) -> tuple[np.ndarray, np.ndarray]:
    """Return force (t, 3) N and moment (t, 3) N m in a section of a bar, in its axes, linear
    between the ends of an element; where two elements meet, the mean of both. sections: the bar's,
    of `sections_of`; fraction: position of the section, 0 (the bar's start) to 1."""
    ends = bar.ends
    lengths = np.diff(ends, prepend=0.0)
    position = fraction * ends[-1]
    margin = 1e-9 * ends[-1]
    elements = np.flatnonzero((position <= ends + margin) & (position >= ends - lengths - margin))
    parts = np.clip((position - ends[elements] + lengths[elements]) / lengths[elements], 0.0, 1.0)
    weights = np.stack([1.0 - parts, parts], axis=1) / len(elements)
    force, moment = (np.einsum("teki,ek->ti", values[:, elements], weights) for values in sections)
    return force, moment


def half_sizes(section: Section) -> tuple[float, float]:
    """Return half width (along y) and half height (along z), m, of a bar's section; for an unknown
    outline, of the rectangle with its radii of gyration."""
    if section.outline:
        return section.width / 2, section.height / 2
    return tuple(np.sqrt(3.0 * np.array([section.Iz, section.Iy]) / section.A))


def torsion_stresses(width: float, height: float, J: float) -> tuple[float, float]:
    """Return the two largest shear stresses per torque (Pa/(N m)) of a solid rectangular section:
    at its mid-sides y = ±width/2, and z = ±height/2. width, height: m; J: torsion constant (m⁴)."""
    a, b = sorted((width / 2, height / 2))
    n = np.arange(1, 60, 2)
    argument = np.minimum(n * np.pi * b / (2 * a), 500.0)  # beyond, cosh overflows
    at_long = 2 * a * (1 - 8 / np.pi**2 * np.sum(1 / (n**2 * np.cosh(argument))))
    signs = (-1.0) ** ((n - 1) // 2)
    at_short = 16 * a / np.pi**2 * np.sum(signs * np.tanh(argument) / n**2)
    # The long sides are a away from the middle.
    stresses = (at_long, at_short) if width <= height else (at_short, at_long)
    return stresses[0] / J, stresses[1] / J


def equivalent(section: Section, force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the largest equivalent stress (...), Pa (von Mises), of force and moment (..., 3), N
    and N m, in a section's axes: on the contour of round ones, corners and mid-sides of rectangles,
    else corners of the rectangle of `half_sizes`; transverse forces are left out."""
    normal = np.abs(force[..., 0]) / section.A
    torque, about_y, about_z = np.abs(np.moveaxis(moment, -1, 0))
    y, z = half_sizes(section)
    if section.outline == "round":
        bending = y * np.hypot(about_y / section.Iy, about_z / section.Iz)
        return von_mises(normal + bending, torque * y / section.J)
    by_y, by_z = about_y * z / section.Iy, about_z * y / section.Iz
    corner = normal + by_y + by_z
    if not section.outline:
        return von_mises(corner, torque * np.hypot(y, z) / section.J)
    at_y, at_z = torsion_stresses(section.width, section.height, section.J)
    sides = von_mises(normal + by_z, torque * at_y), von_mises(normal + by_y, torque * at_z)
    return np.maximum(corner, np.maximum(*sides))


def von_mises(normal: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Return the equivalent stress (Pa) by von Mises of normal and shear stress (...), Pa."""
    return np.sqrt(normal**2 + 3.0 * shear**2)


def element_stress(scene: Scene, groups: Iterable[Beams], place, axes) -> np.ndarray:
    """Return the largest equivalent stress (t, m) Pa (von Mises) at either end of all groups' m
    beam elements, in order; place(i), axes(i): positions (t, 3), frames (t, 3, 3) of particle i."""
    stresses = []
    for beams in groups:
        force, moment = sections(scene, beams, place, axes)
        stresses.append(equivalent(beams.section, force, moment).max(axis=2))
    return np.concatenate(stresses, axis=1)
