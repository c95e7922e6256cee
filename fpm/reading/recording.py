"""What the loop recorded of one sample for a probe, by particle, hinge and joint."""

from collections.abc import Callable, Hashable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.openings.opening import PARTS, Opening
from fpm.elements.particles.drive import Drive
from fpm.elements.particles.probe import Probe
from fpm.elements.particles.turning import turns_of
from fpm.reading.bars import Bar, Sections, bars_of, sections_of
from fpm.scenes.scene import Scene


class Sides(NamedTuple):
    """What a joint does to the particles of its sides: forces and moments about them, (t, 3)."""

    on_one: np.ndarray
    about_one: np.ndarray
    on_two: np.ndarray
    about_two: np.ndarray


class Recording:
    """What was recorded of one lane at t instants, `time` (t,) s, with steps of `step` (s); of what
    the scene's probe names (elements/particles/probe.py)."""

    def __init__(self, batch, parts, lane: int, time: np.ndarray, step: float):
        self.scene: Scene = batch.scenes[lane]
        self.time, self.step, self._lane = time, step, lane
        self._parts = dict(zip(batch.kinds, parts, strict=True))
        self.probe = Probe.of_scene(self.scene)
        self._known: dict[Hashable, Any] = {}

    def _rows(self, array: np.ndarray, count: int) -> np.ndarray:
        """What was recorded of `count` things: (t, count, fields)."""
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
    def _driven(self) -> dict[int, np.ndarray]:
        """Velocity and spin (3, t, 2, 3) of driven particles half a step before the instants, at
        them, and half a step after."""
        if not Drive.of(self.scene):
            return {}
        half = 0.5 * self.step
        ways = [[Drive.motion(self.scene, t + s) for t in self.time] for s in (-half, 0.0, half)]
        found = np.array([[motion[1:] for motion in way] for way in ways])  # (3, t, 2, d, 3)
        return {int(p): found[:, :, :, k] for k, p in enumerate(ways[0][0][0])}

    def place(self, particle: int) -> np.ndarray:
        """Position (t, 3) m."""
        return self._frames[particle][:, :3]

    def axes(self, particle: int) -> np.ndarray:
        """Axes (t, 3, 3), as columns."""
        second, third = np.split(self._frames[particle][:, 3:], 2, axis=1)
        return np.stack([np.cross(second, third), second, third], axis=2)

    def arm(self, beam) -> np.ndarray:
        """From a virtual beam's particle to its end, (t, 3) m."""
        return self.axes(beam.particle) @ beam.arm

    def _of(self, particle: int, name: str) -> np.ndarray:
        from fpm.elements.particles import probe_kernels

        at = getattr(probe_kernels, name)
        return self._forces[particle][:, at : at + 3]

    def force(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Force (t, 3) N and moment (t, 3) N m on a particle, but for those that hold it."""
        return self._of(particle, "FORCE"), self._of(particle, "MOMENT")

    def spin(self, particle: int) -> np.ndarray:
        """Angular velocity (t, 3) rad/s."""
        if particle in self._driven:
            return self._driven[particle][1, :, 1]
        spin = self._turned(particle, self._of(particle, "MOMENTUM"))
        spin[0] = self.scene.spin[particle] * ~self.scene.fixed[particle, 3:]
        return spin

    def velocity(self, particle: int) -> np.ndarray:
        """Velocity (t, 3) m/s."""
        if particle in self._driven:
            return self._driven[particle][1, :, 0]
        velocity = self._of(particle, "VELOCITY").copy()
        velocity[0] = self.scene.velocity[particle]
        return velocity

    def acceleration(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Acceleration (t, 3) m/s² and angular acceleration (t, 3) rad/s²: changes over the step
        around each instant; of driven particles, over the half step after the first."""
        if particle in self._driven:
            before, now, after = self._driven[particle]
            change = (after - before) / self.step
            change[0] = (after[0] - now[0]) / (0.5 * self.step)
            return change[:, 0], change[:, 1]
        momentum, change = self._of(particle, "MOMENTUM"), self._of(particle, "CHANGE")
        # Euler's equation: J w' = p' - w x p.
        gyroscopic = np.cross(self.spin(particle), momentum)
        turning = self._turned(particle, change - gyroscopic)
        return self._of(particle, "ACCELERATION"), turning

    def _in_own_axes(self, particle: int, vector: np.ndarray, change: Callable) -> np.ndarray:
        """A vector (t, 3) after a change of its components along the particle's axes."""
        axes = self.axes(particle)
        return np.einsum("tij,tj->ti", axes, change(np.einsum("tij,ti->tj", axes, vector)))

    def _turned(self, particle: int, momentum: np.ndarray) -> np.ndarray:
        """Inverse inertia times (t, 3), about the axes about which the particle may turn."""
        inertia = turns_of(self.scene).inertia[particle]
        turned = self._in_own_axes(particle, momentum, lambda local: local / inertia)
        return turned * ~self.scene.fixed[particle, 3:]

    def inertia(self, particle: int) -> tuple[np.ndarray, np.ndarray]:
        """Rates of change of momentum (t, 3) N and angular momentum (t, 3) N m of a particle as it
        moves, driven or not."""
        (change, turning), spin = self.acceleration(particle), self.spin(particle)
        own = self.scene.inertia[particle]
        spun, turned = (self._in_own_axes(particle, v, lambda x: x * own) for v in (spin, turning))
        return self.scene.mass[particle] * change, turned + np.cross(spin, spun)

    def moments(self, hinge: int) -> tuple[np.ndarray, np.ndarray]:
        """Moments (t, PARTS) N m on a hinge of that index, or forces (t, PARTS) N on a slide, and
        their work so far (t, PARTS) J."""
        rows = self._rows(self._parts[Opening].told_track, len(self.scene.hinges) * len(PARTS))
        own = rows[:, hinge * len(PARTS) : (hinge + 1) * len(PARTS)]
        return own[..., 0], own[..., 1]

    def sections(self, bar: str) -> tuple[Bar, Sections]:
        """A bar, and what the sections of its elements bear."""

        def cut() -> tuple[Bar, Sections]:
            found = bars_of(self.scene)[bar]
            return found, sections_of(self.scene, found, self.place, self.axes)

        return self.once(bar, cut)

    def once(self, key: Hashable, find: Callable[[], Any]) -> Any:
        """What several columns are made of: found for the first of them."""
        if key not in self._known:
            self._known[key] = find()
        return self._known[key]

    @cached_property
    def joints(self) -> list[tuple[Hinge | Joint, Sides]]:
        """All joints, lone hinges and others, and what they do to their sides."""
        found = []
        for kind in (Hinge, Joint):
            if elements := kind.of(self.scene):
                rows = self._rows(self._parts[kind].forces, len(elements)).swapaxes(0, 1)
                sides = (Sides(*np.split(own, 4, axis=1)) for own in rows)
                found += zip(elements, sides, strict=True)
        return found
