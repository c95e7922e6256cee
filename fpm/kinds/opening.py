"""Openings of hinges: the angles that springs, contacts and their like act on.

An opening is the angle about a hinge's axis between a reference direction of either particle. It
grows when the second turns by the right-hand rule about the axis against the first, and it counts
full turns: of all angles that differ by them it is the one closest to the last.
"""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import ClassVar

import numpy as np

from fpm.cross import cross
from fpm.errors import SceneError
from fpm.kinds.kind import Deformations, Energy, Kind, Recorded, rows_of
from fpm.kinds.probe import Probe

JOINT_LOSS = Energy("joint_loss", "joint_loss", "energy lost on joints: friction, dampers, impacts")
"""The account of all kinds that lose energy on openings."""

ONSET = 1.5
"""Largest share of a kick with which a damper begins (losses_kernels.onset): counted in the stable
step, so that an impact is not thrown back by its damper alone.
"""


PARTS = (
    "spring", "contact", "damper", "friction", "stop", "latch", "motor", "release", "loop", "other",
)  # fmt: skip
"""Parts of the moment on an opening, by the kinds that act on it (Kind.acts_as)."""


@dataclass(frozen=True)
class Opening(Kind):
    """The opening of a hinge; nothing states it, every hinge of a scene has one, with its index."""

    @classmethod
    def of(cls, scene):
        return scene.hinges

    @classmethod
    def topology_of(cls, scene):
        """Names and particles of all hinges, as openings go by their index."""
        return tuple((hinge.name, hinge.particles) for hinge in scene.hinges)

    @classmethod
    def pack(cls, batch):
        from fpm.kinds.opening_kernels import SIDE, TOLD, Openings, ToldOpenings

        hinges = batch.one.hinges
        rows = batch.instants + 1
        openings = Openings(
            ends=batch.integers(p for hinge in hinges for p in hinge.particles),
            sides=batch.stack(2 * len(hinges), SIDE, _sides),
            angles=batch.table(cls, 2, lambda hinge: [hinge.opening] * 2),
            followed=batch.is_read(cls),
            track=batch.blank(rows * len(hinges), 1),
        )
        if not Probe.asked(batch.one).moments:
            return openings
        count = len(hinges) * len(PARTS)
        return ToldOpenings(
            *openings,
            which=PARTS.index("other"),
            parts=len(PARTS),
            told=batch.blank(count, TOLD),
            told_track=batch.blank(rows * count, 2),
        )

    @classmethod
    def seen_by(cls, kind: type[Kind], batch):
        """The arrays of all openings as a kind that acts on them gets them."""
        openings = batch.part(cls)
        if Probe.asked(batch.one).moments and kind.acts_as:
            return openings._replace(which=PARTS.index(kind.acts_as))
        return openings

    @classmethod
    def recorded(cls, part, scene, lane):
        """The openings."""
        names = tuple(hinge.name for hinge in scene.hinges)
        values = part.track[:, 0, lane].reshape(-1, len(names))
        return {"opening": Recorded(values, "rad", "opening of the hinges", "hinge", names)}


class OnHinge(Kind):
    """What the kinds that act on the opening of one hinge, of index `hinge`, have in common."""

    called: ClassVar[str]  # in messages, before the hinge's name
    reads = (Opening,)

    def topology(self):
        """The hinge."""
        return self.hinge

    @classmethod
    def names(cls, scene):
        return [f"{cls.called} {scene.hinges[e.hinge].name}" for e in cls.of(scene)]

    def stiffness_in(self, scene) -> float | None:
        """Stiffness (N m/rad) that counts in the stable step; None: the kind has no springs."""
        return getattr(self, "stiffness", None)

    def damping_in(self, scene) -> float | None:
        """Damping (N m s/rad) that counts in the stable step; None: the kind has no dampers."""
        return getattr(self, "damping", None)

    @classmethod
    def deformations(cls, scene):
        """The openings of their hinges, as if all acted."""
        return cls._turns(scene, [e.stiffness_in(scene) for e in cls.of(scene)])

    @classmethod
    def dampings(cls, scene):
        """The same for their dampers."""
        return cls._turns(scene, [e.damping_in(scene) for e in cls.of(scene)])

    @classmethod
    def _turns(cls, scene, values: list) -> Deformations | None:
        on = [e.hinge for e in cls.of(scene)]
        return None if None in values else relative_turn(scene, on, values)


def _sides(scene) -> np.ndarray:
    """Axis and reference (2h, 6) of either side of every hinge."""
    sides = [np.hstack([hinge.axes, hinge.references]) for hinge in scene.hinges]
    return np.concatenate(sides)


def relative_turn(scene, on, stiffness) -> Deformations:
    """The deformations of elements that are strained by the openings `on` (indices)."""
    hinges, zero = [scene.hinges[h] for h in on], np.zeros(3)
    values = [np.concatenate([zero, -h.axes[0], zero, h.axes[1]]) for h in hinges]
    return rows_of([h.particles for h in hinges], values, stiffness)


def check_stiffness(scene, what: str, hinge: int, stiffness: float, unit="N m/rad") -> None:
    """SceneError unless `what` of a stiffness in a unit can act on a hinge of that index."""
    check_hinge(scene, what, hinge)
    if not (np.isfinite(stiffness) and stiffness >= 0):
        raise SceneError(f"{what} stiffness", stiffness, f"a finite number >= 0 ({unit})")


def check_hinge(scene, what: str, hinge: int) -> None:
    """SceneError unless there is a hinge of that index for `what`."""
    count = len(scene.hinges)
    if not 0 <= hinge < count:
        raise SceneError(f"hinge of {what}", hinge, f"0 to {count - 1}")


def softness(scene, hinge: int) -> float:
    """Inverse inertia (1/kg m²) against which a moment about a hinge of that index turns it."""
    found = scene.hinges[hinge]
    free = [~scene.fixed[p, 3:] / scene.inertia[p] for p in found.particles]
    return float(sum(axis**2 @ inverse for axis, inverse in zip(found.axes, free, strict=True)))


def turning_at_start(scene, on) -> list[float]:
    """Rates (rad/s) of the openings `on` (indices) at the start, also of driven particles."""
    spin = np.where(scene.fixed[:, 3:], 0.0, scene.spin)
    motion = SimpleNamespace(velocity=np.zeros_like(spin), spin=spin)
    motion.position, motion.frame = scene.position.copy(), scene.frame.copy()
    for kind in scene.kinds:
        kind.prescribe(scene, 0.0, motion)
    hinges = [scene.hinges[h] for h in on]
    axes = [scene.frame[h.particles[0]] @ h.axes[0] for h in hinges]
    return [
        float(axis @ (motion.spin[h.particles[1]] - motion.spin[h.particles[0]]))
        for h, axis in zip(hinges, axes, strict=True)
    ]


def pack_past(batch, kind) -> np.ndarray:
    """What is kept of the motion for losses (losses_kernels.py) of a kind's elements."""
    from fpm.kinds.losses_kernels import PAST

    count = len(kind.of(batch.one))

    def past(scene):
        rates = turning_at_start(scene, [element.hinge for element in kind.of(scene)])
        return np.column_stack([rates, np.zeros((count, PAST - 1))])

    return batch.stack(count, PAST, past)


def check_numbers(what: str, **limits) -> None:
    """SceneError unless each number, by key=(value, least, unit), is finite and >= least."""
    for key, (value, least, unit) in limits.items():
        if not (np.isfinite(value) and value >= least):
            allowed = f"a finite number >= {least:g}" if least > -np.inf else "a finite number"
            raise SceneError(f"{key.replace('_', ' ')} of {what}", value, f"{allowed} ({unit})")


def opening_angle(axis, first, second, near: float) -> float:
    """Angle (rad) from `first` to `second` about `axis`, on the turn closest to `near`."""
    angle = np.arctan2(np.dot(axis, cross(first, second)), np.dot(first, second))
    return float(angle + 2 * np.pi * np.round((near - angle) / (2 * np.pi)))
