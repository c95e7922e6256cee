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

AXES = "xyz"


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


def check_held(hinge: Hinge, fixed: np.ndarray) -> None:
    """SceneError for supports that would leave a hinge impulses which move nothing.

    fixed (n, 6): axes along and about which each particle is held. The matrix of the hinge's
    impulses is regular, whatever arms and axis are and become, if no axis is held for both
    particles, nor for a particle and the hinge point, and one of the two may turn.
    """
    names = np.array(list(AXES))
    for p in hinge.particles:
        held = "".join(names[fixed[p, 3:]])
        if 0 < len(held) < 3:
            raise SceneError(
                f"rotations of particle {p} of hinge {hinge.name} that are held", held,
                "'' or 'xyz': hold the particle at the other end of its element instead",
            )  # fmt: skip
    one, two = fixed[list(hinge.particles)]
    common = "".join(names[one[:3] & two[:3]])
    if common:
        raise SceneError(
            f"axes along which both particles of hinge {hinge.name} are held", common,
            "'': hold one of the two, the hinge holds the other",
        )  # fmt: skip
    if one[3:].all() and two[3:].all():
        raise SceneError(
            f"particles of hinge {hinge.name} whose rotations are held", hinge.particles,
            "at most one of the two",
        )  # fmt: skip
    common = "".join(names[(one[:3] | two[:3]) & np.isin(names, list(hinge.support))])
    if common:
        raise SceneError(
            f"support of hinge {hinge.name}", hinge.support,
            f"axes along which neither of its particles is held (these are: {common})",
        )  # fmt: skip


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
