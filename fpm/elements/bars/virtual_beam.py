"""Virtual beams: rigid, massless arms from a particle to a point off the link's axis.

They carry the size of the section: the hinge line of a thick link lies on an edge of its end face,
not on its axis. The paper uses stiff beam elements; the limit of infinite stiffness is taken here,
because it costs no element and does not shorten the stable step.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class VirtualBeam:
    """Rigid offset from a particle: its index, and a vector `arm` (3,), m, in its own frame."""

    particle: int
    arm: np.ndarray

    @staticmethod
    def to_point(particle: int, position, frame, point) -> "VirtualBeam":
        """The virtual beam from a particle to a point. particle: index; position (3,) m; frame (3,
        3): the particle's axes as columns; point (3,) m, in global axes like the position."""
        return VirtualBeam(particle, np.asarray(frame).T @ (np.asarray(point) - position))
