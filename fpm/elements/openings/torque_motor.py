"""Torque motors on hinges: a moment by a curve of time, which falls with the speed.

With a curve f of time and the torque T the moment is T f(t) (1 - |w|/w0) where the hinge turns with
it at w = psi', down to nothing at the no-load speed w0, as that of a direct current motor does. It
is T f(t) where the hinge turns against it, and it never brakes."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpm.declare import index, number
from fpm.elements.openings.motor import AnyMotor
from fpm.elements.openings.opening import on_hinge


@dataclass(frozen=True)
class TorqueMotor(AnyMotor):
    """A torque or force on a joint, which decreases linearly with the speed."""

    hinge: int = on_hinge()
    torque: float = number("N m", text="its moment at rest")
    curve: int = index(
        "curves", -1, default=-1, text="curve that scales it over time; default: constant"
    )
    no_load: float = number(
        "rad/s", above=0.0, finite=False, default=np.inf, words="no-load speed of {title}",
        text="speed at which the torque is zero; default: the torque does not depend on the speed",
    )  # fmt: skip

    noun = "torque motor"
    resists_as = "HM"
    series: ClassVar = {
        "torque_motor_moment": (
            "N m", "moment of the torque motors on their hinges", "torque_motor",
        )
    }  # fmt: skip

    def damping_in(self, scene):
        """The largest fall of its torque, or force, with the speed."""
        most = max(map(abs, scene.curve(self.curve).extremes()))
        return float(abs(self.torque) * most / self.no_load)

    @classmethod
    def held_round(cls, scene):
        return float(sum(abs(motor.torque) for motor in cls.find(scene)))
