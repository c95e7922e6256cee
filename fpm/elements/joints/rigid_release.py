"""Rigid releases: they hold a hinge at the opening that it has at the start until they let go.

As other releases (release.py), at a time or where another opening passes a level; but exactly
(turn.py), so that nothing is stored, and nothing lost where they let go.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.fields import index, number
from fpm.elements.joints.turn import HoldsHinge
from fpm.elements.openings.opening import on_hinge
from fpm.elements.openings.release import AnyRelease


@dataclass(frozen=True)
class RigidRelease(AnyRelease, HoldsHinge):
    """Holds a hinge exactly, until it lets go."""

    hinge: int = on_hinge()
    time: float = number("s", above=0.0, finite=False, default=np.inf)
    watch: int = index("hinges", -1, words="hinge of release to watch", default=-1)
    level: float = number("rad", default=0.0, said=False)

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    def rate_at_start(self, scene):
        return 0.0
