"""Releases: hinges held until a time, until another hinge has opened so far, or a latch has caught.

Until then a release has the moment k (hold - psi) - c psi' of a spring and a damper; from then on
it has none. What its spring has stored at that moment is lost, as that of a bolt that is cut."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpm.elements.fields import damping, index, number, stiffness, topology
from fpm.elements.kind import Energy
from fpm.elements.openings.latch import AnyLatch, Latch
from fpm.elements.openings.opening import JOINT_LOSS, Connector, on_hinge
from fpm.errors import SceneError


class AnyRelease(Connector):
    """Base class of releases, also rigid: they hold a hinge and let go at a `time` (s), or before
    that when the opening of another (index `watch`, -1: none) passes `level` (rad, m), or when the
    latch that is called `latch` ("": none) catches."""

    time: Any
    watch: Any
    level: Any
    latch: Any
    takes = JOINT_LOSS
    events = ("releases",)
    acts_as = "release"
    noun = "release"
    resists_as = ""

    def check(self, scene):
        """Check that the release has a finite time or watches a latch or a hinge of `scene`, not at
        the level at the start, and that its hinge has no other one; raises SceneError if not."""
        super().check(scene)
        self.check_alone(scene)
        title = self.title(scene)
        if self.watch < 0 and not self.latch and not np.isfinite(self.time):
            allowed = "a finite time (s), or a hinge or latch to watch"
            raise SceneError(f"time of {title}", self.time, allowed)
        if self.watch >= 0 and not abs(scene.hinges[self.watch].opening - self.level) > 1e-9:
            allowed = "an opening that the other hinge does not have at the start"
            raise SceneError(f"level of {title}", self.level, allowed)
        if self.latch and self.latch not in (labels := latch_rows(scene)):
            allowed = f"a latch of the scene: {', '.join(labels) or 'there is none'}"
            raise SceneError(f"latch watched by {title}", self.latch, allowed)

    @classmethod
    def array(cls, name, batch):
        """Return the array for a field of the named tuple that the type's kernels take. name: of
        the field: "latch_rows": of the latch watched by each, in the states of latches and rigid
        latches (n, 2), -1: not there; "latches", "rigid_latches": these states, None where none of
        them is watched; others as Connector.array. batch: the scenes simulated side by side."""
        rows = latch_rows(batch.scene)
        rows = [rows.get(release.latch, (-1, -1)) for release in cls.find(batch.scene)]
        if name == "latch_rows":
            return batch.integers(rows, 2)
        if name not in (names := ("latches", "rigid_latches")):
            return super().array(name, batch)
        is_watched = max(row[names.index(name)] for row in rows) >= 0
        kinds = [k for k in batch.kinds if issubclass(k, AnyLatch)] if is_watched else ()
        states = [batch.part(k).state for k in kinds if (k is Latch) == (name == "latches")]
        return states[0] if states else None


def latch_rows(scene) -> dict[str, tuple[int, int]]:
    """Return, of each latch of a scene by its name, the index among those with a spring and among
    rigid ones, -1 where it is the other."""
    kinds = [kind for kind in scene.kinds if issubclass(kind, AnyLatch)]
    return {
        latch.label(scene): (i, -1) if kind is Latch else (-1, i)
        for kind in kinds
        for i, latch in enumerate(kind.find(scene))
    }


@dataclass(frozen=True)
class Release(AnyRelease):
    """Release that holds a hinge or slide by a spring and a damper, and then lets go. hinge: index;
    stiffness (N m/rad; N/m on a slide), damping (N m s/rad; N s/m), hold: opening (joint
    coordinate, rad; m) at which its spring has no moment; time: when it lets go (s), infinite: by
    `watch` only; watch: index of a hinge or slide (-1: none) whose opening frees it when it passes
    `level` (rad; m), if that is earlier; latch: name of a latch ("": none) whose catch frees it."""

    hinge: int = on_hinge()
    stiffness: float = stiffness(text="with which it holds")
    damping: float = damping(text="with which it holds")
    hold: float = number("rad", text="opening at which it holds")
    time: float = number("s", above=0.0, finite=False, default=np.inf, text="when it releases")
    watch: int = index("hinges", -1, words="hinge of release to watch", default=-1)
    level: float = number("rad", default=0.0, is_shown=False)
    latch: str = topology("")

    stores = Energy("release", "release_energy", "energy of the releases that hold")
