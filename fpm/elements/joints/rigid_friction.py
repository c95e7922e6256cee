"""Coulomb friction on hinges that sticks without a bristle: the opening is held (turn.py).

While it sticks, the opening does not move by a hair; what that takes is looked at in every step. If
it is more than `moment`, M, the joint slips in this step already, braked by M. While it slips at a
rate r that would fall by d > r in a step, it stands after the share s = r/d of that: M brakes it
until then, and pushes it from then on, (1 - 2 s) M in all. Where it then goes back, it was a turn.
Where not, it sticks, at the angle where M brings it to rest: the last way is the rest of the
parabola, h (r - d/2)²/(2 d), or h r²/(2 d) where it is braked only now.
So a body of inertia J that slides at w stops after J w²/(2 M), and one that swings loses as much at
each turn as friction takes, to the second order in the step.

A blow, of a latch or at a bend of a motor's curve, after the share s of a step comes after the
share 1/2 + s of its kick: friction that stuck with M' has (1/2 + s) M' ± (1/2 - s) M in that kick.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.fields import number
from fpm.elements.joints.turn import HoldsHinge
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    TURNING,
    moving_at_start,
    on_hinge,
    turning_at_start,
)

STILL = 1e-11
"""Rate up to which a hinge sticks at the start, as a share of the fastest spin; what joins it to
others leaves a tenth (AGREES in solver/start.py)."""


@dataclass(frozen=True)
class RigidFriction(HoldsHinge):
    """Friction in a hinge without a bend."""

    hinge: int = on_hinge(types=TURNING)
    moment: float = number("N m", 0.0)

    takes = JOINT_LOSS
    acts_as = "friction"
    called = "friction"

    def held_at_start(self, scene):
        (rate,) = turning_at_start(scene, [self.hinge])
        fastest = np.abs(moving_at_start(scene).spin).max(initial=0.0)
        return scene.hinges[self.hinge].opening if abs(rate) <= STILL * fastest else None

    @classmethod
    def held_round(cls, scene):
        """All moments: in a loop that holds itself, friction may stick with any."""
        return float(sum(friction.moment for friction in cls.of(scene)))

    @classmethod
    def array(cls, name, batch):
        """At the start they slip the way that the hinges turn."""
        if name != "state":
            return super().array(name, batch)
        at, count = cls.kernels(), len(cls.of(batch.one))

        def starts(scene):
            state = np.zeros((count, at.STATE))
            rates = turning_at_start(scene, [f.hinge for f in cls.of(scene)])
            state[:, at.WAY] = np.where(np.array(rates) < 0, -1.0, 1.0)
            return state

        return batch.stack(count, at.STATE, starts)
