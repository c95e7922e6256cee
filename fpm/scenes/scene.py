"""A scene: particles and the elements between them, at their starting state.

A scene describes one sample. Scenes that differ only in numbers can run side by side (simulate.py).
Everything is in SI units; positions, directions and loads are given in global axes at the start."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from fpm.elements import (
    Beams,
    Cable,
    Contact,
    Damping,
    Drive,
    ElementType,
    Gravity,
    Hinge,
    Joint,
    Load,
    Support,
    TorsionSpring,
    kinds_of,
)
from fpm.elements.bars.beam import Material, Section, lump, triad
from fpm.elements.cross import length as size
from fpm.elements.kind import VirtualBeam
from fpm.errors import SceneError
from fpm.scenes.curve import CONSTANT, Curve


@dataclass(frozen=True)
class Link:
    """A straight bar as it was added to a scene. particles (n,): their indices from start to end;
    triad (3, 3): its global axes as columns, the first along it, then y and z of its section."""

    particles: np.ndarray
    triad: np.ndarray


_EYE = np.eye(3)


def _rows(values, *shape: int) -> np.ndarray:
    """Return an array of a shape, from one row for all or one row for each."""
    array = np.empty(shape)
    array[...] = values
    return array


def _elements(kind: type[ElementType]) -> property:
    """Return the scene's list of elements of a kind."""

    def get(scene: "Scene") -> list:
        return scene.kinds.setdefault(kind, [])

    def put(scene: "Scene", elements: Sequence) -> None:
        scene.kinds = {**scene.kinds, kind: list(elements)}  # not in a copy of the scene

    return property(get, put, doc=f"The elements of kind {kind.__name__}.")


class Scene:
    """Particles of one sample at their start, and the elements between and on them.

    Arrays of its n particles: position (n, 3) m; frame (n, 3, 3), own axes as columns; velocity (n,
    3) m/s; spin (n, 3) rad/s; mass (n,) kg; inertia (n, 3) kg m²; fixed (n, 6): whether it is held
    along and about x, y, z. kinds: lists of elements by element type (fpm/elements); curves: list
    of Curve, of time; points: named ones (VirtualBeam), for responses; supports: those held or
    driven; bodies: index of the particle of each named rigid body; unstrained, unstrained_position:
    frames and positions before fpm.assembly strained the scene, None: as they are; assembly: what
    that did, or None; equilibrium: likewise of fpm.assembly; opening_rates: rates of
    joint coordinates stated for the start (rad/s, of slides m/s), by hinge; bearings: friction of
    joints in quasi-static travel, by hinge: mu r (m; slides: mu); classes, action_names: of
    elements by (type, index): class in torque margins where it is not its type's, and name in the
    structure's file; doubts: sentences on what the file has that is hardly meant, for
    structures.plausible.

    Parameters
    ----------
    name: its name in messages.
    gravity: acceleration of gravity (3,), m/s², in global axes.
    damping: rate (1/s) of mass-proportional damping: force -rate mass velocity; rotations alike."""

    def __init__(self, name: str = "scene", gravity=(0.0, 0.0, 0.0), damping: float = 0.0):
        self.name = name
        self.position = np.zeros((0, 3))
        self.frame = np.zeros((0, 3, 3))
        self.unstrained: np.ndarray | None = None  # frames (n, 3, 3) without strain; None: `frame`
        self.unstrained_position: np.ndarray | None = None  # and positions (n, 3); None: `position`
        self.assembly: Any = None  # what forced it together, an fpm.assembly.Assembly
        self.equilibrium: Any = None  # in which it starts, an fpm.assembly.Equilibrium
        self.velocity = np.zeros((0, 3))
        self.spin = np.zeros((0, 3))
        self.mass = np.zeros(0)
        self.inertia = np.zeros((0, 3))
        self.fixed = np.zeros((0, 6), bool)
        self.kinds: dict[type[ElementType], list] = {}
        self.curves: list[Curve] = []
        self.points: dict[str, VirtualBeam] = {}
        self.bodies: dict[str, int] = {}  # rigid ones that have a name, with their particles
        self.supports: dict[str, VirtualBeam] = {}  # named points that are held or driven
        self.opening_rates: dict[int, float] = {}
        self.bearings: Counter[int] = Counter()  # by hinge: mu r (m), of slides mu, where it is led
        self.classes: dict[tuple[type, int], str] = {}  # other than ElementType.resists_as
        self.doubts: list[str] = []  # what is hardly meant in a structure's file
        self.action_names: dict[tuple[type, int], str] = {}  # as a structure's file has them
        self.gravity, self.damping = gravity, damping

    def _repr_html_(self) -> str:
        describe = import_module("fpm.structures.describe")  # which knows scenes
        return describe.to_html(self.name, "", *describe.list_parts(self))

    beams = _elements(Beams)
    hinges = _elements(Hinge)
    springs = _elements(TorsionSpring)
    contacts = _elements(Contact)
    loads = _elements(Load)
    cables = _elements(Cable)
    drives = _elements(Drive)

    @property
    def gravity(self) -> np.ndarray:
        """Acceleration of gravity (3,), m/s², the sum of all Gravity elements; may be set."""
        return sum((g.acceleration for g in self.kinds.get(Gravity, [])), np.zeros(3))

    @gravity.setter
    def gravity(self, acceleration) -> None:
        self.kinds = {**self.kinds, Gravity: [Gravity(np.asarray(acceleration, float))]}

    @property
    def damping(self) -> float:
        """Mass-proportional damping (1/s), the sum of all Damping elements; may be set."""
        return float(sum(d.rate for d in self.kinds.get(Damping, [])))

    @damping.setter
    def damping(self, rate: float) -> None:
        damping = Damping(float(rate))
        damping.check(self)
        self.kinds = {**self.kinds, Damping: [damping]}

    def add(self, element: ElementType) -> int:
        """Add an element of any type; returns its index among the scene's of that type (-1 for a
        Support, which is only applied). SceneError if it does not fit, as by a wrong index."""
        element.add_to(self)
        return len(self.kinds.get(type(element), [])) - 1

    # -- particles and beams ------------------------------------------------------------------

    def add_particles(self, position, mass, inertia, frame=None, velocity=0.0, spin=0.0):
        """Add n particles; return their indices (n,). position: (n, 3) or (3,), m; mass (kg) and
        principal inertia (kg m², own axes), above 0, for each or all; frame: own axes as columns,
        None: the global ones; velocity, spin: at the start, global. SceneError for masses <= 0,
        frames no rotations."""
        position = np.atleast_2d(np.asarray(position, float))
        first, n = len(self.position), len(position)
        mass, inertia = _rows(mass, n), _rows(inertia, n, 3)
        if not (mass.min(initial=1.0) > 0 and inertia.min(initial=1.0) > 0):
            value, allowed = (mass.min(), inertia.min()), "positive values for every particle"
            raise SceneError("mass, inertia", value, allowed)
        frame = np.asarray(_EYE if frame is None else frame, float)
        deviation = frame.swapaxes(-1, -2) @ frame - _EYE
        if abs(deviation).max() > 1e-9 or np.any(np.linalg.det(frame) < 0):
            raise SceneError("frame", "(not a rotation)", "right-handed orthonormal axes")
        self.position = np.concatenate([self.position, position])
        self.mass = np.concatenate([self.mass, mass])
        self.inertia = np.concatenate([self.inertia, inertia])
        # No copy for each: by it numpy lays frames out, and by that their products round.
        frames = frame[None] if frame.ndim == 2 and n == 1 else np.broadcast_to(frame, (n, 3, 3))
        self.frame = np.concatenate([self.frame, frames])
        self.velocity = np.concatenate([self.velocity, _rows(velocity, n, 3)])
        self.spin = np.concatenate([self.spin, _rows(spin, n, 3)])
        self.fixed = np.concatenate([self.fixed, np.zeros((n, 6), bool)])
        if self.unstrained is not None:  # parts were forced together before
            self.unstrained = np.concatenate([self.unstrained, self.frame[first:]])
            self.unstrained_position = np.concatenate([self.unstrained_position, position])
        return np.arange(first, first + n)

    def add_beams(self, nodes, section: Section, material: Material, normal, name="beam"):
        """Add beam elements between existing particles, free of stress as they lie. nodes (m, 2):
        particles at both ends; normal: vector in the plane of the chord and the section's z axis,
        (3,) or (m, 3); name: prefix of the elements' names."""
        self.add(Beams.create(self, nodes, section, material, normal, name))

    def add_link(
        self,
        start,
        end,
        normal,
        section: Section,
        material: Material,
        elements: int,
        name: str = "link",
        inertia_scale: float = 1.0,
    ) -> Link:
        """Add a straight bar of equal beam elements; its particles have the bar's axes and share
        its mass, lumped (bars/beam.py). start, end: (3,), m; normal: as in `add_beams`;
        inertia_scale: factor, at least 1, on the section's rotational inertia. SceneError if they
        give no bar."""
        start, end = np.asarray(start, float), np.asarray(end, float)
        chord = end - start
        length = size(chord)
        if not (math.isfinite(length) and length > 0):
            raise SceneError(f"length of {name}", length, "a positive, finite length (m)")
        mass, inertia = lump(length, elements, section, material, inertia_scale)
        axes = triad(chord, normal)
        position = start + np.linspace(0.0, 1.0, elements + 1)[:, None] * chord
        particles = self.add_particles(position, mass, inertia, axes)
        nodes = particles[:-1, None] + np.arange(2)
        m = len(nodes)
        lengths, triads = _rows(length / elements, m), _rows(axes, m, 3, 3)
        self.add(Beams(nodes, lengths, triads, section, material, name))
        return Link(particles, axes)

    # -- hinges, springs, contact -------------------------------------------------------------

    def add_hinge(self, name, particles, point, axis, opening=0.0, support=""):
        """Join two particles by a hinge; return its index. point (m) and axis: (3,), global, or one
        for each particle, if `fpm.assembly` brings them together; opening: at the start (rad);
        support: global axes along which the point is held, as "xz"."""
        return self.add(Hinge.create(self, name, particles, point, axis, opening, support))

    def add_joint(self, name, type, particles, point, axis=(1, 0, 0), axis2=None) -> int:
        """Join two particles by a joint that is not a hinge, "spherical", "fixed", "universal"
        (axis2: its axis on the second particle) or "prismatic"; return its index among the joints.
        point, axis: as in `add_hinge`."""
        return self.add(Joint.create(self, name, type, particles, point, axis, axis2))

    def add_slide(self, name, particles, point, axis, opening: float = 0.0) -> int:
        """Join two particles by a slide, the second on the first along `axis`; return its index
        among the hinges. point: as in `add_hinge`; opening: at the start (m)."""
        return self.add_sliding_joint(name, "prismatic", particles, point, axis, (opening,))

    def add_universal(self, name, particles, point, axis, axis2, openings=(0.0, 0.0)) -> int:
        """Join two particles by a universal joint; return the index of the first opening, the hinge
        `<name>_axis` of the cross against the first particle; the next, `<name>_other`, is of the
        second against the cross. axis, axis2: on both particles, normal to each other; openings: at
        the start (rad)."""
        hinges = Joint.universal(self, name, particles, point, axis, axis2, openings)
        return min(self.add(hinge) for hinge in hinges)

    def add_sliding_joint(
        self, name, type, particles, point, axis, openings, x=None, lead=0.0
    ) -> int:
        """Join two particles by a "prismatic", "cylindrical", "planar", "pin in slot" or "screw"
        joint; return the index of its first opening, the hinge `<name>_turn`; the next are
        `_slide`, or `_x` and `_y`; a prismatic joint or screw has one, by the joint's name.
        openings: at the start (rad; m); x: direction of the slot, or first one in the plane, None:
        any; lead: of a screw (m/rad)."""
        values = name, type, particles, point, axis, x, openings, lead
        return min(self.add(hinge) for hinge in Joint.create_openings(self, *values))

    def hold_point(self, name, particle: int, point, axes: str) -> int:
        """Hold a point (m) of a particle along global axes, as "xy"; return its index among the
        joints. To hold the particle itself, `fix` costs nothing."""
        return self.add(Joint.held_point(self, name, int(particle), point, axes))

    def add_torsion_spring(self, hinge: int, stiffness: float, rest: float = 0.0) -> None:
        """Add a linear spring (N m/rad; N/m) that turns a hinge towards `rest`."""
        self.add(TorsionSpring(int(hinge), float(stiffness), float(rest)))

    def add_cable(
        self, name, points, EA, rest=None, preload=None, reel=0.0, curve=-1, friction=None, **drum
    ):
        """Add a cable through points; return its index. points: pairs of a particle and a position
        (m; None: the particle's); EA: stiffness (N); rest: unstrained length (m), or preload:
        tension (N) at the start; reel: length (m) that a winch at the first point takes in where
        its curve of time is 1; friction: coefficient at points between the ends, None: they turn
        freely; drum: drum (hinge whose opening winds it at the first point), radius (m, below 0
        where a growing opening unwinds it), least (m, unstrained length outside, None: a
        quarter)."""
        fields = {"reel": float(reel), "curve": int(curve), "friction": friction, **drum}
        return self.add(Cable.create(self, name, points, EA, rest, preload, **fields))

    # -- supports, loads, drives, points ------------------------------------------------------

    def fix(self, particles, translations: str = "xyz", rotations: str = "xyz") -> None:
        """Hold particles along and about global axes, letters of "xyz". Those with unlike moments
        of inertia are held about none, two or all axes."""
        self.add(Support(tuple(np.atleast_1d(particles)), translations, rotations))

    def add_curve(
        self, times: Sequence[float], values: Sequence[float], smooth: bool = False
    ) -> int:
        """Add a curve of time through values at increasing times (s), constant beyond; return its
        index. smooth: a cubic, not straight, between them. SceneError for times that do not
        increase, not as many values, or values whose differences overflow."""
        places, heights = np.asarray(times, float), np.asarray(values, float)
        if places.shape != heights.shape or places.ndim != 1 or np.any(np.diff(places) <= 0):
            raise SceneError("times", places.tolist(), "increasing times, one for each value")
        with np.errstate(over="ignore"):
            slopes = np.diff(heights) / (np.diff(places) if smooth else 1.0)
        if not np.isfinite(slopes).all():
            allowed = "values that do not differ by more than numbers can"
            raise SceneError("values", float(np.abs(heights).max()), allowed)
        self.curves.append((Curve.smooth if smooth else Curve.table)(places, heights))
        return len(self.curves) - 1

    def curve(self, index: int) -> Curve:
        """Return the curve of time of an index; of -1 that which is always 1."""
        return self.curves[index] if index >= 0 else CONSTANT

    def add_load(self, particle, force=(0, 0, 0), moment=(0, 0, 0), arm=(0, 0, 0), curve=-1):
        """Add a load of constant global direction on a particle: force (N), moment (N m), arm (m)
        to where the force acts, which turns with the particle; curve: index of what scales both,
        -1: constant."""
        frame = self.frame if self.unstrained is None else self.unstrained
        beam = VirtualBeam(int(particle), frame[particle].T @ np.asarray(arm, float))
        self.add(Load(beam, np.asarray(force, float), np.asarray(moment, float), int(curve)))

    def drive(self, particle: int, velocity=(0, 0, 0), spin=(0, 0, 0), curve: int = -1) -> None:
        """Prescribe the motion of a particle, velocity (m/s) and spin (rad/s), global, times a
        curve of time (-1: constant). Its drives add up (spins: one turn after another)."""
        velocity, spin = np.asarray(velocity, float), np.asarray(spin, float)
        self.add(Drive(int(particle), velocity, spin, int(curve)))

    def add_point(self, name: str, particle: int, position=None) -> None:
        """Name a point that is fixed to a particle, for responses. position: at the start (3,), m;
        None: the particle's. SceneError for a name in use."""
        if name in self.points:
            raise SceneError("point", name, f"a name not yet used ({', '.join(self.points)})")
        self.points[name] = self.arm_to(int(particle), position)

    def arm_to(self, particle: int, point=None) -> VirtualBeam:
        """Return the rigid arm (VirtualBeam) from a particle to a `point` (3,), m, at the start
        (None: its own); where parts were forced together (fpm.assembly), both as before that."""
        position, frame = self.unstrained_position, self.unstrained
        if position is None or frame is None:
            position, frame = self.position, self.frame
        point = position[particle] if point is None else np.asarray(point)
        return VirtualBeam(particle, frame[particle].T @ (point - position[particle]))

    # -- names -----------------------------------------------------------------------

    @property
    def elements(self) -> list[str]:
        """Names of all elements of the scene that store energy, in the order of element types."""
        return [name for kind in kinds_of([self]) if kind.stores for name in kind.names(self)]
