"""A structure as solid bodies in space, for pictures and for other programs."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fpm.reading.bars import bar_of
from fpm.solver.motion import section_corners, shapes_of, strands_of

FACES = np.array([
    (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7),  # along the element
    (0, 3, 2, 1), (4, 5, 6, 7),  # at its two ends
])  # fmt: skip
"""Of an element: its faces as indices into its eight corners, outward by the right-hand rule."""


@dataclass(frozen=True)
class CablePoints:
    """The p points through which c cables run, one cable after the other. cable (p): index of the
    point's cable; particle (p): index of the particle that carries the point; arm (p, 3): from that
    particle to the point, in its rotating frame (m); tension (T, c): of each cable at T moments
    (N), None where it is not known."""

    cable: np.ndarray
    particle: np.ndarray
    arm: np.ndarray
    tension: Any = None

    @cached_property
    def stretches(self) -> np.ndarray:
        """Indices (s, 2), among the p points, of both ends of each straight stretch of a cable."""
        first = np.flatnonzero(self.cable[1:] == self.cable[:-1])
        return np.stack([first, first + 1], axis=1)


NO_CABLES = CablePoints(np.zeros(0, int), np.zeros(0, int), np.zeros((0, 3)))


@dataclass(frozen=True)
class Solid:
    """The m elements of a structure with n particles at T moments, each a hexahedron. nodes (m, 2):
    particles at its ends; sections (m, 2, 4, 3): corners from the particle, in its frame (m);
    position (T, n, 3); frame (T, n, 3, 3): rotation matrices; elements (m): names."""

    nodes: np.ndarray
    sections: np.ndarray
    position: np.ndarray
    frame: np.ndarray
    elements: tuple[str, ...]
    cables: CablePoints = NO_CABLES

    @cached_property
    def cable_points(self) -> np.ndarray:
        """Positions (T, p, 3) of the cables' points (m) at each moment."""
        particle, arm = self.cables.particle, self.cables.arm
        return self.position[:, particle] + np.einsum("tpij,pj->tpi", self.frame[:, particle], arm)

    @cached_property
    def places(self) -> np.ndarray:
        """Positions (T, k, 3) (m) that a picture must hold at each moment: the k corners of all
        elements and points of cables; without elements those of the particles."""
        count = len(self.position)
        points = [self.corners.reshape(count, -1, 3), self.cable_points]
        return np.concatenate(points, axis=1) if len(self.nodes) else self.position

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners (T, m, 8, 3) of the elements (m): four at the first end, then at the second."""
        offsets = np.einsum("tmeij,mecj->tmeci", self.frame[:, self.nodes], self.sections)
        corners = offsets + self.position[:, self.nodes, None, :]
        return corners.reshape(len(corners), len(self.nodes), 8, 3)

    @cached_property
    def bar(self) -> np.ndarray:
        """Number (m) of the bar, such as `AB`, that each element, such as `AB[3]`, belongs to."""
        names = [*map(bar_of, self.elements)]
        numbers = {name: number for number, name in enumerate(dict.fromkeys(names))}
        return np.array([numbers[name] for name in names], dtype=int)

    @cached_property
    def visible(self) -> np.ndarray:
        """Mask (m, 6) of the elements' faces that can be seen from outside, four sides, then two
        ends (the order of FACES); False for ends that the next element of the bar covers."""
        stretches = np.array([name.rsplit("[", 1)[0] for name in self.elements])
        is_joined = stretches[1:] == stretches[:-1]
        is_joined &= self.nodes[1:, 0] == self.nodes[:-1, 1]
        mask = np.ones((len(self.nodes), len(FACES)), bool)
        mask[1:, 4] = ~is_joined
        mask[:-1, 5] = ~is_joined
        return mask


def solid_of_motion(motion: Any, frames: Any = slice(None)) -> Solid:
    """Make the `Solid` of a whole motion (`fpm.solver.motion`) at some frames."""
    cables = NO_CABLES
    if "cable_point_cable" in motion.variables:
        keys = ("cable", "particle", "arm")
        cable, particle, arm = (values_in(motion, f"cable_point_{key}") for key in keys)
        cables = CablePoints(cable, particle, arm, values_in(motion, "cable_tension")[frames])
    return Solid(
        nodes=values_in(motion, "element_particle"),
        sections=values_in(motion, "section_corner"),
        position=values_in(motion, "position")[frames],
        frame=values_in(motion, "frame")[frames],
        elements=tuple(map(str, values_in(motion, "element"))),
        cables=cables,
    )


def values_in(motion: Any, name: str) -> np.ndarray:
    """Read the variable `name` of an open dataset (`xarray` or `netCDF4`) as a numpy array."""
    return np.asarray(motion.variables[name][:])


def solid_of_scene(scene: Any) -> Solid:
    """Make the `Solid` (hexahedra) of a structure, an `fpm.Scene`, where it starts: one moment."""
    shapes = shapes_of(scene, section_corners(scene))
    beams = [(i, beam) for i, line in enumerate(strands_of(scene)) for beam in line.beams]
    return Solid(
        nodes=shapes.nodes,
        sections=shapes.corners,
        position=scene.position[None],
        frame=scene.frame[None],
        elements=tuple(shapes.names),
        cables=CablePoints(
            np.array([i for i, _ in beams], int),
            np.array([beam.particle for _, beam in beams], int),
            np.array([beam.arm for _, beam in beams]).reshape(-1, 3),
        ),
    )
