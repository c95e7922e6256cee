"""A scene: particles and the elements between them, at their starting state.

A scene describes one sample. Scenes that differ only in numbers can run side by side (simulate.py).
Everything is in SI units; positions, directions and loads are given in global axes at the start."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
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
from fpm.elements.bars.beam import Material, Section, triad
from fpm.elements.bars.lumping import lump
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


@cache
def _fractions(elements: int) -> np.ndarray:
    """Return the positions of a bar's particles as fractions of its length."""
    return np.linspace(0.0, 1.0, elements + 1)


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
    that did, or None; equilibrium: likewise of fpm.assembly.equilibrium; opening_rates: rates of
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
        self.equilibrium: Any = None  # in which it starts, an fpm.assembly.equilibrium.Equilibrium
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
        """Acceleration of gravity (3,), m/s², in global axes: the sum of all Gravity elements of
        the scene. Setting it puts one in their place."""
        return sum((g.acceleration for g in self.kinds.get(Gravity, [])), np.zeros(3))

    @gravity.setter
    def gravity(self, acceleration) -> None:
        self.kinds = {**self.kinds, Gravity: [Gravity(np.asarray(acceleration, float))]}

    @property
    def damping(self) -> float:
        """Mass-proportional damping rate (1/s): the sum of all Damping elements of the scene.
        Setting it puts one in their place."""
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
        """Add n particles; returns indices (n,). SceneError for masses <= 0, frames no rotations.

        Parameters
        ----------
        position: positions (m), (n, 3), or (3,) for one.
        mass: masses (kg), (n,) or one for all, above 0.
        inertia: principal moments of inertia (kg m²), own axes, (n, 3) or one for all, above 0.
        frame: own axes as columns, (n, 3, 3) or (3, 3) for all; None: the global axes.
        velocity, spin: at the start (m/s, rad/s), global, (n, 3) or one for all."""
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
        """Add m beam elements between existing particles, free of stress as they lie.

        Parameters
        ----------
        nodes: indices of the particles at both ends, (m, 2).
        section, material: of all elements (Section, Material).
        normal: vector in the plane of the chord and the section's local z axis, (3,) or (m, 3).
        name: prefix of the elements' names."""
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
        """Add a straight bar of equal beam elements; returns the Link. The particles have the bar's
        axes and share its mass, lumped (bars/lumping.py). SceneError if ends or normal give no bar.

        Parameters
        ----------
        start, end: ends of the bar (3,), m, global.
        normal: vector (3,) in the plane of the bar and its section's local z axis.
        section, material: of the bar (Section, Material).
        elements: number of beam elements, at least 1.
        name: prefix of the elements' names.
        inertia_scale: factor, at least 1, on the section's rotational inertia."""
        start, end = np.asarray(start, float), np.asarray(end, float)
        chord = end - start
        length = size(chord)
        if not (math.isfinite(length) and length > 0):
            raise SceneError(f"length of {name}", length, "a positive, finite length (m)")
        mass, inertia = lump(length, elements, section, material, inertia_scale)
        axes = triad(chord, normal)
        position = start + _fractions(elements)[:, None] * chord
        particles = self.add_particles(position, mass, inertia, axes)
        nodes = particles[:-1, None] + np.arange(2)
        m = len(nodes)
        lengths, triads = _rows(length / elements, m), _rows(axes, m, 3, 3)
        self.add(Beams(nodes, lengths, triads, section, material, name))
        return Link(particles, axes)

    # -- hinges, springs, contact -------------------------------------------------------------

    def add_hinge(self, name, particles, point, axis, references=None, opening=0.0, support=""):
        """Join two particles by a hinge; returns its index. `point` and `axis` may be (2, 3), one
        for each particle, if `fpm.assembly` brings them together.

        Parameters
        ----------
        name: its name, which no other joint has.
        particles: indices of the first and the second particle.
        point: position of the hinge (3,), m, global.
        axis: direction of the axis (3,), global.
        references: two directions (3,) at the start, normal to the axis, fixed to the particles;
            the opening is the angle from the first to the second. None: the opening is `opening`.
        opening: opening (rad) at the start; with references, which of those 2 pi apart is meant.
        support: global axes along which the hinge point is held: "", "z", "xyz"."""
        values = name, particles, point, axis, references, opening, support
        return self.add(Hinge.create(self, *values))

    def add_joint(self, name, type, particles, point, axis=(1, 0, 0), axis2=None) -> int:
        """Join two particles by a joint that is no hinge; returns its index among the joints.

        Parameters
        ----------
        name: its name, which no other joint has.
        type: "spherical"; "fixed"; "universal", about `axis` of the first and `axis2` of the second
            particle; "prismatic", where the second slides on the first along `axis`.
        particles: indices of the first and the second particle.
        point: position (3,), m, global; (2, 3), one for each, if `fpm.assembly` joins them.
        axis: direction of the axis (3,), global.
        axis2: universal joint's axis on the second particle (3,), normal to `axis`; None: any."""
        return self.add(Joint.create(self, name, type, particles, point, axis, axis2))

    def add_slide(self, name, particles, point, axis, opening: float = 0.0) -> int:
        """Join particles by a slide, the second on the first; returns its index among the hinges.

        Parameters
        ----------
        name: its name, which no other joint has.
        particles: indices of the first and the second particle.
        point: position (3,), m, global; (2, 3), one for each, if `fpm.assembly` joins them.
        axis: direction of the slide (3,), global, in which the opening grows.
        opening: opening (m) at the start."""
        return self.add(Joint.slide(self, name, particles, point, axis, opening))

    def add_universal(self, name, particles, point, axis, axis2, openings=(0.0, 0.0)) -> int:
        """Join two particles by a universal joint with two openings; returns the index of the
        first. The openings are the hinges `<name>_axis`, of the cross against the first particle,
        and `<name>_other`, the next index, of the second particle against the cross.

        Parameters
        ----------
        name: its name, which no other joint has.
        particles: indices of the first and the second particle.
        point: position of the joint (3,), m, global.
        axis, axis2: axes on the first and on the second particle (3,), normal to each other.
        openings: both openings (rad) at the start."""
        hinges = Joint.universal(self, name, particles, point, axis, axis2, openings)
        return min(self.add(hinge) for hinge in hinges)

    def add_sliding_joint(
        self, name, type, particles, point, axis, openings, x=None, lead=0.0
    ) -> int:
        """Join two particles by a joint whose second part slides and turns; returns the index of
        the first of its openings, the hinge `<name>_turn`; the next are `_slide`, or `_x` and `_y`.

        Parameters
        ----------
        name: its name, which no other joint has.
        type: "cylindrical"; "planar", normal to `axis`; "pin in slot", which is along `x`; "screw",
            whose one opening, the turn, has the joint's name.
        particles: indices of the first and the second particle.
        point: position of the joint (3,), m, global; (2, 3), one for each, if `fpm.assembly` joins
            them.
        axis: direction (3,), global, about which the second turns.
        openings: at the start (rad; m), in that order.
        x: direction (3,) of the slot, or first direction in the plane, normal to `axis`; None: any.
        lead: of a screw (m/rad), not 0."""
        values = name, type, particles, point, axis, x, openings, lead
        return min(self.add(hinge) for hinge in Joint.create_openings(self, *values))

    def hold_point(self, name, particle: int, point, axes: str) -> int:
        """Hold a point of a particle along global axes; returns the index among the joints. To hold
        the particle itself, `fix` costs nothing.

        Parameters
        ----------
        name: its name, which no other joint has.
        particle: index of the particle.
        point: position of the point (3,), m, at the start.
        axes: global axes along which it is held, as "z" or "xy"."""
        return self.add(Joint.held_point(self, name, int(particle), point, axes))

    def add_torsion_spring(self, hinge: int, stiffness: float, rest: float = 0.0) -> None:
        """Add a linear spring that turns a hinge towards an opening.

        Parameters
        ----------
        hinge: index of the hinge or slide.
        stiffness: N m/rad, at least 0; on a slide N/m.
        rest: opening (rad) without moment; on a slide m."""
        self.add(TorsionSpring(int(hinge), float(stiffness), float(rest)))

    def add_cable(
        self, name, points, EA, rest=None, preload=None, reel=0.0, curve=-1, friction=None, **drum
    ):
        """Add a cable through points of particles; returns its index.

        Parameters
        ----------
        name: its name, which no other cable has.
        points: pairs of a particle's index and a position (3,), m, on it, None: the particle's.
        EA: axial stiffness (N), above 0.
        rest: unstrained length (m); this or `preload`.
        preload: tension (N) at the start; this or `rest`.
        reel: length (m) that a winch at the first point takes in where its curve is 1.
        curve: index of the winch's curve of time; -1: none.
        friction: coefficient of friction at the points between the ends; None: they turn freely.
        drum: keys drum (index of the hinge whose opening winds it at the first point), radius (m,
            below 0 where a growing opening unwinds it), least (unstrained length in m down to which
            it may be wound; None: a quarter of that at the start). None of them: no drum."""
        fields = {"reel": float(reel), "curve": int(curve), "friction": friction, **drum}
        return self.add(Cable.create(self, name, points, EA, rest, preload, **fields))

    # -- supports, loads, drives, points ------------------------------------------------------

    def fix(self, particles, translations: str = "xyz", rotations: str = "xyz") -> None:
        """Hold particles along and about global axes. Those in joints, with unlike moments of
        inertia, are held about none, two or all axes.

        Parameters
        ----------
        particles: index of one or indices of several.
        translations, rotations: axes along and about which they are held: letters of "xyz"."""
        self.add(Support(tuple(np.atleast_1d(particles)), translations, rotations))

    def add_curve(
        self, times: Sequence[float], values: Sequence[float], smooth: bool = False
    ) -> int:
        """Add a curve of time through points; returns its index. times: of these (s), increasing;
        values: at them, in the unit of what refers to the curve, constant beyond both ends; smooth:
        whether it is a smooth cubic, not straight, between them. SceneError for times that do not
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
        """Add a dead load on a particle: it keeps its global direction.

        Parameters
        ----------
        particle: index of the particle.
        force, moment: force (3,), N, and moment (3,), N m, in global axes.
        arm: vector (3,), m, in global axes at the start, from the particle to where the force acts;
            it turns with the particle.
        curve: index of the curve of time that scales both; -1: constant."""
        frame = self.frame if self.unstrained is None else self.unstrained
        beam = VirtualBeam(int(particle), frame[particle].T @ np.asarray(arm, float))
        self.add(Load(beam, np.asarray(force, float), np.asarray(moment, float), int(curve)))

    def drive(self, particle: int, velocity=(0, 0, 0), spin=(0, 0, 0), curve: int = -1) -> None:
        """Prescribe the motion of a particle. Its drives add up (spins: one turn after another).

        Parameters
        ----------
        particle: index of the particle.
        velocity, spin: velocity (3,), m/s, and angular velocity (3,), rad/s, in global axes.
        curve: index of the curve of time that scales both; -1: constant."""
        velocity, spin = np.asarray(velocity, float), np.asarray(spin, float)
        self.add(Drive(int(particle), velocity, spin, int(curve)))

    def add_point(self, name: str, particle: int, position=None) -> None:
        """Name a point that is fixed to a particle, for responses.

        Parameters
        ----------
        name: not yet in use, else SceneError is raised.
        particle: index of the particle, whose rotation the point follows.
        position: where the point is at the start (3,), m; None: at the particle."""
        if name in self.points:
            raise SceneError("point", name, f"a name not yet used ({', '.join(self.points)})")
        self.points[name] = self.arm_to(int(particle), position)

    def arm_to(self, particle: int, point=None) -> VirtualBeam:
        """Return the rigid arm (VirtualBeam) from a particle (its index) to a point that moves with
        it. point: position (3,) at the start, m; None: the particle's. In a scene whose parts were
        forced together (fpm.assembly), both are positions before that."""
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
