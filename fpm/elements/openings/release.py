"""Releases: hinges held until a time, until another hinge has opened so far, or a latch has caught.

Theory: docs/mechanics.md, "Loops, motors and releases". What its spring has stored at that moment
is lost, as that of a bolt that is cut."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import damping, index, number, stiffness, topology
from fpm.elements.joints.turn import ExactConnector
from fpm.elements.kind import Energy
from fpm.elements.openings.latch import Latch
from fpm.elements.openings.opening import JOINT_LOSS, on_hinge
from fpm.errors import SceneError


@dataclass(frozen=True)
class Release(ExactConnector):
    """Release that holds a hinge or slide by a spring and a damper, or exactly, and then lets go.
    It does so at `time`, and earlier where the hinge or slide `watch` (-1: none) passes `level`, or
    the latch of the name `latch` ("": none) catches."""

    hinge: int = on_hinge()
    stiffness: float | None = stiffness(
        default=None, text="stiffness with which it holds; default: it holds exactly"
    )
    damping: float = damping(default=0.0, text="damping with which it holds")
    hold: float | None = number(
        "rad", default=None, text="opening at which it holds; default: that at the start"
    )
    time: float = number("s", above=0.0, finite=False, default=np.inf, text="time of the release")
    watch: int = index("hinges", -1, words="hinge of release to watch", default=-1)
    level: float = number("rad", default=0.0, is_shown=False)
    latch: str = topology("")

    stores = Energy("release", "release_energy", "energy of the releases that hold")
    takes = JOINT_LOSS
    events = ("releases",)
    acts_as = "release"
    noun = "release"

    def check(self, scene):
        super().check(scene)
        self.check_alone(scene)
        title = self.title(scene)
        if (self.hold is None) != self.is_exact:
            allowed = "an opening (rad), with a stiffness, and else the one at the start"
            raise SceneError(f"hold of {title}", self.hold, allowed)
        if self.watch < 0 and not self.latch and not np.isfinite(self.time):
            allowed = "a finite time (s), or a hinge or latch to watch"
            raise SceneError(f"time of {title}", self.time, allowed)
        if self.watch >= 0 and not abs(scene.hinges[self.watch].opening - self.level) > 1e-9:
            allowed = "an opening that the other hinge does not have at the start"
            raise SceneError(f"level of {title}", self.level, allowed)
        latches = Latch.find(scene)
        if any(x.is_exact and x.hinge == self.watch and x.angle == self.level for x in latches):
            allowed = "an opening at which no latch holds the other hinge; watch that latch instead"
            raise SceneError(f"level of {title}", self.level, allowed)
        labels = [latch.label(scene) for latch in latches]
        if self.latch and self.latch not in labels:
            allowed = f"a joint, or a latch: {', '.join(labels) or 'there is none'}"
            raise SceneError(f"watch of {title}", self.latch, allowed)

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    def rate_at_start(self, scene):
        return 0.0

    @classmethod
    def array(cls, name, batch):
        """For "latch_row" -1, and for "latches" None where none is watched."""
        if name not in ("latch_row", "latches"):
            return super().array(name, batch)
        numbers = {latch.label(batch.scene): i for i, latch in enumerate(Latch.find(batch.scene))}
        rows = [numbers.get(release.latch, -1) for release in cls.find(batch.scene)]
        if name == "latch_row":
            return batch.integers(rows)
        return batch.part(Latch).state if max(rows) >= 0 else None
