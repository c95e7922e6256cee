"""Stops on hinges: a spring and a damper that begin at an opening and act on one side of it.

Theory: docs/mechanics.md, "On hinges: dampers, friction". A stop never pulls."""

from dataclasses import dataclass

from fpm.declare import damping, number, stiffness, word
from fpm.elements.kind import Energy, Gate
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    Connector,
    on_hinge,
    struck_stiffness,
)


class AnyStop(Connector):
    """Base class of stops and contacts, which act on one side of an opening. A subclass has the
    attributes angle (rad; m), side, stiffness (N m/rad; N/m) and damping (N m s/rad; N s/m)."""

    takes = JOINT_LOSS
    resists_as = "S"


@dataclass(frozen=True)
class Stop(AnyStop):
    """Stop of a hinge or slide: a spring and a damper that act beyond the opening `angle`, on the
    `side` above or below it."""

    hinge: int = on_hinge()
    angle: float = number("rad")
    side: str = word({"above": 1.0, "below": -1.0}, is_topology=True)
    stiffness: float = stiffness(text="moment per radian beyond `lower` or `upper`")
    damping: float = damping(
        default=0.0, text="moment per radian per second beyond `lower` or `upper`"
    )

    stores = Energy("stop", "stop_energy", "energy of the stops")
    events = ("leaves", "hits")
    acts_as = "stop"
    onset = ONSET
    noun = "stop"

    @classmethod
    def names(cls, scene):
        return [f"{stop.title(scene)} {stop.side}" for stop in cls.find(scene)]

    def stiffness_in(self, scene):
        return struck_stiffness(self)

    def gate(self):
        return Gate(self.angle, {"above": 1.0, "below": -1.0}[self.side])
