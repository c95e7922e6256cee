"""Motors, releases, latches and friction that hold openings exactly (turn.py), without a spring.

Motors prescribe the opening of a hinge. A motor without a drive train of its own that gives
(motor.py) turns the hinge to start + turn f(t), f being a curve of time or the integral of one,
whatever moment M that takes. Its work is that of M on the hinge: where f bends, an impact changes
the rate at once, and does half of what a force would over the same way (the mean of the rates
before and after it). Its first rate is that of the start of a run (start.py).

Releases hold a hinge at its first opening until they let go, as others do (release.py), at a time,
where another opening passes a level or a latch catches; nothing is stored or lost.

Latches catch as others do (latch.py). What they catch stands still at once: an inelastic impact.
Its impulse comes from all masses that the joints couple to the opening, and the kinetic energy
taken is lost; a single body of inertia J that turns at w leaves the impulse -J w and loses J w²/2.

Coulomb friction sticks without a bristle. While it sticks, the opening does not move; what that
takes is looked at in every step. If it is more than `moment`, M, the joint slips in this step
already, braked by M. While it slips at a rate r that would fall by d > r in a step, it stands after
the share s = r/d of that: M brakes it until then, and pushes it from then on, (1 - 2 s) M in all.
Where it then goes back, it was a turn. Where not, it sticks, at the angle where M brings it to
rest: the last way is the rest of the parabola, h (r - d/2)²/(2 d), or h r²/(2 d) where it is braked
only now. So a body of inertia J that slides at w stops after J w²/(2 M), and one that swings loses
as much at each turn as friction takes, to the second order in the step.

An impact, of a latch or at a bend of a motor's curve, after the share s of a step comes after 1/2 +
s of its kick: friction that stuck with M' has (1/2 + s) M' ± (1/2 - s) M in that kick."""

from dataclasses import dataclass
from importlib import import_module

import numpy as np

from fpm.elements.fields import index, number, topology, word
from fpm.elements.joints.turn import ExactConnector
from fpm.elements.openings import opening
from fpm.elements.openings.friction import SWEEP_DEFLECTION, Friction
from fpm.elements.openings.latch import SIDES, AnyLatch
from fpm.elements.openings.motor import AnyMotor
from fpm.elements.openings.release import AnyRelease
from fpm.errors import SceneError

AT_START = 1e-9
"""What holds exactly begins where its hinge is, to this opening (rad, m)."""

RATE_TOL = 1e-11
"""Rate up to which a hinge sticks at the start, as a share of the fastest spin; what joins it to
others leaves a tenth (AGREES in solver/start.py)."""


class Rigid(ExactConnector):
    """Base class of motors, releases, latches and friction that hold a joint coordinate exactly,
    without a spring. `noun`: the type's word, as "latch"; kernels: in rigid_<noun>_kernels."""

    @classmethod
    def kernels(cls):
        return import_module(f"{__package__}.rigid_{cls.noun}_kernels")


@dataclass(frozen=True)
class RigidMotor(AnyMotor, Rigid):
    """A motor that prescribes the joint coordinate (opening) of a hinge exactly: start + turn times
    a curve of time (rad; m on a slide). hinge, curve: indices in the scene (curve -1: constant 1);
    by_rate: whether turn (rad/s) times the curve is the rate instead, from `start` on."""

    hinge: int = opening.on_hinge()
    start: float = number("rad", words="opening of {title}", is_shown=False)
    turn: float = number("rad", words="opening of {title}")
    curve: int = index("curves", -1)
    by_rate: bool = topology(False)

    def target(self, scene, time: float) -> float:
        """Return the opening (rad; m on a slide) prescribed at `time` (s). scene: has the curve."""
        curve = scene.curve(self.curve)
        distance = curve.integral(time) if self.by_rate else curve.value(time)
        return float(self.start + self.turn * distance)

    def rate_at_start(self, scene) -> float:
        """Return the rate (rad/s; m/s on a slide) that the motor prescribes just after time 0; 0
        where its curve (not by rate) is constant then. scene: has the curve."""
        curve = scene.curve(self.curve)
        if self.by_rate:
            return float(self.turn * curve.value(0.0))
        return curve.rate_after(0.0, self.turn)

    def check(self, scene):
        """Check the fields, and that the joint coordinate prescribed at time 0 is the hinge's joint
        coordinate in the scene, within AT_START (rad, m); raises SceneError if not."""
        super().check(scene)
        hinge = scene.hinges[self.hinge]
        if abs(self.target(scene, 0.0) - hinge.opening) > AT_START:
            unit = opening.unit_of(scene, self.hinge, "rad")
            allowed = f"{hinge.opening:g} {unit}, where the hinge is then, or a drive train"
            subject = f"opening of {self.title(scene)} at the start"
            raise SceneError(subject, self.target(scene, 0.0), allowed)

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening


@dataclass(frozen=True)
class RigidRelease(AnyRelease, Rigid):
    """A release that holds a hinge exactly at the opening (joint coordinate) it has at the start,
    and lets go at `time` (s), when the opening of hinge `watch` passes `level` (rad; m on a slide),
    or when a latch catches. hinge, watch: indices in the scene (watch -1: none); latch: name of the
    latch, "": none."""

    hinge: int = opening.on_hinge()
    time: float = number("s", above=0.0, finite=False, default=np.inf)
    watch: int = index("hinges", -1, words="hinge of release to watch", default=-1)
    level: float = number("rad", default=0.0, is_shown=False)
    latch: str = topology("")

    def held_at_start(self, scene):
        return scene.hinges[self.hinge].opening

    def rate_at_start(self, scene):
        return 0.0


@dataclass(frozen=True)
class RigidLatch(AnyLatch, Rigid):
    """A latch that stops the opening (joint coordinate) of a hinge (index) and holds it where it
    caught it: within capture_range (rad) of `angle` (rad), coming from `side` ("below", "above" or
    "either"), at no more than max_capture_rate (rad/s); on a slide in m. name: "": the hinge's."""

    hinge: int = opening.on_hinge()
    angle: float = number("rad")
    capture_range: float = number("rad", 0.0, default=0.0, zero=False)
    side: str = word(SIDES, default="either")
    max_capture_rate: float = number(
        "rad/s", above=0.0, finite=False, default=np.inf, words="largest capture rate of {title}"
    )
    name: str = topology("")

    @classmethod
    def array(cls, name, batch):
        """Return the array for a field `name` of the kernels' tuple RigidLatches, as
        ExactConnector.array; in "state", the field SEARCH_END, joint coordinate up to which a latch
        has looked, is that at the start (rad; m). batch: the scenes simulated side by side."""
        array = super().array(name, batch)
        if name == "state":
            array[:, cls.kernels().SEARCH_END] = opening.start_angles(batch, cls)
        return array


@dataclass(frozen=True)
class RigidFriction(Rigid):
    """Coulomb friction in a hinge (index), without a bristle (a stiff spring that gives while it
    sticks): it holds the joint coordinate up to `moment` (N m), and slips against that above."""

    hinge: int = opening.on_hinge(only_angles=True)
    moment: float = number("N m", 0.0)

    takes = opening.JOINT_LOSS
    acts_as = "friction"
    noun = "friction"
    resists_as = "FR"

    @classmethod
    def sweep_elements(cls, scene):
        """Return Friction elements that slip at once (bristles of no size) in place of a scene's
        rigid ones, for moving a joint coordinate slowly through static equilibria (fpm/travel)."""
        return [Friction(f.hinge, f.moment, SWEEP_DEFLECTION, 0.0) for f in cls.find(scene)]

    def held_at_start(self, scene):
        (rate,) = opening.turning_at_start(scene, [self.hinge])
        fastest = np.abs(opening.moving_at_start(scene).spin).max(initial=0.0)
        return scene.hinges[self.hinge].opening if abs(rate) <= RATE_TOL * fastest else None

    @classmethod
    def held_round(cls, scene):
        """Return the sum (N m) of the friction moments of a scene, the most that friction which
        sticks in closed loops may bear at rest, for the tolerance of the energy balance."""
        return float(sum(friction.moment for friction in cls.find(scene)))

    @classmethod
    def array(cls, name, batch):
        """Return the array for a field `name` of the kernels' tuple RigidFrictions, as
        ExactConnector.array; "state" is 0 but for its field SIGN, the sign (1 or -1; 1 at rest) of
        the hinge's rate at the start. batch: the scenes simulated side by side."""
        if name != "state":
            return super().array(name, batch)
        kernels, count = cls.kernels(), len(cls.find(batch.scene))

        def starts(scene):
            state = np.zeros((count, kernels.STATE))
            rates = opening.turning_at_start(scene, [f.hinge for f in cls.find(scene)])
            state[:, kernels.SIGN] = np.where(np.array(rates) < 0, -1.0, 1.0)
            return state

        return batch.stack(count, kernels.STATE, starts)
