"""Synchronising loops: closed cables over pulleys on two hinges, so that these open together.

With pulleys of radii r1 and r2 on the hinges, one strand becomes longer by the slip

    e = r1 (psi1 - rest1) - r2 (psi2 - rest2)

and the other shorter. Both strands are preloaded with P and have the stiffness EA/l each; together
they pull at the rims with k e, k = 2 EA/l, and store k e²/2, until one of them is slack, where the
pull is 2 P. Beyond, the other one is alone, with k/2.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Deformations, Energy, Kind, Recorded
from fpm.elements.openings.opening import (
    TURNING,
    Opening,
    check_hinge,
    check_stiffness,
    relative_turn,
    softness,
)
from fpm.errors import SceneError


@dataclass(frozen=True)
class SyncLoop(Kind):
    """A loop over two hinges.

    hinges: indices of two; radii (m) of the pulleys on them, opposite in sign where the loop is
    crossed; stiffness k (N/m) of both strands together; rest: openings (rad) without slip; preload
    P (N) of a strand: without it, none ever gets slack.
    """

    name: str
    hinges: tuple[int, int]
    radii: tuple[float, float]
    stiffness: float
    rest: tuple[float, float] = (0.0, 0.0)
    preload: float = np.inf

    stores = Energy("loop", "loop_energy", "energy of the synchronising loops")
    events = ("tightens", "slackens")
    reads = (Opening,)
    acts_as = "loop"

    def check(self, scene):
        """Hinges, radii and numbers; names are for messages and files."""
        what = f"loop {self.name}"
        if self.name in [other.name for other in SyncLoop.of(scene)]:
            raise SceneError("loop", self.name, "a name that no other loop has")
        for hinge in self.hinges:
            check_hinge(scene, what, hinge, TURNING)
            check_stiffness(scene, what, hinge, self.stiffness, "N/m")
        if len(set(self.hinges)) != 2:
            raise SceneError(f"hinges of {what}", self.hinges, "two different ones")
        if not (np.isfinite(self.radii).all() and np.all(self.radii)):
            raise SceneError(f"radii of {what}", self.radii, "finite lengths (m) other than 0")
        if not np.isfinite(self.rest).all():
            raise SceneError(f"rest of {what}", self.rest, "finite openings (rad)")
        if not self.preload >= 0:
            raise SceneError(f"preload of {what}", self.preload, "a tension >= 0 (N)")

    def acts_on(self):
        return self.hinges

    def topology(self):
        """Name and hinges."""
        return self.name, self.hinges

    @property
    def tight(self) -> float:
        """The slip (m) up to which both strands are tight."""
        return 2 * self.preload / self.stiffness if self.stiffness > 0 else np.inf

    @classmethod
    def names(cls, scene):
        return [f"loop {loop.name}" for loop in cls.of(scene)]

    @classmethod
    def deformations(cls, scene):
        """A spring on each hinge, which together bound the loop.

        By Cauchy and Schwarz (r1 psi1 - r2 psi2)² <= r1² psi1²/s1 + r2² psi2²/s2 with s1 + s2 = 1;
        with shares as r² w, w being the softness of each hinge, nothing is lost where the hinges
        share no body.
        """
        on, stiffness, element = [], [], []
        for number, loop in enumerate(cls.of(scene)):
            soft = [softness(scene, hinge) for hinge in loop.hinges]
            total = sum(r**2 * w for r, w in zip(loop.radii, soft, strict=True))
            for hinge, w in zip(loop.hinges, soft, strict=True):
                if w > 0:
                    on.append(hinge)
                    stiffness.append(loop.stiffness * total / w)
                    element.append(number)
        if not on:
            return None
        rows = relative_turn(scene, on, stiffness)
        return Deformations(*rows[:3], np.array(element)[rows.element])

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.sync_loop_kernels import LOOP, STATE, Loops

        loops = cls.of(batch.one)
        return Loops(
            on=batch.integers((loop.hinges for loop in loops), 2),
            loops=batch.table(cls, LOOP, lambda x: [x.stiffness, *x.radii, *x.rest, x.tight]),
            now=batch.blank(len(loops), STATE),
            openings=Opening.seen_by(cls, batch),
            rows=batch.rows_of(cls),
            log=batch.log_of(cls),
            track=batch.blank((batch.instants + 1) * len(loops), 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """The pulls, difference of the tensions of both strands."""
        names = tuple(loop.name for loop in cls.of(scene))
        values = part.track[:, 0, lane].reshape(-1, len(names))
        return {"loop_force": Recorded(values, "N", "pull of the loops", "loop", names)}
