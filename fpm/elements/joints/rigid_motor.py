"""Rigid motors: they prescribe the opening of a hinge exactly (turn.py).

A motor without a drive train of its own that gives (motor.py) turns the hinge to start + turn f(t),
f being a curve of time or the integral of one, whatever moment M that takes. Its work is that of M
on the hinge: where f bends, a blow changes the rate at once, and does half of what a force would
over the same way (the mean of the rates before and after it). The rates with which a motor begins
to turn are those of the start of a run (start.py).
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.fields import index, number, same
from fpm.elements.joints.turn import HoldsHinge
from fpm.elements.openings.motor import AnyMotor
from fpm.elements.openings.opening import on_hinge, unit_of
from fpm.errors import SceneError

AT_START = 1e-9
"""A rigid motor begins where its hinge is, to this angle (rad)."""

ALWAYS = np.zeros(1), np.ones(1)
"""The curve -1."""


@dataclass(frozen=True)
class RigidMotor(AnyMotor, HoldsHinge):
    """Prescribes the opening of a hinge: start + turn times the curve of that index (-1: 1).

    by_rate: turn (rad/s) times the curve is the rate of the opening instead.
    """

    hinge: int = on_hinge()
    start: float = number("rad", words="opening of {title}", said=False)
    turn: float = number("rad", words="opening of {title}")
    curve: int = index("curves", -1)
    by_rate: bool = same(False)

    def at(self, scene, time: float) -> float:
        """The opening (rad) that it prescribes at a time (s)."""
        times, values = scene.curves[self.curve] if self.curve >= 0 else ALWAYS
        if not self.by_rate:
            return float(self.start + self.turn * np.interp(time, times, values))
        bends = np.append(times[(times > 0.0) & (times < time)], [0.0, time])
        bends.sort()
        travelled = np.trapezoid(np.interp(bends, times, values), bends)
        return float(self.start + self.turn * travelled)

    def rate_at_start(self, scene) -> float:
        """The rate (rad/s) of the opening at the start, and just after it."""
        times, values = scene.curves[self.curve] if self.curve >= 0 else ALWAYS
        if self.by_rate:
            return float(self.turn * np.interp(0.0, times, values))
        k = int(np.searchsorted(times, 0.0, side="right"))
        if not 0 < k < len(times):
            return 0.0
        return float(self.turn * (values[k] - values[k - 1]) / (times[k] - times[k - 1]))

    def check(self, scene):
        """It begins where its hinge is."""
        super().check(scene)
        hinge = scene.hinges[self.hinge]
        if abs(self.at(scene, 0.0) - hinge.opening) > AT_START:
            unit = unit_of(scene, self.hinge, "rad")
            allowed = f"{hinge.opening:g} {unit}, where the hinge is then, or a drive train"
            subject = f"opening of {self.title(scene)} at the start"
            raise SceneError(subject, self.at(scene, 0.0), allowed)

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening
