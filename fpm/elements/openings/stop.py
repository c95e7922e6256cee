"""Stops on hinges: a spring and a damper that begin at an opening and act on one side of it.

With the overlap s = psi - angle (or angle - psi for a stop below), where s > 0, the moment is

    k s + max(c ds/dt, -k s)

so that a stop never pulls.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Energy
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    OnHinge,
    Opening,
    check_numbers,
    check_stiffness,
    pack_past,
)
from fpm.errors import SceneError

SIDES = {"above": 1.0, "below": -1.0}


@dataclass(frozen=True)
class Stop(OnHinge):
    """hinge index; angle (rad), `side` of it where it acts ("above", "below"); stiffness k
    (N m/rad); damping c (N m s/rad).
    """

    hinge: int
    angle: float
    side: str
    stiffness: float
    damping: float = 0.0

    stores = Energy("stop", "stop_energy", "energy of the stops")
    takes = JOINT_LOSS
    events = ("leaves", "hits")
    acts_as = "stop"
    called = "stop"

    def check(self, scene):
        """Hinge, side and numbers."""
        check_stiffness(scene, "stop", self.hinge, self.stiffness)
        check_numbers(
            "stop",
            scene,
            self.hinge,
            angle=(self.angle, -np.inf, "rad"),
            damping=(self.damping, 0.0, "N m s/rad"),
        )
        if self.side not in SIDES:
            raise SceneError("side of stop", self.side, " or ".join(SIDES))

    def topology(self):
        """The hinge and the side."""
        return self.hinge, self.side

    @classmethod
    def names(cls, scene):
        return [f"stop {scene.hinges[s.hinge].name} {s.side}" for s in cls.of(scene)]

    def damping_in(self, scene):
        """Its damper begins with more than a kick."""
        return ONSET * self.damping

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.stop_kernels import STOP, Stops

        return Stops(
            batch.integers(s.hinge for s in cls.of(batch.one)),
            batch.table(cls, STOP, lambda s: [s.angle, SIDES[s.side], s.stiffness, s.damping]),
            Opening.seen_by(cls, batch),
            pack_past(batch, cls),
            batch.taken_by(cls),
            batch.rows_of(cls),
            batch.log_of(cls),
        )
