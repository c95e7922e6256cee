"""Joints that are solved together: those that share bodies, and those that are no hinges.

A hinge whose two particles nothing else uses is solved alone (hinge.py), which is cheaper. All
other hinges, and spherical, universal, prismatic and fixed joints, go here: their impulses are
found from one system of equations for the whole structure (joint_matrix.py). A particle is a rigid
body with a mass and three inertias, and joints sit at the ends of its virtual beams; so these are
the joints of rigid bodies as well. Redundant conditions, as rigid loops have them, do no harm where
they agree; the impulses are then the smallest that keep the joints closed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.fields import Number, check_number
from fpm.elements.joints import joint_arrays as at
from fpm.elements.joints.hinge import (
    ANGLES,
    Hinge,
    Joined,
    alone,
    arms,
    gap_watches,
    held_axes,
    places_of,
    two_of,
    unit,
)
from fpm.elements.joints.hinge_arrays import SUMS
from fpm.elements.joints.turn import Turn
from fpm.elements.kind import AXES
from fpm.elements.openings.opening import opening_at
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.gravity import LOAD_WORK
from fpm.elements.particles.turning import turns_of
from fpm.errors import SceneError


class JointType(NamedTuple):
    """What a joint of a type keeps together: its number (joint_arrays.py), and how many conditions
    it has; None: it cannot be stated as a joint of two particles."""

    number: int
    conditions: int | None = None


TYPES = {
    "revolute": JointType(at.REVOLUTE, 5),
    "spherical": JointType(at.SPHERICAL, 3),
    "fixed": JointType(at.FIXED, 6),
    "universal": JointType(at.UNIVERSAL, 4),
    "prismatic": JointType(at.PRISMATIC, 5),
    "held": JointType(at.HELD),
    "opening": JointType(at.OPENING),
    "slid": JointType(at.SLID),
}
"""The types of joints, by name."""

EASE = {8: 1e-10, 4: 1e-5}
"""Share by which the diagonal is raised, by the bytes of a number."""


@dataclass(frozen=True)
class Joint(Joined):
    """A joint between the free ends of two virtual beams.

    type: one of TYPES. axes (2, 3): the axis in each particle's own frame, one and the same but for
    universal joints, where they are normal to each other; references (2, 3): a direction normal to
    the axis in each frame, one and the same at the start. A type of "held" has one virtual beam,
    whose end is held along the global axes `held`.
    """

    name: str
    type: str
    beams: tuple[VirtualBeam, ...]
    axes: np.ndarray
    references: np.ndarray
    held: str = ""

    gives = LOAD_WORK
    gaps: ClassVar = {
        "joint_gap": "largest gap between the points of a joint",
        "joint_axis_gap": "largest angle between the axes of a joint",
    }
    watches = gap_watches(
        "joint",
        "joint_gap",
        "joint_tilt",
        "halve solver.step if bodies turn far in a step; or the joints contradict each other: "
        "rigid bodies in a loop can only move if lengths and axes fit",
    )

    @staticmethod
    def between(scene, name, type, particles, point, axis=(1, 0, 0), other=None) -> "Joint":
        """A joint between two particles of a scene, where it stands (Scene.add_joint)."""
        allowed = [name for name, found in TYPES.items() if found.conditions]
        if type not in allowed:
            raise SceneError(f"type of joint {name}", type, f"one of {', '.join(allowed)}")
        pair = two_of(scene, particles, f"joint {name}")
        axis = unit(axis, f"axis of joint {name}")
        across = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]), "reference")
        along = axis
        if type == "universal":
            along = across if other is None else unit(other, f"second axis of joint {name}")
            if abs(along @ axis) > 1e-9:
                raise SceneError(f"axes of joint {name}", (axis, along), "normal to each other")
        frames = [scene.frame[p].T for p in pair]
        return Joint(
            name,
            type,
            arms(scene, pair, point),
            axes=np.array([frames[0] @ axis, frames[1] @ along]),
            references=np.array([frame @ across for frame in frames]),
        )

    @staticmethod
    def slide(scene, name, particles, point, axis, opening: float) -> Hinge:
        """A slide with its opening (m) between two particles of a scene (Scene.add_slide)."""
        joint = Joint.between(scene, name, "prismatic", particles, point, axis)
        check_number(f"opening of slide {name}", opening, Number(), "m")
        found = Hinge(
            name, joint.beams, joint.axes, joint.references, 0.0, "", "prismatic", float(opening)
        )
        return replace(found, opening=opening_at(scene, found))

    @staticmethod
    def crossed(scene, name, particles, point, axis, other, openings) -> tuple[Hinge, Hinge]:
        """The two angles (rad) of a universal joint (Scene.add_universal)."""
        joint = Joint.between(scene, name, "universal", particles, point, axis, other)
        one, two = (scene.frame[p] @ a for p, a in zip(joint.particles, joint.axes, strict=True))
        found = []
        # The second is stated from the second particle to the first, about the opposite axis.
        for k, (about, to) in enumerate(((one, two), (-two, one))):
            check_number(f"opening of universal joint {name}", openings[k], Number(), "rad")
            zero = np.cos(openings[k]) * to - np.sin(openings[k]) * np.cross(about, to)
            beams = joint.beams[:: -1 if k else 1]
            frames = [scene.frame[beam.particle].T for beam in beams]
            found.append(
                Hinge(
                    name + ANGLES[k],
                    beams,
                    axes=np.array([frame @ about for frame in frames]),
                    references=np.array([frames[0] @ zero, frames[1] @ to]),
                    opening=float(openings[k]),
                    support="",
                    type=("universal", "cross")[k],
                )
            )
        return tuple(found)

    @staticmethod
    def holding(scene, name, particle: int, point, held: str) -> "Joint":
        """A point of a particle that is held along global axes, where it is."""
        if not held or set(held) - set(AXES):
            raise SceneError(f"axes of support {name}", held, "letters out of 'xyz'")
        none = np.zeros((2, 3))
        return Joint(name, "held", (scene.arm_to(particle, point),), none, none, held)

    @property
    def conditions(self) -> int:
        """How many it has."""
        return 1 if self.holds_opening else TYPES[self.type].conditions or len(self.held)

    @property
    def holds_opening(self) -> bool:
        """Whether it holds the opening of a hinge, and keeps nothing together itself."""
        return self.type in ("opening", "slid")

    def topology(self):
        """Name, type, particles and held axes."""
        return self.name, self.type, self.particles, self.held

    @classmethod
    def of(cls, scene):
        """Those stated as such, the hinges that are not alone, and what holds openings."""
        found = list(scene.kinds.get(cls, []))
        for hinge, lone in zip(scene.hinges, alone(scene), strict=True):
            if not lone:
                found += as_joints(hinge)
        for holder in Turn.of(scene):
            hinge = scene.hinges[holder.hinge]
            name = f"{hinge.name} (its {holder.called})"
            type, beams = "opening", hinge.beams
            if hinge.slides:
                pairs = zip(beams, hinge.ends, strict=True)
                type, beams = "slid", tuple(VirtualBeam(beam.particle, end) for beam, end in pairs)
            found.append(Joint(name, type, beams, hinge.axes, hinge.references))
        return found

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints import joint_kernels, turn_kernels  # noqa: F401, their hooks
        from fpm.elements.joints.joint_pattern import elimination, neighbours, pattern

        one, joints = batch.one, cls.of(batch.one)
        on = sorted(set(cls.moved(one)))
        slot = {p: s for s, p in enumerate(on)}
        slots = np.array([[*(slot[p] for p in j.particles), -1][:2] for j in joints], np.int64)
        movable = ~one.fixed[on].all(axis=1)
        order, below = elimination(neighbours(slots, movable))
        joints, slots = [joints[j] for j in order], slots[order]
        found, entries = pattern([j.conditions for j in joints], slots, movable, below)
        driven = set(Drive.moved(one))
        conditions, rows = sum(j.conditions for j in joints), batch.instants + 1
        coupled = at.Joints(
            types=batch.integers(TYPES[j.type].number for j in joints),
            names=batch.integers(order),
            slots=slots.ravel(),
            sides=batch.stack(2 * len(joints), at.SIDE, lambda s: _sides(s, order)),
            places=batch.stack(len(joints), 3, lambda s: places_of(s, cls.of(s))[order]),
            held=batch.integers([held_axes(j.held) for j in joints], 3),
            on=batch.integers(on),
            driven=batch.integers(p in driven for p in on),
            bodies=batch.stack(len(on), at.BODY, lambda s: _bodies(s, on)),
            body_scratch=batch.blank(len(on), at.BODY_SCRATCH),
            rows=batch.blank(conditions, at.ROW),
            matrix=batch.blank(entries, 1),
            pattern=found,
            ease=EASE[np.dtype(batch.dtype).itemsize],
            account=batch.given_by(cls),
            watched=batch.watched_by(cls),
            excess=batch.rows_of(cls),
            gaps=batch.blank(rows, 2),
        )
        if cls.are_impulses_read(one):
            sums, forces = batch.blank(conditions, 1), batch.blank(rows * len(joints), SUMS)
            coupled = coupled._replace(sums=sums, forces=forces)
        if not (turns := len(Turn.of(one))):
            return coupled
        first = len(joints) - turns
        return at.TurnedJoints(*coupled)._replace(
            turns=batch.part(Turn),
            turn_of=batch.integers(max(number - first, -1) for number in order),
            turn_at=batch.integers(order.index(first + t) for t in range(turns)),
        )


def as_joints(hinge: Hinge) -> Sequence[Joint]:
    """A hinge as a joint, and its support as another; of a universal joint's angles the first."""
    if hinge.type == "cross":
        return []
    name, axes = hinge.joint, hinge.axes
    if hinge.type == "universal":
        axes = np.array([axes[0], hinge.references[1]])
    joint = Joint(name, hinge.type, hinge.beams, axes, hinge.references)
    if not hinge.support:
        return [joint]
    none = np.zeros((2, 3))
    name = f"{hinge.name} (its support)"
    return [joint, Joint(name, "held", hinge.beams[:1], none, none, hinge.support)]


def _sides(scene, order) -> np.ndarray:
    joints = Joint.of(scene)
    out = np.zeros((2 * len(order), at.SIDE))
    for i, number in enumerate(order):
        joint = joints[number]
        for k, beam in enumerate(joint.beams):  # ARM, AXIS, REFERENCE
            out[2 * i + k] = np.concatenate([beam.arm, joint.axes[k], joint.references[k]])
    return out


def _bodies(scene, on) -> np.ndarray:
    free = ~scene.fixed[on]
    # Moments on driven bodies change nothing, but they do work.
    driven = np.isin(on, Drive.moved(scene))[:, None]
    inverse_mass = free[:, :3] / scene.mass[on][:, None]
    inverse_inertia = free[:, 3:].any(axis=1)[:, None] / turns_of(scene).inertia[on]
    root, turns = np.sqrt(inverse_inertia), free[:, 3:] | driven
    return np.hstack([inverse_mass, inverse_inertia, root, turns])  # HIM, HIJ, ROOT, TURNS
