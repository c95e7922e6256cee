"""Conditions of all joints of a scene, and their derivatives by the motions of particles.

Each is one of three: two points agree along a direction, global or carried by the first particle
(joints of points, supports, sliders), or a direction of the first is normal to one of the second
(axes, and openings that are held)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fpm.assembly.matrices import Form, dofs_of, pair_matrix, sparse
from fpm.elements.cross import cross
from fpm.elements.joints import joint_arrays as bits
from fpm.elements.joints.joint import Joint, as_joints
from fpm.elements.joints.joint_types import TYPES
from fpm.elements.kind import AXES
from fpm.errors import SceneError

STEP = 1e-30
"""Imaginary step of derivatives by complex numbers (Squire, Trapp, SIAM Review 40 (1998) 110)."""

CROSS_PRODUCTS = np.cross(np.eye(3)[:, None], np.eye(3)).transpose(0, 2, 1)
"""Matrices (3, 3, 3) of the vector products with the three global axes."""


TURNS = [3, 4, 5, 9, 10, 11]
"""Rotations, among the motions of a pair of particles."""


class ParticlePoses(NamedTuple):
    """Positions and axes of n particles. position (n, 3) m; frame (n, 3, 3): axes as columns."""

    position: np.ndarray
    frame: np.ndarray

    def displace(self, step: np.ndarray) -> "ParticlePoses":
        """Return new poses: these, moved by step (6n,): of each particle a shift (m), then a
        rotation vector (rad), both in global axes. Used for each step of Newton's method."""
        from scipy.spatial.transform import Rotation

        shift, turn = step.reshape(-1, 2, 3).transpose(1, 0, 2)
        frame = Rotation.from_rotvec(turn).as_matrix() @ self.frame
        return ParticlePoses(self.position + shift, frame)

    def ends(self, pairs: np.ndarray) -> "tuple[ParticlePoses, ParticlePoses]":
        """Return the poses (k,) of the first and of the second particle of pairs (k, 2)."""
        first, second = (ParticlePoses(self.position[i], self.frame[i]) for i in pairs.T)
        return first, second

    def perturb(self, end: int, shifts: bool) -> "ParticlePoses":
        """Return 12 complex copies (12, n, ...) of these poses for `slopes`: shifted by i 1e-30
        along, then turned about each global axis, in the first six copies (end 0) or the last (end
        1), the others unchanged. shifts: False: without those that are shifted, 6 copies."""
        count = 6 if shifts else 3
        position, frame = self.position, np.empty((2 * count, *self.frame.shape), complex)
        frame[:] = self.frame
        frame[(end + 1) * count - 3 :][:3] += 1j * STEP * (CROSS_PRODUCTS[:, None] @ self.frame)
        if shifts:
            position = np.empty((12, *self.position.shape), complex)
            position[:] = self.position
            position[6 * end :][:3] += 1j * STEP * np.eye(3)[:, None]
        return ParticlePoses(position, frame)


def slopes(
    function, first: ParticlePoses, second: ParticlePoses, shifts: bool = True
) -> np.ndarray:
    """Return exact derivatives (e, k, 12) of a function by the motions of e pairs of particles
    (shift, m, and rotation vector, rad, of the first, then the second, global), by complex steps.
    function(first, second): returns (..., e, k); it must be analytic: no abs (its derivative would
    be 0), conj or casts to real numbers. shifts: False: those by shifts are 0."""
    values = function(first.perturb(0, shifts), second.perturb(1, shifts))
    derivatives = np.zeros((12, *values.shape[1:]))
    derivatives[slice(None) if shifts else TURNS] = values.imag / STEP
    return np.moveaxis(derivatives, 0, -1)


SMALLEST = 1e-9
"""Share of the largest singular value of conditions below which they depend on each other."""


def dependence(rows: np.ndarray) -> tuple[int, np.ndarray]:
    """Find which of c linear conditions are redundant. rows (c, f): their derivatives by f degrees
    of freedom. Returns the rank, and of each condition (c,) how large, 0 to 1, its factor is in
    combinations of conditions whose derivatives vanish; 0: it depends on no others."""
    if not rows.size:
        return 0, np.zeros(len(rows))
    vectors, sizes, _ = np.linalg.svd(rows)
    rank = int((sizes > SMALLEST * sizes[0]).sum())
    return rank, np.linalg.norm(vectors[:, rank:], axis=1)


GLOBAL, BODY_FIXED, NORMAL = 0, 1, 2

ZERO, NO_ARMS = np.zeros(3), np.zeros((2, 3))


class Conditions(NamedTuple):
    """Conditions that close all joints of a scene, c of them, each on two particles: a gap of
    points along a direction, or a product of two directions, that should be 0.

    joint: name of each one's joint; pairs (c, 2): indices of particles; axis_types (c,): GLOBAL or
    BODY_FIXED, gap along a direction that is global or fixed to the first particle, or NORMAL, two
    directions at right angles; axis1 (c, 3): the direction; axis2 (c, 3): for NORMAL that on the
    second, in its frame; arms (c, 2, 3) m: from particles to points, in their frames; is_on_second
    (c,): 1, or 0 where the point is held at `place` (c, 3) m, global, instead; lead (c,): of a
    thread (m/rad), with which the gap grows by the angle from `reference` (c, 3), fixed to the
    first, to axis2."""

    joint: list[str]
    pairs: np.ndarray
    axis_types: np.ndarray
    axis1: np.ndarray
    axis2: np.ndarray
    arms: np.ndarray
    is_on_second: np.ndarray
    place: np.ndarray
    reference: np.ndarray
    lead: np.ndarray

    def weight(self, size: float) -> np.ndarray:
        """Return factors (c,) that make residuals dimensionless: of gaps 1/size (m), others 1."""
        return np.where(self.axis_types == NORMAL, 1.0, 1.0 / size)

    def gaps(self, poses: ParticlePoses) -> np.ndarray:
        """Return the residuals (c,) of all conditions at poses of all particles: gaps of points
        (m), and cosines of angles that should be right; all 0 where the joints are closed."""
        return self._residuals(*poses.ends(self.pairs))[:, 0]

    def worst(self, gaps: np.ndarray) -> tuple[str, float, float]:
        """Return the name of the joint with the largest residual ("none" without joints), its gap
        (m), and its tilt (rad if small), roots of the summed squares of its gaps and of its
        cosines, to name it in messages. gaps (c,): of Conditions.gaps."""
        gap: dict[str, float] = {}
        tilt: dict[str, float] = {}
        for name, axis_type, residual in zip(self.joint, self.axis_types, gaps, strict=True):
            sizes = tilt if axis_type == NORMAL else gap
            sizes[name] = float(np.hypot(sizes.get(name, 0.0), residual))
        names = dict.fromkeys(self.joint)
        name = max(names, key=lambda n: max(gap.get(n, 0.0), tilt.get(n, 0.0)), default="none")
        return name, gap.get(name, 0.0), tilt.get(name, 0.0)

    def derivatives(self, poses: ParticlePoses, impulses: np.ndarray, form: Form = sparse):
        """Return derivatives (c, 6n) of all conditions by motions (m, rad) of n particles, and
        second ones (6n, 6n) of their sum with factors `impulses` (c,). form: of matrices."""
        shifts = bool(np.any(self.axis_types == BODY_FIXED))
        blocks = impulses[:, None, None] * slopes(self._rows, *poses.ends(self.pairs), shifts)
        curvature = pair_matrix(blocks, self.pairs, len(poses.position), form)
        return self.jacobian(poses, form), curvature

    def jacobian(self, poses: ParticlePoses, form: Form = sparse):
        """Return derivatives (c, 6n) of the conditions by motions (m, rad) of n particles."""
        rows = self._rows(*poses.ends(self.pairs))
        shape = len(rows), 6 * len(poses.position)
        return form(rows, np.arange(len(rows))[:, None], dofs_of(self.pairs), shape)

    def _parts(self, first: ParticlePoses, second: ParticlePoses):
        """Directions and arms of both particles, and offset of the points (..., c, 3), global."""
        body_axis = np.einsum("...cij,cj->...ci", first.frame, self.axis1)
        axis1 = np.where((self.axis_types == GLOBAL)[:, None], self.axis1, body_axis)
        axis2 = np.einsum("...cij,cj->...ci", second.frame, self.axis2)
        arms = [
            np.einsum("...cij,cj->...ci", end.frame, self.arms[:, k])
            for k, end in enumerate((first, second))
        ]
        factor = self.is_on_second[:, None]
        offset = first.position + arms[0] - factor * (second.position + arms[1]) - self.place
        return axis1, axis2, arms, offset

    def _residuals(self, first: ParticlePoses, second: ParticlePoses) -> np.ndarray:
        """Residuals (..., c, 1), as of `gaps`, for poses of both particles."""
        axis1, axis2, _, offset = self._parts(first, second)
        vector = np.where((self.axis_types == NORMAL)[:, None], axis2, offset)
        residuals = np.sum(axis1 * vector, axis=1, keepdims=True)
        if (rows := np.flatnonzero(self.lead)).size:
            lead, axis, second_reference = self.lead[rows], axis1[rows], axis2[rows]
            first = np.einsum("cij,cj->ci", first.frame[rows], self.reference[rows])
            sine = np.sum(np.cross(axis, first) * second_reference, axis=1)
            cosine = np.sum(first * second_reference, axis=1)
            gap = residuals[rows, 0] + lead * np.arctan2(sine, cosine)
            pitch = 2 * np.pi * lead  # whole turns of a thread do not matter
            residuals[rows, 0] = gap - pitch * np.round(gap / pitch)
        return residuals

    def _rows(self, first: ParticlePoses, second: ParticlePoses) -> np.ndarray:
        """Derivatives (..., c, 12) by the motions of both particles."""
        axis1, axis2, arms, offset = self._parts(first, second)
        types = self.axis_types[:, None]
        factor, turn = self.is_on_second[:, None], cross(axis1, axis2)
        shift, lever = np.where(types == NORMAL, 0.0, axis1), cross(arms[0], axis1)
        if BODY_FIXED in self.axis_types:
            lever = lever + np.where(types == BODY_FIXED, cross(axis1, offset), 0.0)
        ends = [
            shift,
            np.where(types == NORMAL, turn, lever),
            -factor * shift,
            np.where(types == NORMAL, -turn, -factor * cross(arms[1], axis1)),
        ]
        if self.lead.any():
            thread = self.lead[:, None] * axis1
            ends[1], ends[3] = ends[1] - thread, ends[3] + thread
        return np.concatenate(ends, axis=-1)


def conditions_of(scene, hold: Sequence[str] = ()) -> Conditions:
    """Return the conditions that close all joints of a scene. hold: names of hinges whose joint
    coordinate stays as stated, one condition each, at the end. SceneError for other names."""
    rows = [row for joint in _joints_of(scene) for row in _rows_of(scene, joint)]
    hinges = {hinge.name: hinge for hinge in scene.hinges}
    for name in hold:
        if name not in hinges:
            raise SceneError("hold", name, f"names of hinges: {', '.join(hinges)}")
        hinge = hinges[name]
        if hinge.slides:
            arms = np.array([beam.arm for beam in hinge.beams])
            rows.append(_row(name, hinge.particles, BODY_FIXED, hinge.axes[0], arms=arms))
        else:
            normal = cross(hinge.axes[0], _opened_reference(hinge))
            rows.append(_row(name, hinge.particles, NORMAL, normal, hinge.references[1]))
    columns = list(zip(*rows, strict=True)) or [()] * 10
    shapes = [(-1, 2), (-1,), (-1, 3), (-1, 3), (-1, 2, 3), (-1,), (-1, 3), (-1, 3), (-1,)]
    kinds = [int, int, *[float] * 7]
    arrays: list[np.ndarray] = [
        np.array(c, k).reshape(s) for c, k, s in zip(columns[1:], kinds, shapes, strict=True)
    ]
    return Conditions(list(columns[0]), *arrays)


def _row(
    name, pair, axis_type, axis1, axis2=ZERO, arms=NO_ARMS, is_on_second=1.0, place=ZERO,
    reference=ZERO, lead=0.0,
) -> tuple:  # fmt: skip
    """Return one condition: the fields of Conditions, with those left out that do nothing."""
    return name, pair, axis_type, axis1, axis2, arms, is_on_second, place, reference, lead


def tilts(scene, poses: ParticlePoses, hold: Sequence[str] = ()) -> dict[str, float]:
    """Return for each joint of a scene, by name, the largest angle (rad, 0 to π) between directions
    on its two parts that agree where it is closed, at poses of all particles; none of spherical and
    universal joints. hold: hinges, by name, of which directions at the stated opening count."""
    directions: list[tuple] = []
    for joint in _joints_of(scene):
        if TYPES[joint.type].bits & bits.PARALLEL:
            directions.append((joint.name, joint.particles, joint.axes))
        if TYPES[joint.type].bits & bits.TWIST:
            directions.append((joint.name, joint.particles, joint.references))
    for hinge in scene.hinges:
        if hinge.name in hold and not hinge.slides:
            pair = _opened_reference(hinge), hinge.references[1]
            directions.append((hinge.name, hinge.particles, pair))
    angles: dict[str, float] = {}
    for name, particles, pair in directions:
        first, second = (poses.frame[p] @ axis for p, axis in zip(particles, pair, strict=True))
        angle = np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second)
        angles[name] = max(angles.get(name, 0.0), float(angle))
    return angles


def _opened_reference(hinge) -> np.ndarray:
    """Direction (3,) on a hinge's first part of the second's reference at the stated opening."""
    axis, zero = hinge.axes[0], hinge.references[0]
    return np.cos(hinge.opening) * zero + np.sin(hinge.opening) * cross(axis, zero)


def _joints_of(scene) -> list[Joint]:
    """Joints of a scene, those made of hinges first."""
    joints = [joint for hinge in scene.hinges for joint in as_joints(hinge)]
    return joints + scene.kinds.get(Joint, [])


def _rows_of(scene, joint: Joint) -> list[tuple]:
    """Return the conditions of a joint, as rows of Conditions."""
    name, pair, arms = joint.name, joint.particles, np.array([beam.arm for beam in joint.beams])
    if joint.type == "held":
        axes = [np.eye(3)[AXES.index(axis)] for axis in joint.support_axes]
        if len(joint.beams) == 2:
            return [_row(name, pair, GLOBAL, axis, arms=arms) for axis in axes]
        place = scene.position[pair[0]] + scene.frame[pair[0]] @ arms[0]
        ends = (*pair, *pair), np.array([arms[0], ZERO])
        return [_row(name, ends[0], GLOBAL, axis, ZERO, ends[1], 0.0, place) for axis in axes]
    (axis, axis2), (reference, reference2) = joint.axes, joint.references
    third, type_bits = cross(axis, reference), TYPES[joint.type].bits
    normals = (bits.ACROSS_X, reference), (bits.ACROSS_Y, third), (bits.ACROSS_AXIS, axis)
    points = [(BODY_FIXED, e) for bit, e in normals if type_bits & bit]
    points += [(GLOBAL, e) for e in np.eye(3) if type_bits & bits.POINT]
    tilts = [(axis, axis2)] if type_bits & bits.CROSS else []
    tilts += [(reference, axis2), (third, axis2)] if type_bits & bits.PARALLEL else []
    tilts += [(third, reference2)] if type_bits & bits.TWIST else []
    rows = [_row(name, pair, axis_type, e, arms=arms) for axis_type, e in points]
    rows += [_row(name, pair, NORMAL, u, w) for u, w in tilts]
    if type_bits & bits.THREAD:
        thread = {"reference": reference, "lead": joint.lead}
        rows.append(_row(name, pair, BODY_FIXED, axis, reference2, arms, **thread))
    return rows
