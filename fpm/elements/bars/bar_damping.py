"""Damping of bars: in proportion to their stiffness, and by the bulk viscosity of their mesh.

Theory: docs/mechanics.md, "Beams". Sources: Rayleigh, Theory of Sound I, § 102; Clough, Penzien,
Dynamics of Structures, § 12-5. Bulk viscosity: von Neumann, Richtmyer, J. Appl. Phys. 21 (1950) 232
for the idea; Landshoff, LA-1930 (1955) for the linear term b1 rho c_d l de/dt; Abaqus Analysis
User's Guide, Explicit dynamic analysis, with b1 = 0.06.

Rates are extrapolated from the last two steps, which shortens the stable step (timestep.py).
Sections, stresses and strain energy have no part of either."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.bars.beam import Beams, end_axes
from fpm.elements.kind import ElementType
from fpm.elements.particles.damping import Damping
from fpm.errors import SceneError

STEP = 1e-30j
"""Imaginary step of derivatives (Squire, Trapp, SIAM Review 40 (1998) 110)."""


@dataclass(frozen=True)
class BarDamping(ElementType):
    """Damping of beam elements: in proportion to stiffness, of those whose material has it
    (Material.stiffness_damping), whether this is added to the scene or not; and bulk viscosity of
    all, which damps waves of the size of the mesh. share: fraction of critical damping in an
    element's highest axial vibration, at least 0; several add up."""

    share: float

    takes = Damping.takes
    cost = 40.0  # of each beam element that has it
    resists_as = ""

    def check(self, scene):
        if not (np.isfinite(self.share) and self.share >= 0):
            raise SceneError("viscosity", self.share, "a finite number >= 0")

    @classmethod
    def find(cls, scene):
        """Return the groups of beam elements (Beams) of a scene that are damped."""
        share = cls.viscosity(scene)
        return [b for b in Beams.find(scene) if share or b.material.stiffness_damping > 0]

    @classmethod
    def viscosity(cls, scene) -> float:
        """Return the share of critical damping by bulk viscosity in a scene."""
        return sum(element.share for element in scene.kinds.get(cls, []))

    @classmethod
    def topology_of(cls, scene):
        return None

    @classmethod
    def names(cls, scene):
        return Beams.names(scene)

    @classmethod
    def cost_in(cls, scene):
        return cls.cost * sum(len(beams.length) for beams in cls.find(scene))

    @classmethod
    def dampings(cls, scene):
        modes, viscous = Beams.deformations(scene), _viscous(scene)[:, 0]
        damping = _times(scene)[modes.element, 0] * modes.stiffness
        # Six springs of each element, those of a group together, and their stretches first.
        counts = [len(beams.length) for beams in Beams.find(scene)]
        is_stretch = [np.arange(6 * count) < count for count in counts]
        damping += np.where(np.concatenate(is_stretch), viscous[modes.element], 0.0)
        return modes._replace(stiffness=damping)

    @classmethod
    def pack(cls, batch):
        from fpm.elements.bars.bar_damping_kernels import HISTORY, RATE, DampedElements
        from fpm.elements.bars.beam_kernels import AXIAL

        bars, count = batch.part(Beams), len(cls.names(batch.scene))
        times, viscous = (batch.stack(count, 1, f) for f in (_times, _viscous))
        rows = np.flatnonzero((times + viscous).any(axis=(1, 2)))

        def select(array, factor=1.0):
            selection = batch.blank(len(rows), array.shape[1])
            selection[:] = (factor * array)[rows]
            return selection

        def history(scene):
            rates = _rates_at_start(scene)[rows]
            return np.pad(rates, [(0, 0), (RATE, HISTORY - RATE - rates.shape[1])])

        dampings = select(bars.beams, times)
        dampings[:, AXIAL] += viscous[rows, 0]
        axes = {"axes": select(bars.axes)} if "axes" in bars._fields else {}
        return DampedElements(
            bars._replace(nodes=bars.nodes[rows], beams=dampings, **axes),
            batch.stack(len(rows), HISTORY, history),
            batch.loss_account(cls),
        )


def _times(scene) -> np.ndarray:
    """Return Rayleigh's beta (m, 1), s, of every beam element."""
    times = [np.full(len(b.length), b.material.stiffness_damping) for b in Beams.find(scene)]
    return np.concatenate(times)[:, None]


def _viscous(scene) -> np.ndarray:
    """Bulk viscosity (m, 1) along every beam element, N s/m."""
    dampings = [
        np.full(len(b.length), b.section.A * np.sqrt(b.material.E * b.material.rho))
        for b in Beams.find(scene)
    ]
    return BarDamping.viscosity(scene) * np.concatenate(dampings)[:, None]


def _rates_at_start(scene) -> np.ndarray:
    """Rates (m, 6) of all beam elements' deformations at t = 0, in the order of the kernels, by a
    complex step: shapes are those of places and axes that have their rates as imaginary parts."""
    from fpm.elements.openings.opening import moving_at_start

    start, nodes = moving_at_start(scene), np.concatenate([b.nodes for b in Beams.find(scene)])
    frame_rate = np.cross(start.spin[:, None], start.frame.swapaxes(1, 2)).swapaxes(1, 2)
    place, frame = start.position + STEP * start.velocity, start.frame + STEP * frame_rate
    local = end_axes(scene).reshape(-1, 2, 2, 3)
    axes = np.einsum("meij,mekj->mkei", frame[nodes], local)  # axis 2 or 3, of the end a or b
    chord = place[nodes[:, 1]] - place[nodes[:, 0]]
    length = np.sqrt(np.sum(chord**2, axis=1))
    sines = np.einsum("mi,mkei->mke", chord / length[:, None], axes)
    turns = sines * (6 + sines**2)
    (a2, b2), (a3, b3) = axes.transpose(1, 2, 0, 3)
    twist = np.sum((b2 - a2) * (a3 + b3), axis=1)
    total, change = turns.sum(axis=2), turns[:, :, 0] - turns[:, :, 1]
    return np.column_stack([length, twist, total, change]).imag / STEP.imag
