"""Joints that are solved together: those that share bodies, and those that are no hinges.

Theory: docs/mechanics.md, "Joints that are solved together". A hinge whose two particles nothing
else uses is solved alone (hinge.py), which is cheaper."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fpm.declare import NumberLimits
from fpm.elements.batch import turns_of
from fpm.elements.joints import joint_arrays as arrays
from fpm.elements.joints.hinge import (
    Hinge,
    JointBase,
    are_alone,
    arms,
    gap_watches,
    places_of,
    two_of,
    unit,
)
from fpm.elements.joints.hinge_arrays import SUMS
from fpm.elements.joints.joint_types import SUFFIXES, TYPES
from fpm.elements.joints.turn import Turn
from fpm.elements.kind import AXES, VirtualBeam
from fpm.elements.openings.opening import opening_at
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.load import LOAD_WORK
from fpm.errors import SceneError

CONDITION, MULTIPLY_ADD = 240.0, 1.5
"""Core time (ns) of a condition in a step, and of each multiply-add of the elimination: from
chains, pairs, and platforms on 2 to 30 cranks."""


EASE = 1e-10
"""Share by which the diagonal is raised."""


_BURST = 1.0
"""Gap (m) of a joint that no drift reaches in a step: nothing closes it any more."""


def _describe_singularity(scene, element: str, values: dict[str, float]) -> tuple[str, str, bool]:
    """Describe a loop of joints that no longer closes (Watch.dead_end): the shortest that the
    joint `element` forms, in which fixed particles count as one body."""
    name = element.removeprefix("joint ")
    ground = {p for p in range(len(scene.mass)) if scene.fixed[p].all()}
    sides = {
        joint.name: [-1 if p in ground else p for p in (*joint.particles, -1)[:2]]
        for joint in Joint.find(scene)
        if not joint.holds_opening
    }
    start, goal = sides.pop(name, (-1, -1))
    paths, bodies = {start: [name]}, [start]
    for body in bodies:  # which grows
        for other_name, pair in sides.items():
            if body in pair and (neighbour := pair[pair[0] == body]) not in paths:
                paths[neighbour] = [*paths[body], other_name]
                bodies.append(neighbour)
    *joints, last = paths.get(goal, [name])
    subject = f"joint {last}"
    if joints:
        subject = (
            f"the loop of joints {', '.join(joints)} and {last} reaches a singular position and"
        )
    return (
        f"{subject} can no longer be closed",
        "no shorter step helps: change the loop's lengths or its motion, or state joints whose "
        "lengths and axes fit",
        bool(joints) and not values["joint_gap"] < _BURST,
    )


@dataclass(frozen=True)
class Joint(JointBase):
    """A joint between the free ends of two virtual beams (rigid arms from particles). name: no
    other joint's; type: a key of TYPES, as "fixed"; beams: the arms; axes (2, 3): the axis in each
    particle's frame, the same but for universal joints, where they are normal to each other;
    references (2, 3): a direction normal to the axis in each frame, the same at the start; lead: of
    a screw (m/rad). A "held" joint has one virtual beam, held at its end along global axes
    `support_axes`, as "xz"; a second one, to a driven particle that does not turn, leads it along
    them."""

    name: str
    type: str
    beams: tuple[VirtualBeam, ...]
    axes: np.ndarray
    references: np.ndarray
    support_axes: str = ""
    lead: float = 0.0

    gives = LOAD_WORK
    gaps: ClassVar = {
        "joint_gap": "largest gap between the points of a joint",
        "joint_axis_gap": "largest angle between the axes of a joint",
    }
    watches = gap_watches(
        "joint",
        "joint_gap",
        "joint_tilt",
        "halve solver.step (auto does, and finds out if it helps); or the joints contradict each "
        "other: rigid bodies in a loop can only move if lengths and axes fit",
        _describe_singularity,
    )

    @staticmethod
    def create(scene, name, type, particles, point, axis=(1, 0, 0), axis2=None) -> "Joint":
        """Return a joint between two particles of a scene as placed now (`Scene.add_joint`)."""
        allowed = "revolute", "spherical", "fixed", "universal", "prismatic"
        if type not in allowed:
            raise SceneError(f"type of joint {name}", type, f"one of {', '.join(allowed)}")
        pair = two_of(scene, particles, f"joint {name}")
        axis = unit(axis, f"axis of joint {name}")
        normal = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]), "reference")
        axis_2 = axis
        if type == "universal":
            axis_2 = normal if axis2 is None else unit(axis2, f"second axis of joint {name}")
            if abs(axis_2 @ axis) > 1e-9:
                raise SceneError(f"axes of joint {name}", (axis, axis_2), "normal to each other")
        frames = [scene.frame[p].T for p in pair]
        return Joint(
            name,
            type,
            arms(scene, pair, point),
            axes=np.array([frames[0] @ axis, frames[1] @ axis_2]),
            references=np.array([frame @ normal for frame in frames]),
        )

    @staticmethod
    def create_openings(scene, name, type, particles, point, axis, x, openings, lead=0.0) -> tuple:
        """Return all openings (joint coordinates) of a joint between two particles of a scene as
        placed now, each a Hinge, not added to it. Arguments: as of `Scene.add_sliding_joint`."""
        pair = two_of(scene, particles, f"joint {name}")
        axis = unit(axis, f"axis of joint {name}")
        x = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]) if x is None else x, "x")
        if abs(x @ axis) > 1e-9:
            raise SceneError(f"x of joint {name}", x, "a direction normal to the axis")
        if type == "screw" and not (np.isfinite(lead) and lead):
            raise SceneError(f"lead of joint {name}", lead, "a finite number (m/rad) that is not 0")
        frames, beams = [scene.frame[p].T for p in pair], arms(scene, pair, point)
        directions, hinges = {"axis": axis, "x": x, "y": np.cross(axis, x)}, []
        for number, (suffix, direction) in enumerate(TYPES[type].openings):
            opening = float(openings[number])
            unit_text = "m" if direction else "rad"
            NumberLimits(unit=unit_text).check(f"opening of joint {name}{suffix}", opening)
            ends = (x, x) if direction == "axis" else (axis, axis)
            if not direction:
                ends = x, np.cos(opening) * x + np.sin(opening) * directions["y"]
            hinge = Hinge(
                name + suffix,
                beams,
                axes=np.array([frame @ directions[direction or "axis"] for frame in frames]),
                references=np.array([f @ end for f, end in zip(frames, ends, strict=True)]),
                opening=opening,
                support="",
                type=type,
                offset=opening if direction else lead * opening,
                number=number,
                lead=lead,
            )
            hinges.append(replace(hinge, opening=opening_at(scene, hinge)) if direction else hinge)
        return tuple(hinges)

    @staticmethod
    def universal(scene, name, particles, point, axis, axis2, openings) -> tuple[Hinge, ...]:
        """Return both angles of a universal joint, each a Hinge (`Scene.add_universal`)."""
        joint = Joint.create(scene, name, "universal", particles, point, axis, axis2)
        u, w = (scene.frame[p] @ a for p, a in zip(joint.particles, joint.axes, strict=True))
        hinges = []
        # The second is stated from the second particle to the first, about the opposite axis.
        for k, (e, to_zero) in enumerate(((u, w), (-w, u))):
            NumberLimits(unit="rad").check(f"opening of universal joint {name}", openings[k])
            zero = np.cos(openings[k]) * to_zero - np.sin(openings[k]) * np.cross(e, to_zero)
            beams = joint.beams[:: -1 if k else 1]
            frames = [scene.frame[beam.particle].T for beam in beams]
            hinges.append(
                Hinge(
                    name + SUFFIXES["universal"][k],
                    beams,
                    axes=np.array([frame @ e for frame in frames]),
                    references=np.array([frames[0] @ zero, frames[1] @ to_zero]),
                    opening=float(openings[k]),
                    support="",
                    type="universal",
                    number=k,
                )
            )
        return tuple(hinges)

    @staticmethod
    def held_point(scene, name, particle: int, point, axes: str, leader=None) -> "Joint":
        """Return a "held" joint, which keeps a point of a particle in place along some global axes
        (`Scene.hold_point`). leader: driven particle with which it moves, None: it stays."""
        if not axes or set(axes) - set(AXES):
            raise SceneError(f"axes of support {name}", axes, "letters out of 'xyz'")
        zeros = np.zeros((2, 3))
        beams: tuple[VirtualBeam, ...] = (scene.arm_to(particle, point),)
        if leader is not None:
            beams = *beams, VirtualBeam(leader, zeros[0])
        return Joint(name, "held", beams, zeros, zeros, axes)

    @property
    def conditions(self) -> int:
        """Number of scalar constraint equations that the joint imposes, 1 to 6."""
        return TYPES[self.type].conditions or len(self.support_axes)

    @property
    def holds_opening(self) -> bool:
        """Whether the joint only holds the joint coordinate of a hinge or slide at a value, for a
        motor, release, latch or friction; it does not itself keep two particles together."""
        return self.type in ("opening", "slid")

    def topology(self):
        return self.name, self.type, self.particles, self.support_axes

    @classmethod
    def find(cls, scene):
        """Return the joints that are solved together: those added as joints, those made of hinges
        not solved alone (`are_alone`), and those that hold joint coordinates."""
        joints = list(scene.kinds.get(cls, []))
        for hinge, lone in zip(scene.hinges, are_alone(scene), strict=True):
            if not lone:
                joints += as_joints(hinge)
        for holder in Turn.find(scene):
            hinge = scene.hinges[holder.hinge]
            name = f"{hinge.name} (its {holder.noun})"
            type, beams = "opening", hinge.beams
            if hinge.slides:
                pairs = zip(beams, hinge.ends, strict=True)
                type, beams = "slid", tuple(VirtualBeam(beam.particle, end) for beam, end in pairs)
            joints.append(Joint(name, type, beams, hinge.axes, hinge.references))
        return joints

    @classmethod
    def _elimination(cls, scene):
        """Bodies of a scene's joints, those at the sides of each joint (-1: none), whether each can
        move; order of elimination, and the later joints that each is coupled to."""
        from fpm.elements.joints.joint_arrays import elimination, neighbours

        bodies = sorted(set(cls.moved_particles(scene)))
        slot = {p: s for s, p in enumerate(bodies)}
        pairs = [[*(slot[p] for p in j.particles), -1][:2] for j in cls.find(scene)]
        slots, movable = np.array(pairs, np.int64), ~scene.fixed[bodies].all(axis=1)
        return bodies, slots, movable, *elimination(neighbours(slots, movable))

    @classmethod
    def elimination(cls, scene) -> tuple[int, float]:
        """Return the size of the equations of all joints of a scene that are solved together:
        number of scalar constraints, and of multiply-adds to eliminate them in one time step.

        A joint of c constraints takes c³/6 for its own block, c² d/2 for those below it and c d²/2
        for those of the d constraints of joints that it is coupled to when its turn comes."""
        *_, order, followers = cls._elimination(scene)
        counts = np.array([joint.conditions for joint in cls.find(scene)])[order]
        later_counts = np.array([counts[members].sum() for members in followers])
        operations = counts**3 / 6 + counts**2 * later_counts / 2 + counts * later_counts**2 / 2
        return int(counts.sum()), float(operations.sum())

    @classmethod
    def cost_in(cls, scene):
        """By the size of the equations."""
        conditions, operations = cls.elimination(scene)
        return CONDITION * conditions + MULTIPLY_ADD * operations

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints import joint_kernels  # noqa: F401, its hooks
        from fpm.elements.joints.joint_arrays import pattern

        scene, joints = batch.scene, cls.find(batch.scene)
        bodies, slots, movable, order, followers = cls._elimination(scene)
        joints, slots = [joints[j] for j in order], slots[order]
        layout, entries = pattern([j.conditions for j in joints], slots, movable, followers)
        driven_particles = set(Drive.moved_particles(scene))
        conditions, rows = sum(j.conditions for j in joints), batch.instants + 1
        first = len(joints) - len(Turn.find(scene))
        is_counted = cls.are_impulses_read(scene)
        return arrays.Joints(
            types=batch.integers(TYPES[j.type].bits for j in joints),
            names=batch.integers(order),
            slots=slots.ravel(),
            sides=batch.stack(2 * len(joints), arrays.SIDE, lambda s: _sides(s, order)),
            places=batch.stack(len(joints), 3, lambda s: places_of(s, cls.find(s))[order]),
            fixed_axes=batch.integers(([a in j.support_axes for a in AXES] for j in joints), 3),
            particle=batch.integers(bodies),
            is_driven=batch.integers(p in driven_particles for p in bodies),
            bodies=batch.stack(len(bodies), arrays.BODY, lambda s: _bodies(s, bodies)),
            body_scratch=batch.blank(len(bodies), arrays.BODY_SCRATCH),
            rows=batch.blank(conditions, arrays.ROW),
            matrix=batch.blank(entries, 1),
            pattern=layout,
            ease=EASE,
            account=batch.work_account(cls),
            peaks=batch.peaks_of(cls),
            excess=batch.rows_of(cls),
            gaps=batch.blank(rows, 2),
            turns=batch.part(Turn),
            turn_of=batch.integers(max(number - first, -1) for number in order),
            turn_at=batch.integers(order.index(t) for t in range(first, len(joints))),
            sums=batch.blank(conditions, 1) if is_counted else None,
            forces=batch.blank(rows * len(joints), SUMS) if is_counted else None,
        )


def as_joints(hinge: Hinge) -> Sequence[Joint]:
    """Return the joints solved in place of a `hinge`: itself as a Joint and, if its point is held,
    a "held" one; none for the further ones of several openings of a joint, part of the first's."""
    if hinge.number:
        return []
    name, axes, beams = hinge.joint, hinge.axes, hinge.beams
    if hinge.type == "universal":
        axes = np.array([axes[0], hinge.references[1]])
    if hinge.lead:  # from a point at which the opening would be 0
        beams = replace(beams[0], arm=beams[0].arm - hinge.offset * axes[0]), beams[1]
    joint = Joint(name, hinge.type, beams, axes, hinge.references, lead=hinge.lead)
    if not hinge.support:
        return [joint]
    zeros = np.zeros((2, 3))
    name = f"{hinge.name} (its support)"
    return [joint, Joint(name, "held", hinge.beams[:1], zeros, zeros, hinge.support)]


def _sides(scene, order) -> np.ndarray:
    joints = Joint.find(scene)
    array = np.zeros((2 * len(order), arrays.SIDE))
    for i, number in enumerate(order):
        joint = joints[number]
        for k, beam in enumerate(joint.beams):  # ARM, AXIS, REFERENCE, LEAD
            vectors = beam.arm, joint.axes[k], joint.references[k], [joint.lead]
            array[2 * i + k] = np.concatenate(vectors)
    return array


def _bodies(scene, bodies) -> np.ndarray:
    free = ~scene.fixed[bodies]
    # Moments on driven bodies change nothing, but they do work.
    is_driven = np.isin(bodies, Drive.moved_particles(scene))[:, None]
    inverse_mass = free[:, :3] / scene.mass[bodies][:, None]
    inverse_inertia = free[:, 3:].any(axis=1)[:, None] / turns_of(scene).inertia[bodies]
    root, turns = np.sqrt(inverse_inertia), free[:, 3:] | is_driven
    return np.hstack([inverse_mass, inverse_inertia, root, turns])  # AXIS_IM, HIJ, ROOT, TURNS
