"""Revolute hinges: two particles share a point and an axis, and turn freely about it.

The hinge point lies at the end of a virtual beam of either particle (virtual_beam.py). The five
conditions (three for the point, two for the axis) hold at the end of every step, by impulses found
from the positions there: SHAKE (Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327),
here for rigid arms and rotations. The impulses are equal and opposite, so momentum is kept, the
scheme stays symplectic, and no drift builds up. A hinge point may be held along global axes
(`support`), e.g. "z" lets it slide in a plane.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.virtual_beam import VirtualBeam
from fpm.errors import SceneError


@dataclass(frozen=True)
class Hinge:
    """A hinge between the free ends of two virtual beams.

    axes (2, 3): the axis in each particle's own frame; references (2, 3): directions normal to the
    axis, one in each frame, that coincide at opening 0; the opening grows when the second turns by
    the right-hand rule about the axis against the first. opening (rad): at the start, including
    full turns. support: global axes along which the hinge point is held.
    """

    name: str
    beams: tuple[VirtualBeam, VirtualBeam]
    axes: np.ndarray
    references: np.ndarray
    opening: float
    support: str

    @property
    def particles(self) -> tuple[int, int]:
        """Indices of the two particles."""
        return self.beams[0].particle, self.beams[1].particle


def unit(vector, what: str) -> np.ndarray:
    """The vector (3,) at length one; SceneError if it has none."""
    vector = np.asarray(vector, float)
    size = np.linalg.norm(vector)
    if not size > 0 or not np.isfinite(size):
        raise SceneError(what, vector.tolist(), "a finite vector that is not zero")
    return vector / size


def opening_angle(axis, first, second, near: float) -> float:
    """Angle (rad) from `first` to `second` about `axis`, on the turn closest to `near`."""
    angle = np.arctan2(np.dot(axis, np.cross(first, second)), np.dot(first, second))
    return float(angle + 2 * np.pi * np.round((near - angle) / (2 * np.pi)))
