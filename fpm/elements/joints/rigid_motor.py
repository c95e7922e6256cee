"""Rigid motors: they prescribe the opening of a hinge exactly (turn.py).

A motor without a drive train of its own that gives (motor.py) turns the hinge to start + turn f(t),
f being a curve of time or the integral of one, whatever moment M that takes. Its work is that of M
on the hinge: where f bends, a blow changes the rate at once, and does half of what a force would
over the same way (the mean of the rates before and after it). The rates with which a motor begins
to turn are those of the start of a run (start.py).
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.joints.turn import HoldsHinge, Turn
from fpm.elements.openings.motor import MOTOR_WORK, check_curve, recorded_moments
from fpm.elements.openings.opening import Opening, check_hinge, unit_of
from fpm.errors import SceneError

AT_START = 1e-9
"""A rigid motor begins where its hinge is, to this angle (rad)."""

ALWAYS = np.zeros(1), np.ones(1)
"""The curve -1."""


@dataclass(frozen=True)
class RigidMotor(HoldsHinge):
    """Prescribes the opening of a hinge: start + turn (rad) times the curve of that index (-1: 1).

    hinge: its index; by_rate: turn (rad/s) times the curve is the rate of the opening instead.
    """

    hinge: int
    start: float
    turn: float
    curve: int
    by_rate: bool = False

    gives = MOTOR_WORK
    acts_as = "motor"
    called = "motor"

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
        """Hinge and curve; one motor on a hinge, which begins where that is."""
        check_hinge(scene, "motor", self.hinge)
        hinge = scene.hinges[self.hinge]
        what = f"motor {hinge.name}"
        self.check_alone(scene)
        if not np.isfinite([self.start, self.turn]).all():
            raise SceneError(f"opening of {what}", (self.start, self.turn), "finite numbers")
        check_curve(scene, what, self.curve)
        if abs(self.at(scene, 0.0) - hinge.opening) > AT_START:
            unit = unit_of(scene, self.hinge, "rad")
            allowed = f"{hinge.opening:g} {unit}, where the hinge is then, or a drive train"
            raise SceneError(f"opening of {what} at the start", self.at(scene, 0.0), allowed)

    def topology(self):
        """Hinge and curve, and what that is of."""
        return self.hinge, self.curve, self.by_rate

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints.rigid_motor_kernels import RigidMotors
        from fpm.elements.joints.turn_kernels import HELD

        motors = cls.of(batch.one)
        return RigidMotors(
            on=batch.integers(m.hinge for m in motors),
            turn=batch.integers(Turn.places(batch.one, cls)),
            curve=batch.integers(m.curve for m in motors),
            by_rate=batch.integers(m.by_rate for m in motors),
            motors=batch.table(cls, 2, lambda m: [m.start, m.turn]),
            openings=Opening.seen_by(cls, batch),
            turns=batch.part(Turn),
            state=batch.blank(len(motors), HELD),
            account=batch.given_by(cls),
            track=batch.blank((batch.instants + 1) * len(motors), 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """The moments."""
        return recorded_moments(cls, part, scene, lane, "motor_moment", "motor")
