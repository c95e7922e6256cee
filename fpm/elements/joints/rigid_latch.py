"""Rigid latches on hinges: they catch as others do (latch.py), and hold exactly from then on.

What they catch stands still at once: an inelastic impact. The impulse that it takes comes from all
masses that the joints couple to the opening, and what kinetic energy it takes is lost; a single
body of inertia J that turns at w leaves the impulse -J w and loses J w²/2. How the opening is held
is told in turn.py.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.joints.turn import HoldsHinge, Turn
from fpm.elements.openings.latch import SIDES, check_catching, recorded_of
from fpm.elements.openings.opening import JOINT_LOSS, Opening, check_hinge, pack_past


@dataclass(frozen=True)
class RigidLatch(HoldsHinge):
    """hinge index; angle, tolerance (rad); side ("below", "above", "either"); fastest (rad/s);
    name (that of the hinge if "").
    """

    hinge: int
    angle: float
    tolerance: float = 0.0
    side: str = "either"
    fastest: float = np.inf
    name: str = ""

    takes = JOINT_LOSS
    events = ("latches", "misses")
    acts_as = "latch"
    called = "latch"

    def check(self, scene):
        """Hinge, numbers, and a label that no other latch has."""
        check_hinge(scene, "latch", self.hinge)
        check_catching(scene, self)

    def label(self, scene) -> str:
        """Its name in messages and files."""
        return self.name or scene.hinges[self.hinge].name

    def topology(self):
        """The hinge and the name."""
        return self.hinge, self.name

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints.rigid_latch_kernels import RIGID, RigidLatches
        from fpm.elements.openings.latch_kernels import LATCH, TRACK

        latches, rows = cls.of(batch.one), batch.instants + 1
        none = [0.0, 0.0, 1.0]  # stiffness, damping; both sides

        def starts(scene):
            openings = [scene.hinges[x.hinge].opening for x in cls.of(scene)]
            return [[*[0.0] * (RIGID - 1), opening] for opening in openings]

        return RigidLatches(
            on=batch.integers(x.hinge for x in latches),
            turn=batch.integers(Turn.places(batch.one, cls)),
            latch=batch.table(
                cls, LATCH, lambda x: [x.angle, x.tolerance, SIDES[x.side], x.fastest, *none]
            ),
            openings=Opening.seen_by(cls, batch),
            turns=batch.part(Turn),
            past=pack_past(batch, cls),
            state=batch.stack(len(latches), RIGID, starts),
            account=batch.taken_by(cls),
            log=batch.log_of(cls),
            track=batch.blank(rows * len(latches), TRACK + 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """As of other latches, and the impulses with which they caught."""
        return recorded_of(cls, scene, part.track[:, :, lane])
