"""Rigid latches on hinges: they catch as others do (latch.py), and hold exactly from then on.

What they catch stands still at once: an inelastic impact. The impulse that it takes comes from all
masses that the joints couple to the opening, and what kinetic energy it takes is lost; a single
body of inertia J that turns at w leaves the impulse -J w and loses J w²/2. How the opening is held
is told in turn.py.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.fields import number, same, word
from fpm.elements.joints.turn import HoldsHinge
from fpm.elements.openings.latch import SIDES, AnyLatch
from fpm.elements.openings.opening import on_hinge, opened


@dataclass(frozen=True)
class RigidLatch(AnyLatch, HoldsHinge):
    """A latch that holds exactly; its name is that of the hinge if "" is given."""

    hinge: int = on_hinge()
    angle: float = number("rad")
    tolerance: float = number("rad", 0.0, default=0.0, zero=False)
    side: str = word(SIDES, default="either")
    fastest: float = number(
        "rad/s", above=0.0, finite=False, default=np.inf, words="fastest rate of {title}"
    )
    name: str = same("")

    @classmethod
    def array(cls, name, batch):
        """At the start they have looked up to where the hinges are."""
        found = super().array(name, batch)
        if name == "state":
            found[:, cls.kernels().SEEN] = opened(batch, cls)
        return found
