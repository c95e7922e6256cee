"""Rigid releases: they hold a hinge at the opening that it has at the start until they let go.

As other releases (release.py), at a time or where another opening passes a level; but exactly
(turn.py), so that nothing is stored, and nothing lost where they let go.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.joints.turn import HoldsHinge, Turn
from fpm.elements.openings.opening import JOINT_LOSS, Opening, check_hinge
from fpm.elements.openings.release import check_letting_go


@dataclass(frozen=True)
class RigidRelease(HoldsHinge):
    """Holds a hinge of that index, until `time` (s), or until the opening of the hinge `watch` (-1:
    none) passes `level` (rad): the first of both.
    """

    hinge: int
    time: float = np.inf
    watch: int = -1
    level: float = 0.0

    takes = JOINT_LOSS
    events = ("releases",)
    acts_as = "release"
    called = "release"

    def check(self, scene):
        """Hinges and numbers; that it may let go."""
        check_hinge(scene, "release", self.hinge)
        check_letting_go(scene, self)

    def topology(self):
        """Both hinges."""
        return self.hinge, self.watch

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    def rate_at_start(self, scene):
        return 0.0

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints.rigid_release_kernels import STATE, RigidReleases
        from fpm.elements.openings.release_kernels import RELEASE

        found = cls.of(batch.one)
        none = [0.0] * 3  # stiffness, damping, and where it holds
        return RigidReleases(
            on=batch.integers(x.hinge for x in found),
            turn=batch.integers(Turn.places(batch.one, cls)),
            watch=batch.integers(x.watch for x in found),
            releases=batch.table(cls, RELEASE, lambda x: [*none, x.time, x.level]),
            openings=Opening.seen_by(cls, batch),
            turns=batch.part(Turn),
            state=batch.blank(len(found), STATE),
            account=batch.taken_by(cls),
            log=batch.log_of(cls),
        )
