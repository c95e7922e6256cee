"""Pins with play: a journal that moves in a bearing with clearance, touches it, and rubs on it.

Theory: docs/mechanics.md, "Pins with play" (Hertz; Lankarani and Nikravesh, Nonlinear Dynamics 5
(1994) 193; Flores, Ambrosio et al., J. Comput. Nonlinear Dyn. 1 (2006) 240). The damping follows
from the restitution exactly, at any speed; 3 (1 - r²)/4, as often used, is its limit at r = 1.

Friction is a bristle (friction.py), bent by `bristle_deflection` where it slips at `load`; it bears
at most friction N, with a damper of 0.3 of critical, and is straight where nothing touches."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpm.declare import number, word
from fpm.elements.kind import Deformations, Energy, Watch
from fpm.elements.openings.friction import DAMPING_RATIO
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    Connector,
    mobility,
    on_hinge,
    relative_turn,
    turning_at_start,
)
from fpm.errors import SceneError

PIN = "pin with play"
"""The joint's type: a planar joint, whose openings are a turn, x and y."""

FINER = 4.0
"""By how much the step of pins at their load is finer than the stable one: an impact then takes
seven steps, and its restitution is right to 4 %; at the stable one it takes two, and is off by
half."""

REMEDY = (
    "the step is made for impacts of this pin up to its `load`: where it is pressed harder, state "
    "a larger `load` (with the `depth` at it), or a shorter solver.step"
)


@dataclass(frozen=True)
class Journal(Connector):
    """Contact of a pin in a bearing with clearance. hinge: index of its joint's turn, after which
    come x and y."""

    hinge: int = on_hinge(types=(PIN,))
    clearance: float = number("m", 0.0, text="radius of the bearing less that of the pin")
    load: float = number(
        "N",
        above=0.0,
        text="force at which the pin sinks in by `depth`; choose about the largest force, since "
        "the stable step is computed for it",
    )
    depth: float = number(
        "m", above=0.0, text="depth by which the pin sinks into the bearing at `load`"
    )
    law: str = word(
        {"hertz": 1.0, "linear": 0.0},
        default="hertz",
        text="`hertz`: the force grows with the power 3/2 of the depth; `linear`: in proportion "
        "to the depth",
    )
    restitution: float = number(
        "",
        above=0.0,
        default=1.0,
        text="ratio of the speed after a free impact to the speed before it, at most 1",
    )
    friction: float = number("", 0.0, default=0.0, text="coefficient of friction")
    radius: float = number("m", 0.0, default=0.0, text="radius of the pin, at which friction acts")
    bristle_deflection: float = number(
        "m",
        above=0.0,
        default=1e-5,
        is_shown=False,
        text="tangential displacement at which the surfaces slip, under `load`",
    )

    stores = Energy("pin", "pin_energy", "energy of the pins with play")
    takes = JOINT_LOSS
    events = ("leaves", "touches")
    acts_as = "contact"
    series: ClassVar = {
        "pin_force": ("N", "force that presses the pins", "pin"),
        "pin_eccentricity": ("m", "distance of the pins from the axes of their bearings", "pin"),
    }
    noun = PIN
    resists_as = "S"
    cost = 90.0
    watches = (Watch("overload", np.inf, False, lambda _: ("", ""), remedy=lambda _: REMEDY),)

    def label(self, scene):
        return scene.hinges[self.hinge].joint

    def acts_on(self):
        return self.hinge, self.hinge + 1, self.hinge + 2

    def check(self, scene):
        super().check(scene)
        self.check_alone(scene)
        title = self.title(scene)
        if self.restitution > 1:
            raise SceneError(f"restitution of {title}", self.restitution, "above 0 and at most 1")
        if self.friction and not self.radius:
            raise SceneError(f"radius of {title}", self.radius, "above 0 m, with friction")
        start = float(np.hypot(*(scene.hinges[h].opening for h in self.acts_on()[1:])))
        most = self.clearance + self.depth
        if start > most * (1 + 1e-9):
            allowed = f"at most {most:.4g} m from the axis, its clearance and its depth at `load`"
            raise SceneError(f"place of {title} at the start", start, allowed)

    @property
    def hysteresis(self) -> float:
        """Return the damping factor c that gives the restitution."""
        from scipy.optimize import brentq

        r = self.restitution
        if 1 - r < 1e-3:
            return 1.5 * (1 - r) / (1 - r + r * r)
        balance = lambda c: np.log((1 + c) / (1 - r * c)) - (1 + r) * c  # noqa: E731
        most = (1 - 1e-12) / r
        return brentq(balance, 0.5 * (1 - r), most) if balance(most) > 0 else most

    @property
    def stiffness(self) -> float:
        """Stiffness (N/m) at the load."""
        return (1.5 if self.law == "hertz" else 1.0) * self.load / self.depth

    def bristle(self, scene) -> tuple[float, float]:
        """Return stiffness (N/m) and damping (N s/m) of the bristle. scene: has the joint."""
        stiffness = self.friction * self.load / self.bristle_deflection
        turn, *sides = (mobility(scene, h) for h in self.acts_on())
        soft = max(sides) + self.radius**2 * turn
        return stiffness, 2 * DAMPING_RATIO * np.sqrt(stiffness / soft) if soft else 0.0

    @classmethod
    def deformations(cls, scene):
        """On x and y; and on the turn of bristles, whose slip is a sum."""
        values = [(FINER**2 * pin.stiffness, pin.bristle(scene)[0]) for pin in cls.find(scene)]
        return cls._springs(scene, values)

    @classmethod
    def dampings(cls, scene):
        values = []
        for pin in cls.find(scene):
            soft = max(mobility(scene, h) for h in pin.acts_on()[1:])
            damping = pin.hysteresis * np.sqrt(pin.stiffness / soft) if soft else 0.0
            values.append((damping, pin.bristle(scene)[1]))
        return cls._springs(scene, values) if np.any(values) else None

    @classmethod
    def _springs(cls, scene, values) -> Deformations:
        """Make springs (or dampers) on x, y and turn of each pin, for the stable step, from
        `values`: one for the pressing and one for the slipping direction."""
        hinges = [h for pin in cls.find(scene) for h in pin.acts_on()]
        factors = [
            x
            for pin, (press, slip) in zip(cls.find(scene), values, strict=True)
            for x in (2 * pin.radius**2 * slip, press + 2 * slip, press + 2 * slip)
        ]
        springs = relative_turn(scene, hinges, factors)
        return springs._replace(element=springs.element // 3)

    @classmethod
    def array(cls, name, batch):
        if name == "numbers":
            rows = lambda s: [_numbers(s, pin) for pin in cls.find(s)]  # noqa: E731
            return batch.stack(len(cls.find(batch.scene)), cls.kernels().NUMBERS, rows)
        if name == "state":
            return batch.stack(len(cls.find(batch.scene)), cls.kernels().STATE, _start)
        return super().array(name, batch)


def _numbers(scene, pin: Journal) -> list[float]:
    """Constants of a pin for the kernels."""
    hertz, stiffness = float(pin.law == "hertz"), pin.bristle(scene)
    constants = pin.clearance, pin.load, 1 / pin.depth, hertz, pin.hysteresis, pin.friction
    return [*constants, pin.radius, *stiffness, pin.bristle_deflection / pin.load]


def _start(scene) -> np.ndarray:
    """State of a scene's pins at t = 0: rates (m/s) of eccentricity and slip."""
    from fpm.elements.openings.journal_kernels import RATE, SLIP_RATE, STATE

    state = np.zeros((len(Journal.find(scene)), STATE))
    for row, pin in zip(state, Journal.find(scene), strict=True):
        place = np.array([scene.hinges[h].opening for h in pin.acts_on()[1:]])
        turn, *velocity = turning_at_start(scene, pin.acts_on())
        size = np.linalg.norm(place)
        axis = place / size if size else np.zeros(2)
        row[RATE] = axis @ velocity if size else np.linalg.norm(velocity)
        row[SLIP_RATE] = axis[0] * velocity[1] - axis[1] * velocity[0] + pin.radius * turn
    return state
