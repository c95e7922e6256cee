"""Forces and moments by which joints, supports and drives keep parts where they are.

A joint's are the impulses that its solver applied over the step around an instant, divided by the
length of that step; at the first instant by docs/mechanics.md, "Joints that are solved
together"."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses, conditions_of, dependence
from fpm.assembly.matrices import scale_matrix
from fpm.elements import kinds_of
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.kind import VirtualBeam
from fpm.elements.openings.journal import PIN
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.load import Gravity
from fpm.reading.recording import Recording, Sides
from fpm.scenes.scene import Scene

SUPPORT = " (its support)"  # what joints are called that hold the point of a hinge


def joints_of(scene: Scene) -> dict[str, Hinge | Joint]:
    """Return all joints of a scene that connect two bodies, by name, without those that only hold
    an opening, and pins with play, whose force is that of a contact (Journal)."""
    joints = [j for j in (*Hinge.find(scene), *Joint.find(scene)) if j.type not in (PIN, "held")]
    return {j.name: j for j in joints if not j.holds_opening}


def point_of(run: Recording, joint: Hinge | Joint) -> np.ndarray:
    """Return the position (t, 3) m, in global axes, at which a joint's forces act at the t instants
    of a recorded `run`: its point on the first body, on the second where that may leave it."""
    beam = joint.beams[1 if joint.acts_at_second else 0]
    return run.place(beam.particle) + run.arm(beam)


def couple_on_two(run: Recording, joint: Hinge | Joint, sides: Sides) -> np.ndarray:
    """Return the moment (t, 3) N m of a joint on its second body about its point, global, in `run`;
    `sides`: of run.joints. About axes of no rotation: minus that on the first."""
    point = point_of(run, joint)
    place1, place2 = (run.place(beam.particle) for beam in joint.beams)
    opposite = sides.moment2 - np.cross(point - place2, sides.force2)
    moment = np.cross(point - place1, sides.force1) - sides.moment1
    second = joint.beams[1].particle
    turns = ~run.scene.fixed[second, 3:] | (second in Drive.moved_particles(run.scene))
    return np.where(turns, opposite, moment)


def on_particle(run: Recording, particle: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the force (t, 3) N of all joints on a particle (its index), and their moment (t, 3) N
    m about it, in global axes, at the t instants of a recorded `run`."""
    force, moment = np.zeros((2, len(run.time), 3))
    for joint, sides in run.joints:
        for k, beam in enumerate(joint.beams):
            if beam.particle != particle:
                continue
            joint_force, sign = ((sides.force1, -1.0), (sides.force2, 1.0))[k]
            force = force + joint_force
            if joint.type == "held":
                moment = moment + np.cross(run.arm(beam), joint_force)
                continue
            lever = point_of(run, joint) - run.place(particle)
            moment = moment + np.cross(lever, joint_force) + sign * couple_on_two(run, joint, sides)
    return force, moment


class Reaction(NamedTuple):
    """A supported or driven point, at which a reaction force is read. beam: rigid arm to it from
    its particle; holders: names of joints that connect the point itself to the ground; particle:
    whether its particle is fixed or driven, so that there is a reaction moment too."""

    beam: VirtualBeam
    holders: tuple[str, ...]
    particle: bool


def reactions_of(scene: Scene) -> dict[str, Reaction]:
    """Return the points of a scene that have a reaction force, by name: supports and drives, named
    points on particles that are fixed or driven, and hinges with a support."""
    supports = {joint.name: joint for joint in Joint.find(scene) if joint.type == "held"}
    is_fixed: Any = scene.fixed.any(axis=1)
    reactions = {}
    for name, beam in {**scene.points, **scene.supports}.items():
        holders = (name,) if name in supports and name in scene.supports else ()
        is_led = bool(holders) and len(supports[name].beams) == 2
        if is_fixed[beam.particle] or holders:
            is_held = bool(is_fixed[beam.particle]) and not is_led
            reactions[name] = Reaction(beam, holders, is_held)
    for hinge in scene.hinges:
        if hinge.support:
            reactions.setdefault(hinge.name, Reaction(hinge.beams[0], (hinge.name,), False))
    return reactions


def reaction(run: Recording, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Force (t, 3) N of a support or drive on the structure, and its moment (t, 3) N m about its
    point, in global axes; run: what was recorded; name: a key of `reactions_of`. Of a particle that
    is held: the rate of its momentum less all other forces and those of joints, along and about the
    axes that are held. Several supports on one particle are one. A particle that is held entirely
    and neither on a bar, nor a named body, nor moved by a drive is the ground, without weight."""
    scene, support = run.scene, reactions_of(run.scene)[name]
    particle = support.beam.particle
    force, moment = np.zeros((2, len(run.time), 3))
    for joint, sides in run.joints:
        if joint.type == "held":
            if joint.name.removesuffix(SUPPORT) in support.holders:
                force = force + sides.force1
        elif joint.name in support.holders:
            force = force + (sides.force1 + sides.force2)
    if support.particle:
        fixed = scene.fixed[particle]
        terms = run.inertia(particle), run.force(particle), on_particle(run, particle)
        reaction_force, couple = (a - b - c for a, b, c in zip(*terms, strict=True))
        reaction_force, couple = reaction_force * fixed[:3], couple * fixed[3:]
        parts = {*scene.bodies.values(), *Drive.moved_particles(scene)}
        is_part = particle in parts or any(particle in beams.nodes for beams in scene.beams)
        if fixed.all() and not is_part:  # the ground
            fields = [kind for kind in kinds_of([scene]) if issubclass(kind, Gravity)]
            for kind in fields:
                curve, weight = scene.curve(kind.curve_of(scene)), kind.weight(scene, particle)
                factors = np.array([curve.kick_mean(time, run.step) for time in run.time])
                reaction_force = reaction_force + factors[:, None] * weight
        force = force + reaction_force
        moment = couple - np.cross(run.arm(support.beam), reaction_force)
    return force, moment


SHARE = 3e-5
"""Share of a condition in combinations that vanish, above which its force is not determined."""


def undetermined_forces(scene: Scene, responses: Iterable[Any]) -> dict[str, str]:
    """Return warnings, by name of the response, on constraint or reaction forces that the motion
    does not determine: a sentence with reason and remedy."""
    joints = []
    for response in responses:
        if response.kind.startswith("constraint_"):
            joints.append((response, {response.subjects[0]}))
        elif response.kind.startswith("reaction_"):
            holders = reactions_of(scene)[response.subjects[0]].holders
            joints.append((response, {f"{h}{end}" for h in holders for end in ("", SUPPORT)}))
    names = find_indeterminate(scene) if joints else set()
    return {
        response.name: f"conditions of {response.subjects[0]} depend on those of other joints of "
        "rigid parts, so that only the sum of their forces is determined: let a part between them "
        "be elastic, or take joints with fewer conditions"
        for response, joint_names in joints if joint_names & names
    }  # fmt: skip


def find_indeterminate(scene: Scene) -> set[str]:
    """Return names of joints and supports of a scene whose forces the motion does not determine, at
    the start: their conditions depend on others', with no elastic part between."""
    from scipy.sparse.csgraph import connected_components

    conditions = conditions_of(scene)
    names, free = np.array(conditions.joint), ~scene.fixed.ravel()
    size = float(np.ptp(scene.position, axis=0).max()) or 1.0
    scales = np.tile(np.repeat([size, 1.0], 3), len(scene.position))
    poses = ParticlePoses(scene.position, scene.frame)
    rows = scale_matrix(conditions.jacobian(poses), conditions.weight(size), scales)
    rows = rows[:, np.flatnonzero(free)].tocsr()
    joints: set[str] = set()
    count, groups = connected_components(abs(rows) @ abs(rows).T, directed=False)
    for group in range(count):
        members = np.flatnonzero(groups == group)
        dependences = dependence(rows[members][:, np.unique(rows[members].indices)].toarray())[1]
        joints.update(names[members][dependences > SHARE].tolist())
    return joints
