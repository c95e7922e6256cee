"""A structure as solid bodies in space: what pictures paint and what other programs are given."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

FACES = np.array([
    (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7),  # along the element
    (0, 3, 2, 1), (4, 5, 6, 7),  # at its two ends
])  # fmt: skip
"""Of an element: its faces as indices into its eight corners, outward by the right-hand rule."""


@dataclass(frozen=True)
class Solid:
    """The elements of a structure at t moments, each a hexahedron between two sections.

    nodes (m, 2): particles at the elements' ends; sections (m, 2, 4, 3) m: corners of the sections
    there, in the particles' frames; position (t, n, 3) m and frame (t, n, 3, 3) of the particles;
    elements (m,): their names.
    """

    nodes: np.ndarray
    sections: np.ndarray
    position: np.ndarray
    frame: np.ndarray
    elements: tuple[str, ...]

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners (t, m, 8, 3) of the elements, m: four at the first end, four at the second."""
        turned = np.einsum("tmeij,mecj->tmeci", self.frame[:, self.nodes], self.sections)
        placed = turned + self.position[:, self.nodes, None, :]
        return placed.reshape(len(placed), len(self.nodes), 8, 3)

    @cached_property
    def bars(self) -> tuple[str, ...]:
        """Names of the bars: `link AB[3]` is an element of `link AB`."""
        return tuple(dict.fromkeys(_bar(name) for name in self.elements))

    @cached_property
    def bar(self) -> np.ndarray:
        """Index (m,) of each element's bar."""
        return np.array([self.bars.index(_bar(name)) for name in self.elements], dtype=int)

    @cached_property
    def visible(self) -> np.ndarray:
        """Which of the six faces of each element (m, 6) are not hidden by its neighbour's."""
        same = self.bar[1:] == self.bar[:-1]
        same &= self.nodes[1:, 0] == self.nodes[:-1, 1]
        shown = np.ones((len(self.nodes), len(FACES)), bool)
        shown[1:, 4] = ~same
        shown[:-1, 5] = ~same
        return shown


def solid_of_motion(motion: xarray.Dataset) -> Solid:
    """The solid of a whole motion (`fpm.motion`), at all its frames."""
    return Solid(
        nodes=motion["element_particle"].values,
        sections=motion["section_corner"].values,
        position=motion["position"].values,
        frame=motion["frame"].values,
        elements=tuple(map(str, motion["element"].values)),
    )


def solid_of_scene(scene: Any) -> Solid:
    """The solid of an `fpm.Scene` as it stands at the start: one moment."""
    from fpm.motion import section_corners
    from fpm.motion_dataset import elements_of

    return Solid(
        nodes=elements_of(scene)[0],
        sections=section_corners(scene),
        position=scene.position[None],
        frame=scene.frame[None],
        elements=tuple(f"{b.name}[{i}]" for b in scene.beams for i in range(len(b.length))),
    )


def _bar(element: str) -> str:
    return element.rsplit("[", 1)[0]
