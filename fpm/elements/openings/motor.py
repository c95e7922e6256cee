"""Motors on hinges that prescribe the opening, through their drive trains or exactly.

Theory: docs/mechanics.md, "Loops, motors and releases" and "Openings that are held exactly". The
target is start + turn f(t), f being a curve of time, or the integral of one from t = 0 on. With
backlash b it is less by b/2 on either side: within, no moment acts, and outside the damper never
pulls the drive train's teeth apart."""

from dataclasses import dataclass
from typing import ClassVar

from fpm.declare import damping, index, number, stiffness, topology
from fpm.elements.joints.turn import ExactConnector
from fpm.elements.kind import Energy
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    Connector,
    backlashes,
    on_hinge,
    unit_of,
)
from fpm.errors import SceneError

AT_START = 1e-9
"""What holds exactly begins where its hinge is, to this opening (rad, m)."""

MOTOR_WORK = Energy("motor_work", "motor_work", "work of the motors")


class AnyMotor(Connector):
    """Base class of motors."""

    gives = MOTOR_WORK
    acts_as = "motor"
    noun = "motor"

    def check(self, scene):
        super().check(scene)
        self.check_alone(scene)


@dataclass(frozen=True)
class Motor(AnyMotor, ExactConnector):
    """Motor that prescribes the joint coordinate of a hinge, through an elastic drive train or
    exactly: start + turn times a curve of time. by_rate: whether turn (rad/s) times the curve is
    the coordinate's rate instead, from `start` on. On slides m for rad, N for N m."""

    hinge: int = on_hinge()
    stiffness: float | None = stiffness(
        default=None,
        text="stiffness of its drive train; default: it prescribes the opening exactly",
    )
    damping: float = damping(default=0.0, text="damping of its drive train")
    start: float = number(
        "rad", default=0.0, words="opening of {title}", is_shown=False,
        text="opening before the turn",
    )  # fmt: skip
    turn: float = number("rad", default=0.0, words="opening of {title}")
    curve: int = index("curves", -1, default=-1)
    by_rate: bool = topology(False)
    backlash: float | None = number(
        "rad",
        0.0,
        default=None,
        text="total play of its drive train, within which no moment acts; default: none",
    )

    series: ClassVar = {"motor_moment": ("N m", "moment of the motors on their hinges", "motor")}
    stores = Energy("motor", "motor_energy", "energy of the motors' drive trains")
    takes = JOINT_LOSS

    def target(self, scene, time: float) -> float:
        """Return the opening (rad; m on a slide) prescribed at `time` (s). scene: has the curve."""
        curve = scene.curve(self.curve)
        distance = curve.integral(time) if self.by_rate else curve.value(time)
        return float(self.start + self.turn * distance)

    def rate_at_start(self, scene) -> float:
        curve = scene.curve(self.curve)
        if self.by_rate:
            return float(self.turn * curve.value(0.0))
        return curve.rate_after(0.0, self.turn)

    def check(self, scene):
        super().check(scene)
        hinge = scene.hinges[self.hinge]
        if self.is_exact and abs(self.target(scene, 0.0) - hinge.opening) > AT_START:
            unit = unit_of(scene, self.hinge, "rad")
            allowed = f"{hinge.opening:g} {unit}, where the hinge is then, or a drive train"
            subject = f"opening of {self.title(scene)} at the start"
            raise SceneError(subject, self.target(scene, 0.0), allowed)

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    def topology(self):
        return *super().topology(), self.backlash is None

    def damping_in(self, scene):
        return self.damping * (1.0 if self.backlash is None else ONSET)

    @classmethod
    def array(cls, name, batch):
        return backlashes(batch, cls) if name == "backlash" else super().array(name, batch)
