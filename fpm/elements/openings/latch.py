"""Latches on hinges: they catch at an opening, and hold from then on by a spring and a damper.

A latch catches when the opening comes within `capture_range` of its `angle` from the `side` it
looks to, if it turns no faster than `max_capture_rate` then; if it is faster, as soon as it has
become slower while still within that range; and if it leaves there too fast, the latch has missed.
Where a run starts within that range, or at the very angle, it catches at the start. It holds at the
opening psi_c at which it caught, so that nothing jumps.

Theory: docs/mechanics.md, "On hinges: dampers, friction" and, without stiffness, "Openings that are
held exactly"."""

from dataclasses import dataclass

import numpy as np

from fpm.declare import damping, number, stiffness, topology, word
from fpm.elements.joints.turn import ExactConnector
from fpm.elements.kind import Energy, Gate, Series
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    by_unit,
    on_hinge,
    start_angles,
    struck_stiffness,
)
from fpm.errors import SceneError

SIDES = {"below": 1.0, "above": -1.0, "either": 0.0}
"""From where the opening comes when it is caught."""

SERIES = {
    "latch_moment": ("N m", "moment of the latches", "latch", "moment"),
    "latch_impulse": ("N m s", "angular impulse of the latches so far", "latch", "impulse so far"),
    "latch_rate": (
        "rad s-1", "rate of the opening when it was caught; 0 before", "latch", "rate at the catch",
    ),
    "latch_impact": (
        "N m s", "angular impulse with which a rigid latch caught; 0 before", "rigid_latch",
        "impulse at the catch",
    ),
}  # fmt: skip
"""Unit, long name and dimension of what is recorded of latches, and words for that of one; on
slides names and units are others (opening.by_unit)."""


@dataclass(frozen=True)
class Latch(ExactConnector):
    """Catches a joint at an opening and holds it from then on.

    It does so by a spring and a damper, or exactly, where the opening passes `angle`. One that
    holds one way lets the opening go on in the direction of the catch, as a ratchet. name: "": the
    hinge's. On slides m for rad, N for N m."""

    hinge: int = on_hinge()
    angle: float = number("rad", text="opening at which it catches")
    stiffness: float | None = stiffness(
        default=None, text="stiffness with which it holds; default: it holds exactly"
    )
    damping: float = damping(default=0.0, text="damping with which it holds")
    capture_range: float = number(
        "rad",
        0.0,
        default=0.0,
        zero=False,
        text="distance from `angle` within which it also catches",
    )
    side: str = word(SIDES, default="either", text="side from which the opening approaches `angle`")
    max_capture_rate: float = number(
        "rad/s", above=0.0, finite=False, default=np.inf, words="largest capture rate of {title}",
        text="rate above which the latch does not catch",
    )  # fmt: skip
    holds: str = word(
        {"both ways": 1.0, "one way": -1.0},
        default="both ways",
        text="`one way`: it resists only the motion back",
    )
    name: str = topology("")

    stores = Energy("latch", "latch_energy", "energy of the latches")
    takes = JOINT_LOSS
    events = ("latches", "misses")
    acts_as = "latch"
    onset = ONSET
    noun = "latch"

    def check(self, scene):
        super().check(scene)
        if self.label(scene) in [latch.label(scene) for latch in Latch.find(scene)]:
            raise SceneError("latch", self.label(scene), "a name that no other latch has")

    def label(self, scene):
        return self.name or super().label(scene)

    def gate(self):
        largest_rate = self.max_capture_rate if np.isfinite(self.max_capture_rate) else 0.0
        return Gate(self.angle, SIDES[self.side], self.capture_range, largest_rate)

    def stiffness_in(self, scene):
        return struck_stiffness(self) if self.is_ratchet else self.stiffness

    @property
    def is_ratchet(self) -> bool:
        """Whether it holds one way only."""
        return self.holds == "one way"

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints import rigid_latch_kernels  # noqa: F401, its hooks

        return super().pack(batch)

    @classmethod
    def array(cls, name, batch):
        """In "state", SEARCH_END, up to which a latch has looked, is the opening at the start."""
        array = super().array(name, batch)
        if name == "state":
            array[:, cls.kernels().SEARCH_END] = start_angles(batch, cls)
        return array

    @classmethod
    def read_records(cls, part, scene, lane):
        latches, result = cls.find(scene), {}
        columns = part.track[:, :, lane].T.reshape(part.track.shape[1], -1, len(latches))
        for (name, text), values in zip(SERIES.items(), columns, strict=True):
            indices = [i for i, e in enumerate(latches) if e.is_exact or name != "latch_impact"]
            series = {name: Series(values[:, indices], *text[:3], ())}
            hinges = [scene.hinges[latches[i].hinge] for i in indices]
            result |= by_unit(series, hinges, [latches[i].label(scene) for i in indices])
        return result
