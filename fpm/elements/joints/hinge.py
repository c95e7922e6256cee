"""Revolute hinges: two particles share a point and an axis, and turn freely about it.

Theory: docs/mechanics.md, "Virtual beams and hinges": impulses close hinges at the end of every
step (SHAKE: Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327). A hinge point may be
held along global axes (`support`).

All other openings of joints (joint_types.py) are hinges too, on which all that acts on hinges acts;
what joints of other types keep together is solved with the coupled joints (joint.py). A universal
joint is two: the angle about its axis on the first particle, from a reference of the first to the
axis on the second; and that about the axis on the second, from the axis on the first to a reference
of the second."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from fpm.elements.cross import cross, length
from fpm.elements.joints import hinge_arrays as arrays
from fpm.elements.joints.hinge_arrays import MOST_GAP, MOST_TILT
from fpm.elements.joints.joint_arrays import POINT
from fpm.elements.joints.joint_types import TYPES, OpeningType
from fpm.elements.joints.turn import Turn
from fpm.elements.kind import AXES, ElementType, Series, VirtualBeam, Watch
from fpm.elements.openings.opening import opening_angle
from fpm.errors import SceneError, describe_turn


def gap_watches(noun: str, gap: str, tilt: str, remedy: str, dead_end=None) -> tuple[Watch, Watch]:
    """Return the failure criteria (Watch) for the gaps (m, as a share of the scene's size) and
    tilts (rad) of joints. noun: "hinge" or "joint"; gap, tilt: keys of both; remedy: what the user
    may do; dead_end: as of Watch."""

    def failure(values: dict[str, float]) -> tuple[str, str]:
        cause = f"a {noun} is open by {values[gap]:.2g} m and {values[tilt]:.2g} rad"
        turn_words, turn_remedy = describe_turn(values["turn"], values["step"])
        return (f"{cause}, as {turn_words}", turn_remedy) if turn_words else (cause, remedy)

    return (
        Watch(gap, MOST_GAP, True, failure, True, dead_end=dead_end),
        Watch(tilt, MOST_TILT, True, failure, dead_end=dead_end),
    )


class JointBase(ElementType):
    """Base class of hinges and joints. Each has a `name`, a `type` (as "revolute"), and `beams`:
    one or two rigid arms (VirtualBeam) from particles to the joint, whose free ends are kept
    together, or, of one, held in place. gaps: words for recorded gap and tilt, by variable."""

    joins = True
    name: Any
    type: Any
    beams: Any
    gaps: ClassVar[dict[str, str]]  # recorded: the largest of points and of directions, in words

    @property
    def particles(self) -> tuple[int, ...]:
        """Indices of the particles that the joint joins, (2,); (1,) if it holds one in place."""
        return tuple(beam.particle for beam in self.beams)

    @property
    def acts_at_second(self) -> bool:
        """Whether its forces act at the second's point, which may leave the first's."""
        return not TYPES[self.type].bits & POINT

    @property
    def joint(self) -> str:
        """Name of the whole joint: its own; of one of several openings that joint's."""
        return self.name

    @staticmethod
    def are_impulses_read(scene) -> bool:
        """Return whether an element type in the scene needs joints' impulses summed over steps."""
        return any(kind.reads_impulses(scene) for kind in scene.kinds)

    def check(self, scene):
        names = {self.name, self.joint}
        if isinstance(self, Hinge) and self.number:
            names = {self.name}  # the first opening has checked for the joint
        if names & list_names(scene):
            raise SceneError(type(self).__name__.lower(), self.joint, "a name not yet used")

    @classmethod
    def names(cls, scene):
        kind = cls.__name__.lower()
        return [f"{kind} {e.name}" if e.name != kind else kind for e in cls.find(scene)]

    @classmethod
    def moved_particles(cls, scene):
        return [p for element in cls.find(scene) for p in element.particles]

    @classmethod
    def read_records(cls, part, scene, lane):
        """Largest gap (m) and tilt (rad; its sine if small) over all elements."""
        columns = zip(cls.gaps.items(), part.gaps[:, :, lane].T, ("m", "rad"), strict=True)
        return {name: Series(values, unit, words) for (name, words), values, unit in columns}


@dataclass(frozen=True)
class Hinge(JointBase):
    """A hinge, or other coordinate (opening) of a joint, between ends of arms from two particles.

    name: unique; beams: rigid arms; axes (2, 3): the axis in each particle's frame; references (2,
    3): directions normal to the axis, one in each frame, that coincide at opening 0; opening (rad):
    at the start, with full turns; it grows when the second particle turns by the right-hand rule
    about the axis against the first; support: global axes along which the hinge point is held, as
    "xz". type: of the joint, a key of TYPES; number: which of its openings. One that is a length
    (m) is the distance along the axis from the first arm's end to the second's, plus `offset` (m);
    each axis is fixed in its first particle. lead: of a screw, m/rad, whose arms' ends are apart by
    lead times opening less `offset`."""

    name: str
    beams: tuple[VirtualBeam, ...]
    axes: np.ndarray
    references: np.ndarray
    opening: float
    support: str
    type: str = "revolute"
    offset: float = 0.0
    number: int = 0
    lead: float = 0.0

    holds_opening = False  # as a joint that is an opening (joint.py)
    cost = 390.0  # solved alone
    gaps: ClassVar = {
        "hinge_gap": "largest gap of a hinge, or to where it is held",
        "hinge_axis_gap": "largest angle between hinge axes",
    }
    watches = gap_watches(
        "hinge",
        "gap",
        "tilt",
        "halve solver.step",
    )

    @staticmethod
    def create(scene, name, particles, point, axis, opening, support) -> "Hinge":
        """Return a revolute hinge between two particles of a scene (`Scene.add_hinge`)."""
        pair = two_of(scene, particles, f"hinge {name}")
        if set(support) - set(AXES):
            raise SceneError(f"support of hinge {name}", support, "letters out of 'xyz'")
        axes = [unit(a, f"axis of hinge {name}") for a in of_both(axis)]
        axis = axes[0]
        normal = unit(cross(axis, np.eye(3)[np.argmin(np.abs(axis))]), "reference")
        zero = np.cos(opening) * normal + np.sin(opening) * cross(axis, normal)
        if np.any(axes[1] != axis):  # the second's reference is normal to its own axis
            zero = zero - (zero @ axes[1]) * axes[1]
        references = [unit(r, f"opening of hinge {name}") for r in (normal, zero)]
        frames = [scene.frame[p].T for p in pair]
        return Hinge(
            name,
            arms(scene, pair, point),
            axes=np.array([frame @ a for frame, a in zip(frames, axes, strict=True)]),
            references=np.array([f @ r for f, r in zip(frames, references, strict=True)]),
            opening=opening_angle(axis, references[0], references[1], opening),
            support="".join(sorted(support)),
        )

    @property
    def opening_type(self) -> OpeningType:
        """Which opening of its joint it is, and whether that is a length or an angle."""
        return TYPES[self.type].openings[self.number]

    @property
    def slides(self) -> bool:
        """Whether its joint coordinate is a length (m)."""
        return bool(self.opening_type.direction)

    @property
    def ends(self) -> np.ndarray:
        """Vectors (2, 3), in the particles' frames, between which the joint coordinate is measured:
        references; or of a slide arms (m) to points, whose distance along the axis it is."""
        if not self.slides:
            return self.references
        first, second = (beam.arm for beam in self.beams)
        return np.array([first - self.offset * self.axes[0], second])

    @property
    def joint(self) -> str:
        """Name of the whole joint: the hinge's without the suffix of one of several openings."""
        return self.name.removesuffix(self.opening_type.suffix)

    @classmethod
    def find(cls, scene):
        """Return those whose constraints are solved for each by itself (`are_alone`)."""
        return [hinge for hinge, lone in zip(scene.hinges, are_alone(scene), strict=True) if lone]

    def topology(self):
        return self.name, self.type, self.particles, self.support

    @classmethod
    def pack(cls, batch):
        from fpm.elements.joints import hinge_kernels  # noqa: F401, its hooks

        hinges, indices = cls.find(batch.scene), np.flatnonzero(are_alone(batch.scene))
        h, rows = len(hinges), batch.instants + 1

        def lone(rows_of):  # which are alone is the same in all scenes of a batch
            return lambda scene: rows_of(scene, [scene.hinges[i] for i in indices])

        axes = [[axis in hinge.support for axis in AXES] for hinge in hinges]
        is_counted = cls.are_impulses_read(batch.scene)
        return arrays.Hinges(
            ends=batch.integers(cls.moved_particles(batch.scene)),
            bodies=batch.stack(2 * h, arrays.BODY, lone(_bodies)),
            hinges=batch.stack(h, arrays.HINGE, lone(lambda *x: np.hstack([axes, places_of(*x)]))),
            fixed_axes=batch.integers(axes, 3),
            has_supports=bool(np.any(axes)),
            body_scratch=batch.blank(2 * h, arrays.BODY_SCRATCH),
            hinge_scratch=batch.blank(h, arrays.HINGE_SCRATCH),
            open=np.zeros(h, bool),
            peaks=batch.peaks_of(cls),
            names=np.arange(h),
            excess=batch.rows_of(cls),
            gaps=batch.blank(rows, 2),
            sums=batch.blank(h, arrays.SUMS) if is_counted else None,
            forces=batch.blank(rows * h, arrays.SUMS) if is_counted else None,
        )


def list_names(scene) -> set[str]:
    """Return all names of hinges and joints of a scene; a new joint needs another."""
    names = {e.name for kind, elements in scene.kinds.items() if kind.joins for e in elements}
    return names | {name for hinge in scene.hinges for name in (hinge.name, hinge.joint)}


def _bodies(scene, hinges: Sequence[Hinge]) -> np.ndarray:
    beams = [beam for hinge in hinges for beam in hinge.beams]
    axes = np.concatenate([hinge.axes for hinge in hinges])
    references = np.concatenate([hinge.references for hinge in hinges])
    p = [beam.particle for beam in beams]
    inverse_mass = ~scene.fixed[p, :3] / scene.mass[p, None]
    # In the order of hinge_arrays.py: ARM, AXIS, REF, NORMAL, AXIS_IM.
    arms = [beam.arm for beam in beams]
    return np.hstack([arms, axes, references, cross(axes, references), inverse_mass])


def places_of(scene, joints: Sequence[JointBase]) -> np.ndarray:
    """Positions (j, 3), m, global, of the free ends of the first virtual beams (rigid arms) of
    `joints` (j elements of a scene), as placed now: of the points that supports hold."""
    return np.array([element.beams[0].end_in(scene) for element in joints])


def are_alone(scene) -> list[bool]:
    """Return for each hinge of a scene whether it can be solved by itself, cheaper than as a
    coupled joint: it is revolute; nothing holds its angle exactly; its particles, unless held
    altogether, are in no other joint and have no Drive; and its own matrix is regular, whatever
    arms and axis become."""
    joints = [e for kind in scene.kinds if kind.joins for e in scene.kinds[kind]]
    uses = Counter(p for element in joints for p in element.particles)
    shared_particles = {p for p, count in uses.items() if count > 1 and not scene.fixed[p].all()}
    shared_particles.update(drive.particle for drive in scene.drives)
    driven_hinges = {holder.hinge for holder in Turn.find(scene)}
    return [
        hinge.type == "revolute"
        and h not in driven_hinges
        and shared_particles.isdisjoint(hinge.particles)
        and is_regular(hinge, scene.fixed)
        for h, hinge in enumerate(scene.hinges)
    ]


def two_of(scene, particles, owner: str) -> tuple[int, int]:
    """Return `particles`, indices of two different particles of a scene, as ints; raises SceneError
    if they are not that. owner: what messages call the element that joins them ("hinge A")."""
    first, second = (int(p) for p in particles)
    count = len(scene.position)
    if first == second or not (0 <= first < count and 0 <= second < count):
        raise SceneError(f"particles of {owner}", particles, "two different particles")
    return first, second


def arms(scene, particles, point) -> tuple[VirtualBeam, ...]:
    """Return the rigid arms (VirtualBeam) from two particles (pair of indices) of a scene to one
    `point` (3,) m, global, or from each to its own (2, 3)."""
    return tuple(scene.arm_to(p, q) for p, q in zip(particles, of_both(point), strict=True))


def of_both(vector) -> Any:
    """Return vectors (3,) of two particles: `vector` for both if it is (3,), its rows if (2, 3)."""
    vector = np.asarray(vector, float)
    if vector.ndim == 1:
        return vector, vector
    return vector if vector.shape == (2, 3) else np.broadcast_to(vector, (2, 3))


def is_regular(hinge: Hinge, fixed: np.ndarray) -> bool:
    """Return whether a hinge's constraint matrix can be inverted, so that it may be solved alone.
    fixed (n, 6): whether each particle is held along x, y, z and about x, y, z (global)."""
    return _is_regular(hinge.support, *(fixed[p].tobytes() for p in hinge.particles))


@lru_cache(1024)  # there are few cases, and each of many runs asks several times
def _is_regular(support: str, *masks: bytes) -> bool:
    """Return whether a lone hinge's matrix is regular. support: letters of the axes along which its
    point is held; masks: axes along and about which its two particles are held."""
    fixed1, fixed2 = (np.frombuffer(axes, bool) for axes in masks)
    point = np.array([axis in support for axis in AXES])
    double_axes = (fixed1[:3] & fixed2[:3]) | ((fixed1[:3] | fixed2[:3]) & point)
    in_part = any(turns.any() and not turns.all() for turns in (fixed1[3:], fixed2[3:]))
    return not (double_axes.any() or in_part or (fixed1[3:].all() and fixed2[3:].all()))


def unit(vector, noun: str) -> np.ndarray:
    """Return a vector (3,) scaled to length 1; raises SceneError if it is zero or not finite. noun:
    what the message calls it, as "axis of hinge A"."""
    vector = np.asarray(vector, float)
    size = length(vector)
    if not size > 0 or not math.isfinite(size):
        raise SceneError(noun, vector.tolist(), "a finite vector that is not zero")
    return vector / size
