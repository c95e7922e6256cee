"""Releases: hinges that are held until a time, or until another hinge has opened so far.

Until then a release has the moment k (hold - psi) - c psi' of a spring and a damper; from then on
it has none. What its spring has stored at that moment is lost, as that of a bolt that is cut."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.fields import damping, index, number, stiffness
from fpm.elements.kind import Energy
from fpm.elements.openings.opening import JOINT_LOSS, Connector, on_hinge
from fpm.errors import SceneError


class AnyRelease(Connector):
    """Base class of releases, also rigid: they hold a hinge and let go at a `time` (s), or before
    that when the opening of another (index `watch`, -1: none) passes `level` (rad, m)."""

    takes = JOINT_LOSS
    events = ("releases",)
    acts_as = "release"
    noun = "release"
    resists_as = ""

    def check(self, scene):
        """Check that the release has a finite time or watches a hinge of `scene` that is not at the
        level at the start, and that its hinge has no other release; raises SceneError if not."""
        super().check(scene)
        self.check_alone(scene)
        title = self.title(scene)
        if self.watch < 0 and not np.isfinite(self.time):
            allowed = "a finite time (s), or a hinge to watch"
            raise SceneError(f"time of {title}", self.time, allowed)
        if self.watch >= 0 and not abs(scene.hinges[self.watch].opening - self.level) > 1e-9:
            allowed = "an opening that the other hinge does not have at the start"
            raise SceneError(f"level of {title}", self.level, allowed)


@dataclass(frozen=True)
class Release(AnyRelease):
    """Release that holds a hinge or slide by a spring and a damper, and then lets go. hinge: index;
    stiffness (N m/rad; N/m on a slide), damping (N m s/rad; N s/m), hold: opening (joint
    coordinate, rad; m) at which its spring has no moment; time: when it lets go (s), infinite: by
    `watch` only; watch: index of a hinge or slide (-1: none) whose opening frees it when it passes
    `level` (rad; m), if that is earlier."""

    hinge: int = on_hinge()
    stiffness: float = stiffness(text="with which it holds")
    damping: float = damping(text="with which it holds")
    hold: float = number("rad", text="opening at which it holds")
    time: float = number("s", above=0.0, finite=False, default=np.inf, text="when it releases")
    watch: int = index("hinges", -1, words="hinge of release to watch", default=-1)
    level: float = number("rad", default=0.0, is_shown=False)

    stores = Energy("release", "release_energy", "energy of the releases that hold")
