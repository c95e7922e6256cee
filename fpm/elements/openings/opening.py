"""Openings of hinges: the angles, and ways of slides, that springs, stops and their like act on.

Theory: docs/mechanics.md, "Virtual beams and hinges". What acts on hinges acts on slides likewise,
with forces for moments, m for rad: SLIDE_UNITS has the units."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from fpm.declare import SLIDE_UNITS, index
from fpm.elements.batch import turns_of
from fpm.elements.cross import cross
from fpm.elements.joints.joint_types import TYPES
from fpm.elements.kind import Deformations, ElementType, Energy, Gate, Series
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.probe import Probe
from fpm.errors import SceneError

JOINT_LOSS = Energy("joint_loss", "joint_loss", "energy lost on joints: friction, dampers, impacts")
"""The account of all kinds that lose energy on openings."""

ONSET = 1.5
"""Largest share of a kick with which a damper begins (losses_kernels.onset): counted in the stable
step, so that an impact is not thrown back by its damper alone."""

FINER = 5.0, 8.0
"""By how much the step of stops and their like is finer than the stable one, without and with a
damper, whose rate is extrapolated: what strikes them then comes back within 1 % of its speed, and
as it strikes the energy balances within 2 %. At the stable step an impact takes two steps."""


PARTS = (
    "spring", "contact", "damper", "friction", "stop", "latch", "motor", "release", "loop", "other",
)  # fmt: skip
"""Parts of the moment on an opening, by the kinds that act on it (ElementType.acts_as)."""


@dataclass(frozen=True)
class Opening(ElementType):
    """The opening (joint coordinate) of a hinge (angle, rad) or slide (length, m), as an element
    type. Every hinge of a scene has one, of its index; `find` returns the scene's hinges."""

    resists_as = ""
    cost = 30.0

    @classmethod
    def find(cls, scene):
        return scene.hinges

    @classmethod
    def topology_of(cls, scene):
        return tuple((hinge.name, hinge.particles) for hinge in scene.hinges)

    @classmethod
    def pack(cls, batch):
        from fpm.elements.openings import opening_kernels as kernels

        hinges = batch.scene.hinges
        rows = batch.instants + 1
        parts = len(PARTS) if Probe.of_scene(batch.scene).moments else 0
        count = len(hinges) * parts
        return kernels.Openings(
            ends=batch.integers(p for hinge in hinges for p in hinge.particles),
            sides=batch.stack(2 * len(hinges), kernels.SIDE, _sides),
            axes=batch.blank(len(hinges), 3),
            angles=batch.table(cls, 2, lambda hinge: [hinge.opening] * 2),
            track=batch.blank(rows * len(hinges), 1),
            slides=batch.integers(hinge.slides for hinge in hinges),
            moments=batch.blank(count, kernels.PART_FIELDS),
            part_track=batch.blank(rows * count, 2),
            parts=parts,
            part=PARTS.index("other"),
        )

    @classmethod
    def get_arrays(cls, kind: type[ElementType], batch):
        """Return Openings for kernels of `kind`, with its index `part` in PARTS."""
        return batch.part(cls)._replace(part=PARTS.index(kind.acts_as or "other"))

    @classmethod
    def read_records(cls, part, scene, lane):
        values = part.track[:, 0, lane].reshape(-1, len(scene.hinges))
        series = Series(values, "rad", "opening of the hinges", "hinge", ())
        return by_unit({"opening": series}, scene.hinges, [h.name for h in scene.hinges])


class ConnectorElement(ElementType):
    """Base class of element types that act on openings (joint coordinates) of several hinges."""

    reads: ClassVar[tuple[type, ...]] = (Opening,)

    def check_index(self, scene, field, value):
        super().check_index(scene, field, value)
        if not (field.types or field.only_angles):
            return
        hinge = scene.hinges[value]
        if hinge.type not in (field.types or TYPES) or (field.only_angles and hinge.slides):
            allowed = f"one that is {' or '.join(field.types)}" if field.types else "an angle"
            raise SceneError(self.subject(scene, field), f"{hinge.name} ({hinge.type})", allowed)

    def unit_in(self, scene, unit):
        return unit_of(scene, self.acts_on()[0], unit) if unit in SLIDE_UNITS else unit

    @classmethod
    def array(cls, name, batch):
        return Opening.get_arrays(cls, batch) if name == "openings" else super().array(name, batch)


class Connector(ConnectorElement):
    """Base class of element types that act on the opening (joint coordinate) of one hinge. A
    subclass declares the field `hinge`, the hinge's index in the scene, by `on_hinge`."""

    hinge: Any
    onset: ClassVar[float] = 1.0  # largest share of a kick with which its damper begins

    def acts_on(self):
        return (self.hinge,)

    def label(self, scene) -> str:
        """Return the element's name in messages and files: by default its hinge's in `scene`."""
        return scene.hinges[self.hinge].name

    def title(self, scene):
        return f"{self.noun} {self.label(scene)}"

    @classmethod
    def names(cls, scene):
        return [element.title(scene) for element in cls.find(scene)]

    def check_alone(self, scene) -> None:
        """Check that the scene has no other element on this hinge with the same word in messages
        (`noun`, as "motor"), of whatever type; raises SceneError if it has."""
        kinds = [k for k in scene.kinds if issubclass(k, Connector) and k.noun == self.noun]
        if self.hinge in [element.hinge for kind in kinds for element in kind.find(scene)]:
            name, allowed = self.label(scene), f"one {self.noun} on a joint"
            raise SceneError(f"joint of a second {self.noun}", name, allowed)

    @classmethod
    def eventful(cls, scene):
        pairs = zip(super().eventful(scene), cls.find(scene), strict=False)
        hinges = scene.hinges
        return [
            x._replace(joint=hinge.name, gate=gate and gate._replace(slides=hinge.slides))
            for x, hinge, gate in ((x, hinges[e.hinge], e.gate()) for x, e in pairs)
        ]

    @classmethod
    def read_records(cls, part, scene, lane):
        elements = cls.find(scene)
        hinges = [scene.hinges[element.hinge] for element in elements]
        series = super().read_records(part, scene, lane)
        return by_unit(series, hinges, [element.label(scene) for element in elements])

    def gate(self) -> Gate | None:
        """Return the opening at which the element latches, is hit or closes; None: it does not."""
        return None

    def stiffness_in(self, scene) -> float | None:
        """Return the stiffness (N m/rad, on slides N/m) with which the element limits the scene's
        stable time step: its field `stiffness`; None: it has none."""
        return getattr(self, "stiffness", None)

    def damping_in(self, scene) -> float | None:
        """Return the damping (N m s/rad, on slides N s/m) with which the element limits the scene's
        stable time step: its field `damping`, times `onset`; None: it has none."""
        damping = getattr(self, "damping", None)
        return None if damping is None else self.onset * damping

    @classmethod
    def deformations(cls, scene):
        return cls._turns(scene, [e.stiffness_in(scene) for e in cls.find(scene)])

    @classmethod
    def dampings(cls, scene):
        return cls._turns(scene, [e.damping_in(scene) for e in cls.find(scene)])

    @classmethod
    def _turns(cls, scene, values: list) -> Deformations | None:
        hinges = [e.hinge for e in cls.find(scene)]
        return None if None in values else relative_turn(scene, hinges, values)

    @classmethod
    def array(cls, name, batch):
        if name == "rates":
            return pack_past(batch, cls)
        return super().array(name, batch)


def on_hinge(words: str = "hinge of {noun}", types: tuple[str, ...] = (), **keys) -> Any:
    """Declare a dataclass field for an element's hinge. words: its name in messages; types: allowed
    types of the hinge, (): all; keys: further ones of `Index`."""
    return index("hinges", words=words, types=types, **keys)


def by_unit(series: dict[str, Series], hinges, labels) -> dict[str, Series]:
    """Split recorded series (t, k) of k elements into those on hinges and on slides; names of these
    begin with "slide_", with force for moment, and their units. series: by variable; hinges,
    labels: Hinge and name of each element."""
    result = {}
    slides = np.array([hinge.slides for hinge in hinges], bool)
    for columns, prefix in ((~slides, ""), (slides, "slide_")):
        names = tuple(label for label, is_chosen in zip(labels, columns, strict=True) if is_chosen)
        for name, (values, unit, text, dimension, *_) in series.items() if names else ():
            if prefix:
                unit = SLIDE_UNITS[unit]
                dimension = "slide" if dimension == "hinge" else f"{prefix}{dimension}"
                text = text.replace("hinges", "slides").replace("moment", "force")
                text = text.replace("angular impulse", "impulse")
                name = prefix + name.replace("moment", "force")
            result[name] = Series(values[:, columns], unit, text, dimension, names)
    return result


def unit_of(scene, hinge: int, unit: str) -> str:
    """Return the unit of a quantity on a hinge: `unit`, as "N m/rad", where it turns; on a slide
    that of SLIDING, as "N/m" (KeyError for others). scene: has the hinge; hinge: its index."""
    return SLIDE_UNITS[unit] if scene.hinges[hinge].slides else unit


def _sides(scene) -> np.ndarray:
    """Axis, reference and their product (2h, 9) of either side of every hinge."""
    axes = np.concatenate([hinge.axes for hinge in scene.hinges])
    ends = np.concatenate([hinge.ends for hinge in scene.hinges])
    return np.hstack([axes, ends, cross(axes, ends)])


def backlashes(batch, kind: type[ElementType]) -> np.ndarray | None:
    """Return the widths (elements, 1, lanes) of dead bands (rad or m); None: no element has one."""
    if all(element.backlash is None for element in kind.find(batch.scene)):
        return None
    return batch.table(kind, 1, lambda element: [element.backlash or 0.0])


def relative_turn(scene, hinges, stiffness) -> Deformations:
    """Return how small motions of particles strain springs on joint coordinates (Deformations), one
    row each, up to three on the angle of a universal joint. hinges: index of each one's hinge;
    stiffness: N m/rad, on slides N/m."""
    dofs, values, factors, element = [], [], [], []
    for number, h in enumerate(hinges):
        hinge = scene.hinges[h]
        hinge_dofs = np.concatenate([6 * p + np.arange(6) for p in hinge.particles])
        for row, factor in _strains(scene, hinge):
            dofs.append(hinge_dofs)
            values.append(row)
            factors.append(factor * stiffness[number])
            element.append(number)
    shape = (-1, 12)
    rows = np.array(dofs, int).reshape(shape), np.array(values, float).reshape(shape)
    return Deformations(*rows, np.array(factors, float), np.array(element, int))


def _strains(scene, hinge) -> list[tuple[np.ndarray, float]]:
    """Derivatives (12,) of an opening by the motions of both particles, with factors on the
    stiffness. Particles of a slide turn together, but for the normal of their plane: the turn may
    be that of either or both, as bounds the frequency best. In the second particle the axis of a
    universal joint's angle lies anywhere in a plane; springs to the ground from both bound it
    (Cauchy)."""
    axis1, axis2 = hinge.axes
    zero = np.zeros(3)
    if not hinge.slides and hinge.type != "universal":
        return [(np.concatenate([zero, -axis1, zero, axis2]), 1.0)]
    no_turn = turns_of(scene).no_turn
    first, second = (~no_turn[p] / scene.inertia[p] for p in hinge.particles)
    if hinge.slides:
        p, q = hinge.particles
        axis, normal = (scene.frame[p] @ v[0] for v in (hinge.axes, hinge.references))
        arm = scene.frame[q] @ hinge.beams[1].arm
        levers = scene.position[p] - scene.position[q] - arm, arm
        if hinge.opening_type.direction == "axis":
            normal = np.zeros(3)
        # About the normal of their plane particles turn apart.
        parts = [np.cross(lever, axis) @ normal * normal for lever in levers]
        turn = np.cross(scene.position[p] - scene.position[q], axis) - parts[0] - parts[1]
        turns = [scene.frame[particle].T @ turn for particle in (p, q)]
        parts = [scene.frame[i].T @ part for i, part in zip((p, q), parts, strict=True)]
        soft, soft2 = turns[0] ** 2 @ first, turns[1] ** 2 @ second
        ratio = soft2 / (soft + soft2) if soft + soft2 > 0 else 0.0
        frame = scene.frame if scene.unstrained is None else scene.unstrained
        axis1, axis2 = frame[p] @ axis1, frame[q] @ axis2
        turns = [ratio * turns[0] + parts[0], (1 - ratio) * turns[1] + parts[1]]
        return [(np.concatenate([-axis1, turns[0], axis2, turns[1]]), 1.0)]
    plane = np.linalg.svd(hinge.references[1][None])[2][1:]  # normal to the axis on the second
    soft = axis1**2 @ first
    softest = float(np.linalg.eigvalsh(plane * second @ plane.T)[-1])
    rows = [(np.concatenate([zero, -axis1, zero, zero]), soft)]
    rows += [(np.concatenate([zero, zero, zero, axis]), softest) for axis in plane]
    return [(row, (soft + softest) / inverse) for row, inverse in rows if inverse > 0]


def struck_stiffness(element) -> float:
    """Return FINER² times the stiffness of what is struck, as a stop, for the stable step."""
    return FINER[bool(getattr(element, "damping", 0.0))] ** 2 * element.stiffness


def mobility(scene, hinge: int) -> float:
    """Return the acceleration of a joint coordinate by a unit moment (slides: force), the joint's
    two particles alone: 1/(kg m²), slides 1/kg; 0 where both are held. hinge: index in `scene`."""
    joint, no_turn = scene.hinges[hinge], turns_of(scene).no_turn
    if joint.slides:
        rows = relative_turn(scene, [hinge], [1.0])
        mass = np.tile(scene.mass, (3, 1)).T
        free = ~np.hstack([scene.fixed[:, :3], no_turn])
        inverse = free / np.column_stack([mass, scene.inertia])
        return float(rows.values[0] ** 2 @ inverse.ravel()[rows.dofs[0]])
    freedom = [~no_turn[p] / scene.inertia[p] for p in joint.particles]
    return float(sum(axis**2 @ inverse for axis, inverse in zip(joint.axes, freedom, strict=True)))


def moving_at_start(scene) -> SimpleNamespace:
    """Return the motion of all n particles at t = 0: a namespace of velocity, spin, position (n, 3)
    and frame (n, 3, 3). Driven particles move as prescribed, held ones not."""
    spin = np.where(scene.fixed[:, 3:], 0.0, scene.spin)
    motion = SimpleNamespace(velocity=np.where(scene.fixed[:, :3], 0.0, scene.velocity), spin=spin)
    motion.position, motion.frame = scene.position.copy(), scene.frame.copy()
    Drive.prescribe(scene, 0.0, motion)
    return motion


def turning_at_start(scene, hinges) -> list[float]:
    """Return the rates (rad/s, on slides m/s) of some joint coordinates at t = 0, including the
    motion of driven particles. hinges: indices of the hinges in the scene."""
    motion = moving_at_start(scene)
    return [rate_at(scene, scene.hinges[h], motion) for h in hinges]


def rate_at(places, hinge, motion) -> float:
    """Return the rate of a hinge's joint coordinate (rad/s, m/s). places: object with position and
    frame of all particles, as a scene; motion: with velocity (m/s) and spin (rad/s)."""
    i, j = hinge.particles
    axis = places.frame[i] @ hinge.axes[0]
    if not hinge.slides:
        return float(axis @ (motion.spin[j] - motion.spin[i]))
    point = hinge.beams[1].end_in(places)
    first, second = (
        motion.velocity[p] + np.cross(motion.spin[p], point - places.position[p]) for p in (i, j)
    )
    return float(axis @ (second - first))


def pack_past(batch, kind) -> np.ndarray:
    """Return the array (elements, 2, lanes) that kernels of what loses energy keep from step to
    step: rate of each joint coordinate at t = 0 (rad/s, m/s), and 0 for its moment."""
    from fpm.elements.openings.losses_kernels import HISTORY

    hinges = [element.hinge for element in kind.find(batch.scene)]
    rest = [0.0] * (HISTORY - 1)
    rows = lambda scene: [[rate, *rest] for rate in turning_at_start(scene, hinges)]  # noqa: E731
    return batch.stack(len(hinges), HISTORY, rows)


def start_angles(batch, kind) -> np.ndarray:
    """Return the joint coordinates (n, lanes; rad, of slides m) at t = 0 of the hinges of all n
    elements of a type, `kind`. batch: the scenes that are simulated side by side."""
    hinges = [element.hinge for element in kind.find(batch.scene)]
    return batch.stack(len(hinges), 1, lambda s: [[s.hinges[h].opening] for h in hinges])[:, 0]


def opening_at(scene, hinge) -> float:
    """Return the joint coordinate (rad, of a slide m) of a hinge (Hinge) at the scene's present
    positions and frames; of angles that differ by full turns the one closest to hinge.opening."""
    axis, zero, end = (
        scene.frame[p] @ vectors[k]
        for p, vectors, k in (
            (hinge.particles[0], hinge.axes, 0),
            (hinge.particles[0], hinge.ends, 0),
            (hinge.particles[1], hinge.ends, 1),
        )
    )
    if hinge.slides:
        first, second = (
            scene.position[p] + e for p, e in zip(hinge.particles, (zero, end), strict=True)
        )
        return float(axis @ (second - first))
    return opening_angle(axis, zero, end, hinge.opening)


def opening_angle(axis, first, second, guess: float) -> float:
    """Return the angle (rad) from `first` to `second` about `axis`, vectors (3,), by the right-hand
    rule; of all that differ by full turns the one closest to `guess` (rad)."""
    angle = np.arctan2(np.dot(axis, cross(first, second)), np.dot(first, second))
    return float(angle + 2 * np.pi * np.round((guess - angle) / (2 * np.pi)))
