"""A scene: particles and the elements between them, at their starting state.

A scene describes one sample. Scenes that differ only in numbers can run side by side (simulate.py).
Everything is in SI units; positions, directions and loads are given in global axes at the start.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from fpm.elements.beam import Beams, Material, Section, triad
from fpm.elements.contact import Contact
from fpm.elements.hinge import AXES, Hinge, check_held, opening_angle, unit
from fpm.elements.load import Drive, Load
from fpm.elements.lumping import lump
from fpm.elements.torsion_spring import TorsionSpring
from fpm.elements.virtual_beam import VirtualBeam
from fpm.errors import SceneError


@dataclass(frozen=True)
class Link:
    """A straight bar: its `particles` from start to end and its axes `triad` (3, 3) as columns."""

    particles: np.ndarray
    triad: np.ndarray


class Scene:
    """Particles, elements, supports and loads of one sample.

    name: for messages; gravity (3,) m/s²; damping: mass-proportional rate (1/s), the force on a
    particle is -damping * mass * velocity (and its like for rotation).
    """

    def __init__(self, name: str = "scene", gravity=(0.0, 0.0, 0.0), damping: float = 0.0):
        if not (np.isfinite(damping) and damping >= 0):
            raise SceneError("damping", damping, "a finite number >= 0 (1/s)")
        self.name = name
        self.gravity = np.asarray(gravity, float)
        self.damping = float(damping)
        self.position = np.zeros((0, 3))
        self.frame = np.zeros((0, 3, 3))
        self.unstrained: np.ndarray | None = None  # frames (n, 3, 3) without strain; None: `frame`
        self.velocity = np.zeros((0, 3))
        self.spin = np.zeros((0, 3))
        self.mass = np.zeros(0)
        self.inertia = np.zeros((0, 3))
        self.fixed = np.zeros((0, 6), bool)
        self.beams: list[Beams] = []
        self.hinges: list[Hinge] = []
        self.springs: list[TorsionSpring] = []
        self.contacts: list[Contact] = []
        self.loads: list[Load] = []
        self.drives: list[Drive] = []
        self.curves: list[tuple[np.ndarray, np.ndarray]] = []
        self.points: dict[str, VirtualBeam] = {}

    # -- particles and beams ------------------------------------------------------------------

    def add_particles(self, position, mass, inertia, frame=None, velocity=0.0, spin=0.0):
        """Add n particles; returns their indices (n,).

        position (n, 3) or (3,) m; mass (n,) kg; inertia (n, 3) principal values (kg m²) about the
        particle's own axes; frame (3, 3) or (n, 3, 3): those axes as columns; velocity (n, 3) m/s;
        spin (n, 3) rad/s in global axes. A particle without mass cannot be integrated: SceneError.
        """
        position = np.atleast_2d(np.asarray(position, float))
        n = len(position)
        mass = np.broadcast_to(np.asarray(mass, float), n)
        inertia = np.broadcast_to(np.asarray(inertia, float), (n, 3))
        frame = np.broadcast_to(np.eye(3) if frame is None else frame, (n, 3, 3))
        if not (np.all(mass > 0) and np.all(inertia > 0)):
            raise SceneError(
                "mass, inertia", (mass.min(), inertia.min()), "positive values for every particle"
            )
        identity = np.einsum("nij,nik->njk", frame, frame)
        if np.abs(identity - np.eye(3)).max() > 1e-9 or np.any(np.linalg.det(frame) < 0):
            raise SceneError("frame", "(not a rotation)", "right-handed orthonormal axes")
        first = len(self.position)
        self.position = np.concatenate([self.position, position])
        self.mass = np.concatenate([self.mass, mass])
        self.inertia = np.concatenate([self.inertia, inertia])
        self.frame = np.concatenate([self.frame, frame])
        rows = np.zeros((n, 3))
        self.velocity = np.concatenate([self.velocity, rows + np.asarray(velocity, float)])
        self.spin = np.concatenate([self.spin, rows + np.asarray(spin, float)])
        self.fixed = np.concatenate([self.fixed, np.zeros((n, 6), bool)])
        return np.arange(first, first + n)

    def add_beams(self, nodes, section: Section, material: Material, normal, name="beam"):
        """Add beam elements between existing particles, unstressed as they lie.

        nodes (m, 2) particle indices; normal (3,) or (m, 3): a vector in the plane of the chord
        and the section's local z axis.
        """
        nodes = np.atleast_2d(np.asarray(nodes, int))
        if nodes.shape[1] != 2 or nodes.min() < 0 or nodes.max() >= len(self.position):
            raise SceneError(f"nodes of {name}", nodes.tolist(), "(m, 2) indices of particles")
        chord = self.position[nodes[:, 1]] - self.position[nodes[:, 0]]
        length = np.linalg.norm(chord, axis=1)
        if not np.all(length > 0):
            raise SceneError(f"length of {name}", length.min(), "two particles apart")
        normals = np.broadcast_to(np.asarray(normal, float), (len(nodes), 3))
        axes = np.array([triad(c, z) for c, z in zip(chord, normals, strict=True)])
        self.beams.append(Beams(nodes, length, axes, section, material, name))

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
        length = float(np.linalg.norm(end - start))
        if not (np.isfinite(length) and length > 0):
            raise SceneError(f"length of {name}", length, "a positive, finite length (m)")
        mass, inertia = lump(length, elements, section, material, inertia_scale)
        axes = triad(end - start, normal)
        steps = np.linspace(0.0, 1.0, elements + 1)[:, None]
        particles = self.add_particles(start + steps * (end - start), mass, inertia, axes)
        nodes = np.column_stack([particles[:-1], particles[1:]])
        m = len(nodes)
        self.beams.append(
            Beams(
                nodes, np.full(m, length / elements), np.tile(axes, (m, 1, 1)),
                section, material, name,
            )
        )  # fmt: skip
        return Link(particles, axes)

    # -- hinges, springs, contact -------------------------------------------------------------

    def add_hinge(self, name, particles, point, axis, references=None, opening=0.0, support=""):
        """Hinge two particles at `point` (3,) about `axis` (3,); returns the hinge's index.

        references: two vectors (3,), fixed to the first and the second particle and normal to the
        axis, as they lie at the start; their angle is the opening. `opening` (rad) picks the turn:
        the starting value is the one closest to it. Without references the hinge starts at
        `opening`. support: global axes ("", "z", "xyz") along which the hinge point is held.
        """
        first, second = (int(p) for p in particles)
        count = len(self.position)
        if first == second or not (0 <= first < count and 0 <= second < count):
            raise SceneError(f"particles of hinge {name}", particles, "two different particles")
        taken = {p for hinge in self.hinges for p in hinge.particles if not self.fixed[p].all()}
        taken |= {drive.particle for drive in self.drives}
        if taken & {first, second}:
            raise SceneError(
                f"particles of hinge {name}",
                particles,
                "particles that no other hinge or drive uses",
            )
        if set(support) - set(AXES):
            raise SceneError(f"support of hinge {name}", support, "letters out of 'xyz'")
        axis = unit(axis, f"axis of hinge {name}")
        if references is None:
            normal = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))]), "reference")
            turned = np.cos(opening) * normal + np.sin(opening) * np.cross(axis, normal)
            references = (normal, turned)
        references = [unit(r, f"reference of hinge {name}") for r in references]
        if max(abs(np.dot(r, axis)) for r in references) > 1e-9:
            raise SceneError(f"references of hinge {name}", references, "normal to the axis")
        beams = tuple(
            VirtualBeam.to_point(p, self.position[p], self.frame[p], point) for p in (first, second)
        )
        hinge = Hinge(
            name,
            beams,
            axes=np.array([self.frame[p].T @ axis for p in (first, second)]),
            references=np.array(
                [self.frame[p].T @ r for p, r in zip((first, second), references, strict=True)]
            ),
            opening=opening_angle(axis, *references, near=opening),
            support="".join(sorted(support)),
        )
        check_held(hinge, self.fixed)
        self.hinges.append(hinge)
        return len(self.hinges) - 1

    def add_torsion_spring(self, hinge: int, stiffness: float, rest: float = 0.0) -> None:
        """Torsion spring of `stiffness` (N m/rad) that turns a hinge towards `rest` (rad)."""
        self._check_stiffness("torsion spring", hinge, stiffness)
        self.springs.append(TorsionSpring(int(hinge), float(stiffness), float(rest)))

    def add_contact(self, hinge: int, stiffness: float) -> None:
        """Face-to-face contact of `stiffness` (N m/rad) where a hinge's opening is negative."""
        self._check_stiffness("contact", hinge, stiffness)
        self.contacts.append(Contact(int(hinge), float(stiffness)))

    def _check_stiffness(self, what: str, hinge: int, stiffness: float) -> None:
        if not 0 <= hinge < len(self.hinges):
            raise SceneError(f"hinge of {what}", hinge, f"0 to {len(self.hinges) - 1}")
        if not (np.isfinite(stiffness) and stiffness >= 0):
            raise SceneError(f"{what} stiffness", stiffness, "a finite number >= 0 (N m/rad)")

    # -- supports, loads, drives, points ------------------------------------------------------

    def fix(self, particles, translations: str = "xyz", rotations: str = "xyz") -> None:
        """Hold particles along and about global axes.

        Rotations of a particle with three different inertias are held all or none, or about axes
        that stay principal (planar motion). Those of a hinged particle are held all or none.
        SceneError for what a hinge could not bear (elements/hinge.py).
        """
        if set(translations + rotations) - set(AXES):
            raise SceneError("fixed axes", (translations, rotations), "letters out of 'xyz'")
        columns = [AXES.index(c) for c in translations] + [3 + AXES.index(c) for c in rotations]
        before = self.fixed.copy()
        for p in np.atleast_1d(particles):
            self.fixed[p, columns] = True
        try:
            for hinge in self.hinges:
                check_held(hinge, self.fixed)
        except SceneError:
            self.fixed = before
            raise

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
        beam = VirtualBeam(int(particle), self.frame[particle].T @ np.asarray(arm, float))
        load = Load(beam, np.asarray(force, float), np.asarray(moment, float), int(curve))
        self.loads.append(load)
        self._check_turned()

    def drive(self, particle: int, velocity=(0, 0, 0), spin=(0, 0, 0), curve: int = -1) -> None:
        """Prescribe a particle's velocity (3,) m/s and spin (3,) rad/s, scaled by a curve.

        Several drives of one particle add up (spins: one turn after another in each step). A
        driven particle cannot carry a hinge: drive the particle at the other end of its element.
        """
        if any(particle in hinge.particles for hinge in self.hinges):
            raise SceneError("driven particle", int(particle), "one that no hinge uses")
        self.fix(particle)
        self.drives.append(
            Drive(int(particle), np.asarray(velocity, float), np.asarray(spin, float), int(curve))
        )
        self._check_turned()

    def driven(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The driven particles (d,), their velocities (d, 3) m/s and spins (d, 3) rad/s at a time.

        time in s.
        """
        particles = np.array(sorted({drive.particle for drive in self.drives}), int)
        motion = np.zeros((2, len(particles), 3))
        for drive in self.drives:
            factor = 1.0 if drive.curve < 0 else np.interp(time, *self.curves[drive.curve])
            row = np.searchsorted(particles, drive.particle)
            motion[:, row] += factor * np.array([drive.velocity, drive.spin])
        return particles, motion[0], motion[1]

    def add_point(self, name: str, particle: int, position=None) -> None:
        """Name a point fixed to a particle, at `position` (3,) m (default: the particle itself)."""
        if name in self.points:
            raise SceneError("point", name, f"a name not yet used ({', '.join(self.points)})")
        origin, frame = self.position[particle], self.frame[particle]
        point = origin if position is None else position
        self.points[name] = VirtualBeam.to_point(int(particle), origin, frame, point)

    def _check_turned(self) -> None:
        """Refuse moments on a particle that is turned by a drive, and loads beside it.

        The work of loads is added up without the spin of such a particle.
        """
        turned = {drive.particle for drive in self.drives if np.any(drive.spin)}
        for load in self.loads:
            if load.beam.particle in turned and (load.beam.arm.any() or load.moment.any()):
                raise SceneError(
                    f"load on driven particle {load.beam.particle}",
                    (load.beam.arm.tolist(), load.moment.tolist()),
                    "no arm and no moment: drive the particle at the other end of an element",
                )

    def going_on(self, motion, openings: Sequence[float]) -> "Scene":
        """The scene in another state, strained as it is there: a run that goes on from another.

        motion: an Outcome's `final`, openings (rad): of all hinges there.
        """
        out = copy(self)
        out.unstrained = self.frame if self.unstrained is None else self.unstrained
        out.position, out.frame, out.velocity, out.spin = motion
        out.hinges = [
            replace(h, opening=float(x)) for h, x in zip(self.hinges, openings, strict=True)
        ]
        return out

    # -- names and sums -----------------------------------------------------------------------

    @property
    def elements(self) -> list[str]:
        """Names of all elements: beams, then springs, then contacts."""
        names = [f"{b.name}[{i}]" for b in self.beams for i in range(len(b.length))]
        names += [f"torsion spring {self.hinges[s.hinge].name}" for s in self.springs]
        names += [f"contact {self.hinges[c.hinge].name}" for c in self.contacts]
        return names
