"""Releases: hinges that are held until a time, or until another hinge has opened so far.

Until then a release has the moment k (hold - psi) - c psi' of a spring and a damper; from then on
it has none. What its spring has stored at that moment is lost, as that of a bolt that is cut.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Energy
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    OnHinge,
    Opening,
    check_hinge,
    check_numbers,
    check_stiffness,
    pack_past,
)
from fpm.errors import SceneError


@dataclass(frozen=True)
class Release(OnHinge):
    """Holds a hinge of that index at the opening `hold` (rad).

    stiffness (N m/rad); damping (N m s/rad). It lets go at `time` (s), or where the opening of the
    hinge `watch` (-1: none) passes `level` (rad), at the first of both.
    """

    hinge: int
    stiffness: float
    damping: float
    hold: float
    time: float = np.inf
    watch: int = -1
    level: float = 0.0

    stores = Energy("release", "release_energy", "energy of the releases that hold")
    takes = JOINT_LOSS
    events = ("releases",)
    acts_as = "release"
    called = "release"

    def check(self, scene):
        """Hinges and numbers; that it holds at the start, and may let go."""
        check_stiffness(scene, "release", self.hinge, self.stiffness)
        name = check_letting_go(scene, self)
        check_numbers(name, scene, self.hinge, damping=(self.damping, 0.0, "N m s/rad"))
        if not np.isfinite(self.hold):
            raise SceneError(f"hold of {name}", self.hold, "a finite number")

    def topology(self):
        """Both hinges."""
        return self.hinge, self.watch

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.release_kernels import RELEASE, STATE, Releases

        found = cls.of(batch.one)
        return Releases(
            on=batch.integers(x.hinge for x in found),
            watch=batch.integers(x.watch for x in found),
            releases=batch.table(
                cls, RELEASE, lambda x: [x.stiffness, x.damping, x.hold, x.time, x.level]
            ),
            past=pack_past(batch, cls),
            now=batch.blank(len(found), STATE),
            openings=Opening.seen_by(cls, batch),
            account=batch.taken_by(cls),
            rows=batch.rows_of(cls),
            log=batch.log_of(cls),
        )


def check_letting_go(scene, release) -> str:
    """What a release of either kind is called; SceneError unless it may let go, as its hinge's only
    one.
    """
    name = f"release {scene.hinges[release.hinge].name}"
    what = f"of {name}"
    release.check_alone(scene)
    if not np.isfinite(release.level):
        raise SceneError(f"level {what}", release.level, "a finite number")
    if not release.time > 0:
        raise SceneError(f"time {what}", release.time, "above 0 s")
    if release.watch < 0 and not np.isfinite(release.time):
        raise SceneError(f"time {what}", release.time, "a finite time (s), or a hinge to watch")
    if release.watch >= 0:
        check_hinge(scene, "release to watch", release.watch)
        off = abs(scene.hinges[release.watch].opening - release.level)
        if not off > 1e-9:
            allowed = "an opening that the other hinge does not have at the start"
            raise SceneError(f"level {what}", release.level, allowed)
    return name
