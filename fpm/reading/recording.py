"""What the loop recorded of one sample for a probe, by particle, hinge and joint."""

from collections.abc import Callable, Hashable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from fpm.elements.batch import turns_of
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.openings.opening import PARTS, Opening
from fpm.elements.openings.stop import Contact, Stop
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.probe import Probe
from fpm.reading.bars import Bar, Sections, bars_of, sections_of
from fpm.scenes.scene import Scene


class Sides(NamedTuple):
    """Forces and moments of a joint on the particles of its two sides, (t, 3) each in global axes.
    force1, force2: forces (N); moment1, moment2: moments about the particle (N m)."""

    force1: np.ndarray
    moment1: np.ndarray
    force2: np.ndarray
    moment2: np.ndarray


class Recording:
    """What the time loop recorded of one run for its scene's probe, as forces and motions at t
    instants. batch, parts: scenes side by side, and arrays of their element types; lane: index of
    the run's scene; time (t,) s; step: s."""

    def __init__(self, batch, parts, lane: int, time: np.ndarray, step: float):
        self.scene: Scene = batch.scenes[lane]
        self.time, self.step, self._lane = time, step, lane
        self._parts = dict(zip(batch.kinds, parts, strict=True))
        self.probe = Probe.of_scene(self.scene)
        self._memo: dict[Hashable, Any] = {}

    def _rows(self, array: np.ndarray, count: int) -> np.ndarray:
        """Records of `count` items as (t, count, fields)."""
        rows = array[:, :, self._lane].reshape(len(self.time) + 1, count, array.shape[1])
        return rows[:-1]  # the last row is for checks between instants

    @cached_property
    def _frames(self) -> dict[int, np.ndarray]:
        """Position and two axes (t, FRAME) by particle."""
        rows = self._rows(self._parts[Probe].frames, len(self.probe.frames))
        return dict(zip(self.probe.frames, rows.swapaxes(0, 1), strict=True))

    @cached_property
    def _forces(self) -> dict[int, np.ndarray]:
        """What `probe_kernels` records of forces and momenta (t, FORCES) by particle."""
        rows = self._rows(self._parts[Probe].forces, len(self.probe.forces))
        return dict(zip(self.probe.forces, rows.swapaxes(0, 1), strict=True))

    @cached_property
    def _driven_rates(self) -> dict[int, np.ndarray]:
        """Velocity and spin (3, t, 2, 3) of driven particles half a step before, at, after each."""
        if not Drive.find(self.scene):
            return {}
        half = 0.5 * self.step
        motions = [[Drive.motion(self.scene, t + s) for t in self.time] for s in (-half, 0.0, half)]
        rates = np.array([[motion[1:] for motion in row] for row in motions])  # (3, t, 2, d, 3)
        return {int(p): rates[:, :, :, k] for k, p in enumerate(motions[0][0][0])}

    def place(self, particle: int) -> np.ndarray:
        """Position (t, 3) m of a particle (its index) in global axes."""
        return self._frames[particle][:, :3]

    def axes(self, particle: int) -> np.ndarray:
        """Frame (t, 3, 3) of a particle (its index): its own axes as columns, in global axes."""
        second, third = np.split(self._frames[particle][:, 3:], 2, axis=1)
        return np.stack([np.cross(second, third), second, third], axis=2)

    def arm(self, beam) -> np.ndarray:
        """Return the arm (t, 3) m, global, of a VirtualBeam."""
        return self.axes(beam.particle) @ beam.arm

    def _column(self, particle: int, name: str) -> np.ndarray:
        from fpm.elements.particles import probe_kernels

        column = getattr(probe_kernels, name)
        return self._forces[particle][:, column : column + 3]

    def force(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Return force (t, 3) N on a particle (its index) and moment (t, 3) N m about it, in global
        axes, by all that acts but joints, supports, drives and damping."""
        return self._column(particle, "FORCE"), self._column(particle, "MOMENT")

    def spin(self, particle: int) -> np.ndarray:
        """Angular velocity (t, 3) rad/s of a particle (its index), about global axes."""
        if particle in self._driven_rates:
            return self._driven_rates[particle][1, :, 1]
        spin = self._angular(particle, self._column(particle, "MOMENTUM"))
        spin[0] = self.scene.spin[particle] * ~self.scene.fixed[particle, 3:]
        return spin

    def velocity(self, particle: int) -> np.ndarray:
        """Velocity (t, 3) m/s of a particle (its index), along global axes."""
        if particle in self._driven_rates:
            return self._driven_rates[particle][1, :, 0]
        velocity = self._column(particle, "VELOCITY").copy()
        velocity[0] = self.scene.velocity[particle]
        return velocity

    def acceleration(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Return acceleration (t, 3) m/s² and angular acceleration (t, 3) rad/s² of a particle (its
        index), in global axes: changes over the step around each instant; of driven particles at
        the first instant, over the half step after it."""
        if particle in self._driven_rates:
            v0, v1, v2 = self._driven_rates[particle]
            change = (v2 - v0) / self.step
            change[0] = (v2[0] - v1[0]) / (0.5 * self.step)
            return change[:, 0], change[:, 1]
        momentum, change = self._column(particle, "MOMENTUM"), self._column(particle, "CHANGE")
        # Euler's equation: J w' = p' - w x p.
        gyroscopic = np.cross(self.spin(particle), momentum)
        angular = self._angular(particle, change - gyroscopic)
        return self._column(particle, "ACCELERATION"), angular

    def _angular(self, particle: int, momentum: np.ndarray) -> np.ndarray:
        """Inverse inertia of a particle times a momentum (t, 3), about axes it may turn about."""
        inertia, axes = turns_of(self.scene).inertia[particle], self.axes(particle)
        local = np.einsum("tij,ti->tj", axes, momentum)
        angular = np.einsum("tij,tj->ti", axes, local / inertia)
        return angular * ~self.scene.fixed[particle, 3:]

    def inertia(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the rates of change of momentum (t, 3) N and angular momentum (t, 3) N m of a
        particle (its index), in global axes, also of a driven one."""
        (change, angular), spin = self.acceleration(particle), self.spin(particle)
        axes, inertia = self.axes(particle), self.scene.inertia[particle]
        momentum, moment = (
            np.einsum("tij,tj->ti", axes, inertia * np.einsum("tij,ti->tj", axes, vector))
            for vector in (spin, angular)
        )
        return self.scene.mass[particle] * change, moment + np.cross(spin, momentum)

    def moments(self, hinge: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the moments on a hinge, and the work of each so far, over the run: (t, a) N m, on
        a slide N, above 0 where they raise its opening, and (t, a) J, above 0 where they drive it.
        hinge: its index; columns: the `a` components ("spring", "damper", ...: PARTS)."""
        count = len(self.scene.hinges)
        rows = self._rows(self._parts[Opening].part_track, count * len(PARTS))
        columns = rows[:, hinge * len(PARTS) : (hinge + 1) * len(PARTS)]
        moments, works = columns[..., 0].copy(), columns[..., 1]
        opening = self._rows(self._parts[Opening].track, count)[:, hinge, 0]
        for kind in (Stop, Contact):  # none pulls; in the step it is left, work is corrected
            gates = [stop.gate() for stop in kind.find(self.scene) if stop.hinge == hinge]
            if gates:
                contacts = [gate.side * (opening - gate.opening) > 0.0 for gate in gates]
                moments[~np.any(contacts, axis=0), PARTS.index(kind.acts_as)] = 0.0
        return moments, works

    def sections(self, bar: str) -> tuple[Bar, Sections]:
        """Return a bar (Bar) by its name, and its Sections: forces and moments at all instants."""

        def read() -> tuple[Bar, Sections]:
            bar_data = bars_of(self.scene)[bar]
            return bar_data, sections_of(self.scene, bar_data, self.place, self.axes)

        return self.memoize(bar, read)

    def memoize(self, key: Hashable, find: Callable[[], Any]) -> Any:
        """Return the result of find(), called at the first use of `key` only, then stored."""
        if key not in self._memo:
            self._memo[key] = find()
        return self._memo[key]

    @cached_property
    def joints(self) -> list[tuple[Hinge | Joint, Sides]]:
        """All joints, hinges first: pairs (Hinge or Joint, Sides)."""
        pairs: list = []
        for kind in (Hinge, Joint):
            if elements := kind.find(self.scene):
                rows = self._rows(self._parts[kind].forces, len(elements)).swapaxes(0, 1)
                sides = (Sides(*np.split(forces, 4, axis=1)) for forces in rows)
                pairs += zip(elements, sides, strict=True)
        return pairs
