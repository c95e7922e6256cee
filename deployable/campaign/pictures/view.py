"""Directions from which a structure is seen, in parallel projection."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class View:
    """A direction from the structure to the eye: `azimuth`, degrees from x about z, and
    `elevation`, degrees above the plane x, y. Pictures are parallel projections along it."""

    azimuth: float = -60.0
    elevation: float = 22.0

    @cached_property
    def page(self) -> np.ndarray:
        """Unit vectors (2, 3) right and up in the picture; `page @ position` projects onto it."""
        a = np.radians(self.azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, np.cross(self.direction, right)])

    @cached_property
    def direction(self) -> np.ndarray:
        """Unit vector (3) from the structure to the eye."""
        a, e = np.radians([self.azimuth, self.elevation])
        return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def nice_length(limit: float) -> float:
    """Round a length, `limit` above 0, down to 1, 2 or 5 times a power of ten, for a scale."""
    power = 10.0 ** np.floor(np.log10(limit))
    steps = [step for step in (1.0, 2.0, 5.0) if step * power <= limit * (1 + 1e-9)]
    return float(max(steps) * power)
