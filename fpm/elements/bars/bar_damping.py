"""Damping of bars in proportion to their stiffness: Rayleigh's beta, a time of the material.

An element is a Kelvin-Voigt solid: with q its six deformations (stretch, twist, sum and difference
of its ends' angles in both planes; beam.py), its forces are the gradient of U along them plus

    beta K dq/dt,   U = q K q/2,

so that a mode of angular frequency w has the share beta w/2 of critical damping (Rayleigh, Theory
of Sound I, § 102; Clough, Penzien, Dynamics of Structures, § 12-5), and rigid motions none. Unlike
viscosity.py it is of the material, not of the mesh: what is left of an impact does not change as
that is refined, once elements are shorter than the way of a wave in the time beta. Rates are
extrapolated from the last two steps: the stable step falls to (2/w) (sqrt(1 + 4 z²) - 2 z), z =
beta w/2, of the highest w (timestep.py). Sections, stresses and strain energy have no part of it.
"""

from dataclasses import dataclass

import numpy as np

from fpm.elements.bars.beam import Beams, end_axes
from fpm.elements.kind import ElementType
from fpm.elements.particles.damping import Damping

STEP = 1e-30j
"""Imaginary step of derivatives (Squire, Trapp, SIAM Review 40 (1998) 110)."""


@dataclass(frozen=True)
class StiffnessDamping(ElementType):
    """Damping, in proportion to stiffness, of those beam elements of a scene whose material has it
    (Material.stiffness_damping). Nothing is added to a scene: materials say all."""

    takes = Damping.takes
    cost = 40.0  # of each beam element that has it
    resists_as = ""

    @classmethod
    def find(cls, scene):
        """Return the groups of beam elements (Beams) of a scene whose material is damped."""
        return [beams for beams in Beams.find(scene) if beams.material.stiffness_damping > 0]

    @classmethod
    def topology_of(cls, scene):
        """Return None: scenes can be simulated side by side whether bars are damped or not."""
        return None

    @classmethod
    def names(cls, scene):
        """Return the names of all beam elements of a scene, damped or not."""
        return Beams.names(scene)

    @classmethod
    def cost_in(cls, scene):
        return cls.cost * sum(len(beams.length) for beams in cls.find(scene))

    @classmethod
    def dampings(cls, scene):
        """Return how motions of particles deform all beam elements of a scene (Deformations), with
        beta times the stiffness of each in the field `stiffness`, for the stable time step."""
        modes = Beams.deformations(scene)
        return modes._replace(stiffness=_times(scene)[modes.element, 0] * modes.stiffness)

    @classmethod
    def pack(cls, batch):
        from fpm.elements.bars.stiffness_damping_kernels import HISTORY, RATE, DampedElements

        bars, times = batch.part(Beams), batch.stack(len(cls.names(batch.scene)), 1, _times)
        rows = np.flatnonzero(times.any(axis=(1, 2)))

        def select(array, factor=1.0):
            selection = batch.blank(len(rows), array.shape[1])
            selection[:] = (factor * array)[rows]
            return selection

        def history(scene):
            rates = _rates_at_start(scene)[rows]
            return np.pad(rates, [(0, 0), (RATE, HISTORY - RATE - rates.shape[1])])

        axes = {"axes": select(bars.axes)} if "axes" in bars._fields else {}
        return DampedElements(
            bars._replace(nodes=bars.nodes[rows], beams=select(bars.beams, times), **axes),
            batch.stack(len(rows), HISTORY, history),
            batch.loss_account(cls),
        )


def _times(scene) -> np.ndarray:
    """Rayleigh's beta (m, 1) of every beam element, s."""
    times = [np.full(len(b.length), b.material.stiffness_damping) for b in Beams.find(scene)]
    return np.concatenate(times)[:, None]


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
