"""Latches on hinges: they catch at an opening, and hold from then on by a spring and a damper.

A latch catches when the opening comes within `tolerance` of its `angle` from the `side` it looks
to, if it turns no faster than `fastest` then; if it is faster, as soon as it has become slower
while still within the tolerance; and if it leaves there too fast, the latch has missed. It holds at
the opening psi_c at which it caught, so that nothing jumps: before, there is no moment; afterwards

    -k (psi - psi_c) - c dpsi/dt                  both ways, or
    k s + max(c ds/dt, -k s),  s = psi_c - psi    `one_sided`: only against going back, where s > 0

(for one that catches on the way up). A latch without stiffness is rigid (rigid_latch.py).
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.kind import Energy, Recorded
from fpm.elements.openings.opening import (
    JOINT_LOSS,
    ONSET,
    OnHinge,
    Opening,
    by_unit,
    check_numbers,
    check_stiffness,
    pack_past,
    unit_of,
)
from fpm.errors import SceneError

SIDES = {"below": 1.0, "above": -1.0, "either": 0.0}
"""From where the opening comes when it is caught."""

RECORDED = {
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
class Latch(OnHinge):
    """hinge index; angle, tolerance (rad); side ("below", "above", "either"); fastest (rad/s);
    stiffness k (N m/rad); damping c (N m s/rad); one_sided; name (that of the hinge if "").
    """

    hinge: int
    angle: float
    stiffness: float
    damping: float = 0.0
    tolerance: float = 0.0
    side: str = "either"
    fastest: float = np.inf
    one_sided: bool = False
    name: str = ""

    stores = Energy("latch", "latch_energy", "energy of the latches")
    takes = JOINT_LOSS
    events = ("latches", "misses")
    acts_as = "latch"
    called = "latch"

    def check(self, scene):
        """Hinge, numbers, and a label that no other latch has."""
        check_stiffness(scene, "latch", self.hinge, self.stiffness)
        check_numbers("latch", scene, self.hinge, damping=(self.damping, 0.0, "N m s/rad"))
        check_catching(scene, self)

    def label(self, scene) -> str:
        """Its name in messages and files."""
        return self.name or scene.hinges[self.hinge].name

    def topology(self):
        """The hinge and the name."""
        return self.hinge, self.name

    def damping_in(self, scene):
        """Its damper begins with more than a kick."""
        return ONSET * self.damping

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings.latch_kernels import LATCH, STATE, TRACK, Latches

        def constants(x):
            one_sided = -1.0 if x.one_sided else 1.0
            return [x.angle, x.tolerance, SIDES[x.side], x.fastest, x.stiffness, x.damping,
                    one_sided]  # fmt: skip

        latches = cls.of(batch.one)
        return Latches(
            on=batch.integers(x.hinge for x in latches),
            latch=batch.table(cls, LATCH, constants),
            openings=Opening.seen_by(cls, batch),
            past=pack_past(batch, cls),
            state=batch.blank(len(latches), STATE),
            account=batch.taken_by(cls),
            rows=batch.rows_of(cls),
            log=batch.log_of(cls),
            track=batch.blank((batch.instants + 1) * len(latches), TRACK),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """Moments, impulses, and rates of the openings when they caught."""
        return recorded_of(cls, scene, part.track[:, :, lane])


def check_catching(scene, latch) -> None:
    """SceneError unless a latch of either kind has numbers, and a label that no other has."""
    check_numbers(
        "latch",
        scene,
        latch.hinge,
        angle=(latch.angle, -np.inf, "rad"),
        tolerance=(latch.tolerance, 0.0, "rad"),
    )
    if not latch.fastest > 0:
        unit = unit_of(scene, latch.hinge, "rad/s")
        raise SceneError("fastest rate of latch", latch.fastest, f"a number > 0 ({unit})")
    if latch.side not in SIDES:
        raise SceneError("side of latch", latch.side, ", ".join(SIDES))
    if latch.label(scene) in [other.label(scene) for other in latch.alike(scene)]:
        raise SceneError("latch", latch.label(scene), "a name that no other latch has")


def recorded_of(kind, scene, track: np.ndarray) -> dict[str, Recorded]:
    """Moments, impulses, rates, and those with which they caught if they do so at once, of latches
    of a kind out of ((instants + 1) l, 3 or 4).
    """
    latches = kind.of(scene)
    columns = track.T.reshape(track.shape[1], -1, len(latches))
    pairs = zip(RECORDED.items(), columns, strict=False)
    found = {name: Recorded(values, *text[:3], ()) for (name, text), values in pairs}
    hinges = [scene.hinges[latch.hinge] for latch in latches]
    return by_unit(found, hinges, [latch.label(scene) for latch in latches])
