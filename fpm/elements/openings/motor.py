"""Motors on hinges: one that prescribes the opening through its drive train, one with a torque.

A motor turns its own side of an elastic and damped drive train to target(t) = start + turn f(t), f
being a curve of time, or the integral of one from t = 0 on, and the hinge follows:

    moment M = k (target - psi) + c (target' - psi'),   work given M target'

of which k (target - psi)²/2 is stored in the drive train and c (target' - psi')² lost there.

A torque motor gives a moment by a curve of time, which falls with the speed: T f(t) (1 - |w|/w0)
where the hinge turns with it at w = psi', down to nothing at the no-load speed w0, as that of a
direct current motor does. It is T f(t) where the hinge turns against it, and it never brakes.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Energy, Recorded
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    OnHinge,
    Opening,
    by_unit,
    check_hinge,
    check_numbers,
    check_stiffness,
    pack_past,
    unit_of,
)
from fpm.errors import SceneError

MOTOR_WORK = Energy("motor_work", "motor_work", "work of the motors")


def check_curve(scene, what: str, curve: int) -> None:
    """SceneError unless there is a curve of that index for `what`; -1 is always 1."""
    if not -1 <= curve < len(scene.curves):
        raise SceneError(f"curve of {what}", curve, f"-1 to {len(scene.curves) - 1}")


def recorded_moments(cls, part, scene, lane, variable, dimension) -> dict[str, Recorded]:
    """Moments of motors of a kind that has them in its `track`."""
    hinges = [scene.hinges[motor.hinge] for motor in cls.of(scene)]
    values = part.track[:, 0, lane].reshape(-1, len(hinges))
    text = f"moment of the {dimension.replace('_', ' ')}s on their hinges"
    found = {variable: Recorded(values, "N m", text, dimension, ())}
    return by_unit(found, hinges, [hinge.name for hinge in hinges])


@dataclass(frozen=True)
class Motor(OnHinge):
    """Prescribes the opening of a hinge: start + turn (rad) times the curve of that index (-1: 1).

    hinge: its index; stiffness (N m/rad) and damping (N m s/rad) of the drive train; by_rate: turn
    (rad/s) times the curve is the rate of the opening instead.
    """

    hinge: int
    stiffness: float
    damping: float
    start: float
    turn: float
    curve: int
    by_rate: bool = False

    stores = Energy("motor", "motor_energy", "energy of the motors' drive trains")
    gives = MOTOR_WORK
    takes = JOINT_LOSS
    acts_as = "motor"
    called = "motor"

    def check(self, scene):
        """Hinge, drive train and curve; one motor on a hinge."""
        check_stiffness(scene, "motor", self.hinge, self.stiffness)
        what = f"motor {scene.hinges[self.hinge].name}"
        self.check_alone(scene)
        check_numbers(what, scene, self.hinge, damping=(self.damping, 0.0, "N m s/rad"))
        if not np.isfinite([self.start, self.turn]).all():
            raise SceneError(f"opening of {what}", (self.start, self.turn), "finite numbers")
        check_curve(scene, what, self.curve)

    def topology(self):
        """Hinge and curve, and what that is of."""
        return self.hinge, self.curve, self.by_rate

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.motor_kernels import STATE, Motors

        motors = cls.of(batch.one)
        return Motors(
            on=batch.integers(m.hinge for m in motors),
            curve=batch.integers(m.curve for m in motors),
            by_rate=batch.integers(m.by_rate for m in motors),
            motors=batch.table(cls, 4, lambda m: [m.stiffness, m.damping, m.start, m.turn]),
            past=pack_past(batch, cls),
            now=batch.blank(len(motors), STATE),
            openings=Opening.seen_by(cls, batch),
            given=batch.given_by(cls),
            taken=batch.taken_by(cls),
            rows=batch.rows_of(cls),
            track=batch.blank((batch.instants + 1) * len(motors), 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """The moments."""
        return recorded_moments(cls, part, scene, lane, "motor_moment", "motor")


@dataclass(frozen=True)
class TorqueMotor(OnHinge):
    """Turns a hinge by a torque (N m) times the curve of that index (-1: 1).

    hinge: its index; no_load: the speed (rad/s) at which no torque is left; inf: it does not fall.
    """

    hinge: int
    torque: float
    curve: int = -1
    no_load: float = np.inf

    gives = MOTOR_WORK
    acts_as = "motor"
    called = "torque motor"

    def check(self, scene):
        """Hinge, torque, speed and curve; one torque motor on a hinge."""
        check_hinge(scene, "torque motor", self.hinge)
        what = f"torque motor {scene.hinges[self.hinge].name}"
        self.check_alone(scene)
        if not np.isfinite(self.torque):
            unit = unit_of(scene, self.hinge, "N m")
            raise SceneError(f"torque of {what}", self.torque, f"a finite number ({unit})")
        if not self.no_load > 0:
            unit = unit_of(scene, self.hinge, "rad/s")
            raise SceneError(f"no-load speed of {what}", self.no_load, f"above 0 {unit}")
        check_curve(scene, what, self.curve)

    def topology(self):
        """Hinge and curve."""
        return self.hinge, self.curve

    def damping_in(self, scene):
        """By how much the moment falls with the speed at most (N m s/rad)."""
        most = np.abs(scene.curves[self.curve][1]).max() if self.curve >= 0 else 1.0
        return float(abs(self.torque) * most / self.no_load)

    @classmethod
    def held_round(cls, scene):
        """All torques."""
        return float(sum(abs(motor.torque) for motor in cls.of(scene)))

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.torque_motor_kernels import STATE, TorqueMotors

        motors = cls.of(batch.one)
        return TorqueMotors(
            on=batch.integers(m.hinge for m in motors),
            curve=batch.integers(m.curve for m in motors),
            motors=batch.table(cls, 2, lambda m: [m.torque, m.no_load]),
            past=pack_past(batch, cls),
            now=batch.blank(len(motors), STATE),
            openings=Opening.seen_by(cls, batch),
            given=batch.given_by(cls),
            track=batch.blank((batch.instants + 1) * len(motors), 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """The moments."""
        return recorded_moments(cls, part, scene, lane, "torque_motor_moment", "torque_motor")
