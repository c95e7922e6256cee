"""A scene: particles and the elements between them, at their starting state.

A scene describes one sample. Scenes that differ only in numbers can run side by side (simulate.py).
Everything is in SI units; positions, directions and loads are given in global axes at the start.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
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
from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.cross import length as size
from fpm.errors import SceneError


@dataclass(frozen=True)
class Link:
    """A straight bar: its `particles` from start to end and its axes `triad` (3, 3) as columns."""

    particles: np.ndarray
    triad: np.ndarray


_EYE = np.eye(3)


def _rows(values, *shape: int) -> np.ndarray:
    """Numbers of an array of this shape, those of one row for all or each row's own."""
    array = np.empty(shape)
    array[...] = values
    return array


def _elements(kind: type[ElementType]) -> property:
    """The scene's list of elements of a kind."""

    def get(scene: "Scene") -> list:
        return scene.kinds.setdefault(kind, [])

    def put(scene: "Scene", elements: Sequence) -> None:
        scene.kinds = {**scene.kinds, kind: list(elements)}  # not in a copy of the scene

    return property(get, put, doc=f"The elements of kind {kind.__name__}.")


class Scene:
    """Particles, and the elements between and on them, of one sample.

    name: for messages; gravity (3,) m/s²; damping: mass-proportional rate (1/s), the force on a
    particle is -damping * mass * velocity (and its like for rotation). `kinds` has the list of
    elements for every kind that was added (kinds/).
    """

    def __init__(self, name: str = "scene", gravity=(0.0, 0.0, 0.0), damping: float = 0.0):
        self.name = name
        self.position = np.zeros((0, 3))
        self.frame = np.zeros((0, 3, 3))
        self.unstrained: np.ndarray | None = None  # frames (n, 3, 3) without strain; None: `frame`
        self.unstrained_position: np.ndarray | None = None  # and positions (n, 3); None: `position`
        self.assembly: Any = None  # what forced it together, an fpm.assembly.Assembly
        self.velocity = np.zeros((0, 3))
        self.spin = np.zeros((0, 3))
        self.mass = np.zeros(0)
        self.inertia = np.zeros((0, 3))
        self.fixed = np.zeros((0, 6), bool)
        self.kinds: dict[type[ElementType], list] = {}
        self.curves: list[tuple[np.ndarray, np.ndarray]] = []
        self.points: dict[str, VirtualBeam] = {}
        self.bodies: dict[str, int] = {}  # rigid ones that have a name, with their particles
        self.supports: dict[str, VirtualBeam] = {}  # named points that are held or driven
        self.bearings: Counter[int] = Counter()  # by hinge: mu r (m), of slides mu, where it is led
        self.classes: dict[
            tuple[type[ElementType], int], str
        ] = {}  # other than ElementType.resists_as
        self.action_names: dict[
            tuple[type[ElementType], int], str
        ] = {}  # as a structure's file has them
        self.gravity, self.damping = gravity, damping

    beams = _elements(Beams)
    hinges = _elements(Hinge)
    springs = _elements(TorsionSpring)
    contacts = _elements(Contact)
    loads = _elements(Load)
    cables = _elements(Cable)
    drives = _elements(Drive)

    @property
    def gravity(self) -> np.ndarray:
        """Sum (3,) of all accelerations by gravity (m/s²); may be set."""
        return sum((g.acceleration for g in self.kinds.get(Gravity, [])), np.zeros(3))

    @gravity.setter
    def gravity(self, acceleration) -> None:
        self.kinds = {**self.kinds, Gravity: [Gravity(np.asarray(acceleration, float))]}

    @property
    def damping(self) -> float:
        """Sum of all damping rates (1/s); may be set."""
        return float(sum(d.rate for d in self.kinds.get(Damping, [])))

    @damping.setter
    def damping(self, rate: float) -> None:
        damping = Damping(float(rate))
        damping.check(self)
        self.kinds = {**self.kinds, Damping: [damping]}

    def add(self, element: ElementType) -> int:
        """Add an element of any kind; returns its index among those of its kind.

        SceneError if it does not fit into the scene as it is.
        """
        element.add_to(self)
        return len(self.kinds.get(type(element), [])) - 1

    # -- particles and beams ------------------------------------------------------------------

    def add_particles(self, position, mass, inertia, frame=None, velocity=0.0, spin=0.0):
        """Add n particles; returns their indices (n,).

        position (n, 3) or (3,) m; mass (n,) kg; inertia (n, 3) principal values (kg m²) about the
        particle's own axes; frame (3, 3) or (n, 3, 3): those axes as columns; velocity (n, 3) m/s;
        spin (n, 3) rad/s in global axes. A particle without mass cannot be integrated: SceneError.
        """
        position = np.atleast_2d(np.asarray(position, float))
        first, n = len(self.position), len(position)
        mass, inertia = _rows(mass, n), _rows(inertia, n, 3)
        if not (mass.min(initial=1.0) > 0 and inertia.min(initial=1.0) > 0):
            raise SceneError(
                "mass, inertia", (mass.min(), inertia.min()), "positive values for every particle"
            )
        frame = np.asarray(_EYE if frame is None else frame, float)
        deviation = np.swapaxes(frame, -1, -2) @ frame - _EYE
        if abs(deviation).max() > 1e-9 or np.any(np.linalg.det(frame) < 0):
            raise SceneError("frame", "(not a rotation)", "right-handed orthonormal axes")
        self.position = np.concatenate([self.position, position])
        self.mass = np.concatenate([self.mass, mass])
        self.inertia = np.concatenate([self.inertia, inertia])
        self.frame = np.concatenate([self.frame, np.broadcast_to(frame, (n, 3, 3))])
        self.velocity = np.concatenate([self.velocity, _rows(velocity, n, 3)])
        self.spin = np.concatenate([self.spin, _rows(spin, n, 3)])
        self.fixed = np.concatenate([self.fixed, np.zeros((n, 6), bool)])
        return np.arange(first, first + n)

    def add_beams(self, nodes, section: Section, material: Material, normal, name="beam"):
        """Add beam elements between existing particles, unstressed as they lie.

        nodes (m, 2) particle indices; normal (3,) or (m, 3): a vector in the plane of the chord
        and the section's local z axis.
        """
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
        """Add a straight bar of `elements` equal beam elements with lumped masses (lumping.py).

        start, end (3,) m; normal (3,): lies in the plane of the bar and its section's z axis.
        The particles' axes are the bar's.
        """
        start, end = np.asarray(start, float), np.asarray(end, float)
        chord = end - start
        length = size(chord)
        if not (math.isfinite(length) and length > 0):
            raise SceneError(f"length of {name}", length, "a positive, finite length (m)")
        mass, inertia = lump(length, elements, section, material, inertia_scale)
        axes = triad(chord, normal)
        steps = np.linspace(0.0, 1.0, elements + 1)[:, None]
        particles = self.add_particles(start + steps * chord, mass, inertia, axes)
        nodes = np.column_stack([particles[:-1], particles[1:]])
        m = len(nodes)
        lengths, triads = _rows(length / elements, m), _rows(axes, m, 3, 3)
        self.add(Beams(nodes, lengths, triads, section, material, name))
        return Link(particles, axes)

    # -- hinges, springs, contact -------------------------------------------------------------

    def add_hinge(self, name, particles, point, axis, references=None, opening=0.0, support=""):
        """Hinge two particles at `point` (3,) about `axis` (3,); returns the hinge's index.

        references: two vectors (3,), fixed to the first and the second particle and normal to the
        axis, as they lie at the start; their angle is the opening. `opening` (rad) picks the turn:
        the starting value is the one closest to it. Without references the hinge starts at
        `opening`. support: global axes ("", "z", "xyz") along which the hinge point is held. point
        and axis may be (2, 3), one for each particle, for fpm.assembly to bring together.
        """
        return self.add(
            Hinge.create(self, name, particles, point, axis, references, opening, support)
        )

    def add_joint(self, name, type, particles, point, axis=(1, 0, 0), axis2=None) -> int:
        """Join two particles at `point` (3,), if not by a hinge; returns the joint's index.

        type: "spherical"; "fixed"; "universal", about `axis` (3,) of the first and `axis2` (3,) of
        the second, normal to it; "prismatic": the second slides on the first along `axis`. point
        may be (2, 3), one for each particle, for fpm.assembly to bring together.
        """
        return self.add(Joint.create(self, name, type, particles, point, axis, axis2))

    def add_slide(self, name, particles, point, axis, opening: float = 0.0) -> int:
        """Join two particles by a slide; returns its index, as of a hinge: it counts among those.

        The second slides on the first along `axis` (3,), by the opening (m), which is `opening` at
        the start. point may be (2, 3), as for other joints.
        """
        return self.add(Joint.slide(self, name, particles, point, axis, opening))

    def add_universal(self, name, particles, point, axis, axis2, openings=(0.0, 0.0)) -> int:
        """Join two particles by a cross about `axis` (3,) of the first and `axis2` (3,) of the
        second, normal to it; returns the index of the angle about the first, the other's is next.

        They count among the hinges as `<name>_axis` and `<name>_other`: by which the cross turns
        against the first particle, and the second against the cross; openings (rad): at the start.
        """
        hinges = Joint.universal(self, name, particles, point, axis, axis2, openings)
        return min(self.add(hinge) for hinge in hinges)

    def hold_point(self, name, particle: int, point, axes: str) -> int:
        """Hold a point (3,) of a particle along global axes, e.g. "z"; returns the joint's index.

        For points off the particle: what holds the particle itself is `fix`, and costs nothing.
        """
        return self.add(Joint.holding(self, name, int(particle), point, axes))

    def add_torsion_spring(self, hinge: int, stiffness: float, rest: float = 0.0) -> None:
        """Torsion spring of `stiffness` (N m/rad) that turns a hinge towards `rest` (rad)."""
        self.add(TorsionSpring(int(hinge), float(stiffness), float(rest)))

    def add_contact(self, hinge: int, stiffness: float) -> None:
        """Face-to-face contact of `stiffness` (N m/rad) where a hinge's opening is negative."""
        self.add(Contact(int(hinge), float(stiffness)))

    def add_cable(
        self, name, points, EA, rest=None, preload=None, reel=0.0, curve=-1, friction=None
    ):
        """Cable through points, each a particle and a place (3,) m or None; returns its index.

        EA (N); either its unstrained length `rest` (m), or the tension `preload` (N) that it has
        at the start. A winch takes in the length `reel` (m) times a curve of time, at the first
        point. friction: coefficient at the points between the ends; None: they turn freely.
        """
        return self.add(Cable.create(self, name, points, EA, rest, preload, reel, curve, friction))

    # -- supports, loads, drives, points ------------------------------------------------------

    def fix(self, particles, translations: str = "xyz", rotations: str = "xyz") -> None:
        """Hold particles along and about global axes.

        One that is in joints and has unlike inertias is held about none, two or all axes.
        """
        self.add(Support(tuple(np.atleast_1d(particles)), translations, rotations))

    def add_curve(self, times: Sequence[float], values: Sequence[float]) -> int:
        """A piecewise linear curve of time (s), constant outside; returns its index."""
        times, values = np.asarray(times, float), np.asarray(values, float)
        if times.shape != values.shape or times.ndim != 1 or np.any(np.diff(times) <= 0):
            raise SceneError("curve", (times.tolist(), values.tolist()), "increasing times")
        self.curves.append((times, values))
        return len(self.curves) - 1

    def add_load(self, particle, force=(0, 0, 0), moment=(0, 0, 0), arm=(0, 0, 0), curve=-1):
        """Dead load on a particle: force (3,) N at the end of `arm` (3,) m, moment (3,) N m.

        All in global axes; the arm, as it lies at the start, is fixed to the particle.
        """
        frame = self.frame if self.unstrained is None else self.unstrained
        beam = VirtualBeam(int(particle), frame[particle].T @ np.asarray(arm, float))
        self.add(Load(beam, np.asarray(force, float), np.asarray(moment, float), int(curve)))

    def drive(self, particle: int, velocity=(0, 0, 0), spin=(0, 0, 0), curve: int = -1) -> None:
        """Prescribe a particle's velocity (3,) m/s and spin (3,) rad/s, scaled by a curve.

        Several drives of one particle add up (spins: one turn after another in each step).
        """
        velocity, spin = np.asarray(velocity, float), np.asarray(spin, float)
        self.add(Drive(int(particle), velocity, spin, int(curve)))

    def add_point(self, name: str, particle: int, position=None) -> None:
        """Name a point fixed to a particle, at `position` (3,) m (default: the particle itself)."""
        if name in self.points:
            raise SceneError("point", name, f"a name not yet used ({', '.join(self.points)})")
        self.points[name] = self.arm_to(int(particle), position)

    def arm_to(self, particle: int, point=None) -> VirtualBeam:
        """The virtual beam from a particle to a point (3,) m, by default itself.

        Of a scene that was assembled, both are taken where they lay before.
        """
        position, frame = (
            value if unstrained is None else unstrained
            for value, unstrained in (
                (self.position, self.unstrained_position),
                (self.frame, self.unstrained),
            )
        )
        point = position[particle] if point is None else point
        return VirtualBeam.to_point(particle, position[particle], frame[particle], point)

    # -- names -----------------------------------------------------------------------

    @property
    def elements(self) -> list[str]:
        """Names of all elements that store energy, in the order of the kinds."""
        return [name for kind in kinds_of([self]) if kind.stores for name in kind.names(self)]
