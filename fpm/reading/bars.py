"""Bars of a scene: their elements in a row, and the forces in their sections.

Forces and moments in a section are those of the part beyond on the part before, along the bar's own
axes there: x from start to end, y across the section's width, z along its height. They follow from
the positions and frames of particles (theory: elements/bars/beam.py): with c = dU/ds of either end,
the axial force is EA (l - l0)/l0, the shear (c_a + c_b)/l in both planes, the torsion GJ t/l0, and
bending goes straight from c_a to -c_b along an element (M_z; M_y has the opposite sign).
"""

from typing import NamedTuple

import numpy as np

from fpm.elements.bars.beam import Beams, Section
from fpm.scenes.scene import Scene

FORCES = ("axial", "shear_y", "shear_z")
MOMENTS = ("torsion", "bending_y", "bending_z")
"""Components of forces and moments in a section, in the order of the axes."""


class Bar(NamedTuple):
    """A bar's elements from start to end, as groups of one section and material."""

    name: str
    groups: tuple[Beams, ...]

    @property
    def particles(self) -> list[int]:
        """All of its particles."""
        return sorted({int(p) for beams in self.groups for p in beams.nodes.ravel()})

    @property
    def ends(self) -> np.ndarray:
        """Where its elements end (m,) m from its start, without strain."""
        return np.cumsum(np.concatenate([beams.length for beams in self.groups]))


class Sections(NamedTuple):
    """Forces (t, m, 3) N and moments at both ends (t, m, 2, 3) N m of a bar's elements."""

    force: np.ndarray
    moment: np.ndarray


def bar_of(name: str) -> str:
    """The bar of an element or of a stretch: `panel` of `panel from knee[3]`, `AB` of `AB[0]`."""
    return name.rsplit("[", 1)[0].partition(" from ")[0]


def bars_of(scene: Scene) -> dict[str, Bar]:
    """Bars by name. Stretches of a bar through several points are called "name from point"."""
    groups: dict[str, list[Beams]] = {}
    for beams in scene.beams:
        groups.setdefault(bar_of(beams.name), []).append(beams)
    return {name: Bar(name, tuple(found)) for name, found in groups.items()}


def ends_of(scene: Scene, beams: Beams, place, axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Of both ends of the elements of a group: positions (t, m, 3) m, and axes y and z of their
    sections as the particles there carry them (t, m, 3, 2). place(particle) gives positions (t, 3)
    m, axes(particle) frames (t, 3, 3)."""
    start, found = scene.frame if scene.unstrained is None else scene.unstrained, []
    for nodes, square in zip(beams.nodes.T, beams.end_axes(), strict=True):
        frames = np.stack([axes(int(p)) for p in nodes], axis=1)
        own = frames @ (start[nodes].transpose(0, 2, 1) @ square)
        found.append((np.stack([place(int(p)) for p in nodes], axis=1), own))
    return found


class Bends(NamedTuple):
    """How a group's elements are strained: lengths (t, m) m; at both ends the sines between chord
    and axes y and z (t, m, 2), the angles that count for them, and these axes (t, m, 3, 2)."""

    length: np.ndarray
    sines: list[np.ndarray]
    angles: list[np.ndarray]
    axes: list[np.ndarray]


def bends_of(scene: Scene, beams: Beams, place, axes) -> Bends:
    """Of the elements of a group; place and axes as for `ends_of`."""
    (first, *own), (second, *other) = ends_of(scene, beams, place, axes)
    chord, own = second - first, own + other
    length = np.linalg.norm(chord, axis=2)
    chord = chord / length[:, :, None]
    sines = [np.einsum("tmi,tmik->tmk", chord, each) for each in own]
    return Bends(length, sines, [s * (1.0 + s**2 / 6.0) for s in sines], own)


def sections(scene: Scene, beams: Beams, place, axes) -> Sections:
    """Of the elements of a group; place and axes as for `ends_of`."""
    _, axial, bend_z, bend_y, twist = beams.stiffness().T
    length, sines, angles, own = bends_of(scene, beams, place, axes)
    stiffness = np.stack([bend_z, bend_y], axis=1)
    ends = [
        stiffness * (2.0 * angles[k] + angles[1 - k]) * (1.0 + 0.5 * sines[k] ** 2) for k in (0, 1)
    ]
    turn = np.einsum("tmi,tmi->tm", own[1][..., 0], own[0][..., 1])
    turn = 0.5 * (turn - np.einsum("tmi,tmi->tm", own[1][..., 1], own[0][..., 0]))
    shear = (ends[0] + ends[1]) / length[:, :, None]
    force = np.stack([axial * (length - beams.length), shear[..., 0], shear[..., 1]], axis=2)
    torsion = twist * turn
    moments = [
        np.stack([torsion, -sign * ends[k][..., 1], sign * ends[k][..., 0]], axis=2)
        for k, sign in ((0, 1.0), (1, -1.0))
    ]
    return Sections(force, np.stack(moments, axis=2))


def sections_of(scene: Scene, bar: Bar, place, axes) -> Sections:
    """Of all elements of a bar."""
    found = [sections(scene, beams, place, axes) for beams in bar.groups]
    return Sections(*(np.concatenate(arrays, axis=1) for arrays in zip(*found, strict=True)))


def at_share(bar: Bar, found: Sections, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Force (t, 3) N and moment (t, 3) N m at a share of a bar's length, from 0 to 1.

    Where two elements meet it is their mean.
    """
    ends = bar.ends
    lengths = np.diff(ends, prepend=0.0)
    along = share * ends[-1]
    near = 1e-9 * ends[-1]
    touched = np.flatnonzero((along <= ends + near) & (along >= ends - lengths - near))
    force, moment = [], []
    for e in touched:
        part = np.clip((along - ends[e] + lengths[e]) / lengths[e], 0.0, 1.0)
        force.append(found.force[:, e])
        moment.append((1.0 - part) * found.moment[:, e, 0] + part * found.moment[:, e, 1])
    return np.mean(force, axis=0), np.mean(moment, axis=0)


def half_sizes(section: Section) -> tuple[float, float]:
    """Half width and half height (m); of an unknown outline those of the rectangle with the same
    area and second moments."""
    if section.outline:
        return section.width / 2, section.height / 2
    return tuple(np.sqrt(3.0 * np.array([section.Iz, section.Iy]) / section.A))
