"""Motors on hinges that prescribe the opening through their drive trains.

A motor turns its own side of an elastic and damped drive train to target(t) = start + turn f(t), f
being a curve of time, or the integral of one from t = 0 on, and the hinge follows:

    moment M = k (target - psi) + c (target' - psi'),   work given M target'

of which k (target - psi)²/2 is stored in the drive train and c (target' - psi')² lost there. With
backlash b, target - psi is less by b/2 on either side: within, no moment acts, and outside the
damper never pulls the drive train's teeth apart."""

from dataclasses import dataclass
from typing import ClassVar

from fpm.elements.fields import damping, index, number, stiffness, topology
from fpm.elements.kind import Energy, Series
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    Connector,
    backlashes,
    by_unit,
    on_hinge,
)

MOTOR_WORK = Energy("motor_work", "motor_work", "work of the motors")


class AnyMotor(Connector):
    """Base class of all motors on hinges: with a drive train (Motor), rigid ones (RigidMotor), and
    torque motors. variable: name of their recorded moment in trajectory files."""

    gives = MOTOR_WORK
    acts_as = "motor"
    noun = "motor"
    variable: ClassVar[str] = "motor_moment"  # of what is recorded, in trajectory files

    def check(self, scene):
        """Check the fields, and that its hinge in `scene` has no other motor; SceneError if not."""
        super().check(scene)
        self.check_alone(scene)

    @classmethod
    def read_records(cls, part, scene, lane):
        """Return the recorded moments (N m, on slides N) of one sample's motors after a run, Series
        (t, motors) by variable name. part: the motors' arrays; scene, lane: of the sample."""
        hinges = [scene.hinges[motor.hinge] for motor in cls.find(scene)]
        values = part.track[:, 0, lane].reshape(-1, len(hinges))
        text, dimension = f"moment of the {cls.noun}s on their hinges", cls.noun
        series = {cls.variable: Series(values, "N m", text, dimension.replace(" ", "_"), ())}
        return by_unit(series, hinges, [hinge.name for hinge in hinges])


@dataclass(frozen=True)
class Motor(AnyMotor):
    """Motor that prescribes the joint coordinate of a hinge through an elastic drive train: start +
    turn times a curve of time. hinge: index; stiffness (N m/rad), damping (N m s/rad): of the drive
    train; start, turn (rad); curve: index in Scene.curves, -1: constant 1; by_rate: whether turn
    (rad/s) times the curve is the coordinate's rate instead; backlash: of the drive train, all its
    play (rad), None: none; on slides m for rad, N for N m."""

    hinge: int = on_hinge()
    stiffness: float = stiffness(text="of its drive train")
    damping: float = damping(text="of its drive train")
    start: float = number(
        "rad", words="opening of {title}", is_shown=False, text="opening before the turn"
    )
    turn: float = number("rad", words="opening of {title}")
    curve: int = index("curves", -1)
    by_rate: bool = topology(False)
    backlash: float | None = number(
        "rad",
        0.0,
        default=None,
        text="of its drive train: all its play, within which no moment acts; left out: none",
    )

    stores = Energy("motor", "motor_energy", "energy of the motors' drive trains")
    takes = JOINT_LOSS
    resists_as = ""

    def topology(self):
        return *super().topology(), self.backlash is None

    def damping_in(self, scene):
        """Return the damping (N m s/rad) by which the motor limits the stable time step: with
        backlash ONSET times its own, as that of a stop. scene: not used."""
        return self.damping * (1.0 if self.backlash is None else ONSET)

    @classmethod
    def array(cls, name, batch):
        return backlashes(batch, cls) if name == "backlash" else super().array(name, batch)
