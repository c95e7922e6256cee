"""Virtual beams: rigid, massless arms from a particle to a point off the link's axis.

They carry the size of the section: the hinge line of a thick link lies on an edge of its end face,
not on its axis. The paper uses stiff beam elements; the limit of infinite stiffness is taken here,
because it costs no element and does not shorten the stable step."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class VirtualBeam:
    """Rigid, massless arm from a particle to a point, as of a joint. particle: index; arm (3,), m:
    vector to the point, in the particle's own axes."""

    particle: int
    arm: np.ndarray

    @staticmethod
    def to_point(particle: int, position, frame, point) -> "VirtualBeam":
        """Return the rigid arm from a particle to a point, by global coordinates. particle: index;
        position (3,) m and frame (3, 3), axes as columns: of the particle now; point (3,) m."""
        return VirtualBeam(particle, np.asarray(frame).T @ (np.asarray(point) - position))
