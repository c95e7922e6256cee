"""Forces of chosen elements on all particles, by the elements' own kernels."""

from collections.abc import Sequence
from copy import copy
from typing import Any

import numpy as np

from fpm.assembly.conditions import CROSS_PRODUCTS, ParticlePoses
from fpm.assembly.elastic import elastic_of
from fpm.assembly.matrices import Form, largest_entry, scale_matrix, sparse
from fpm.elements import Hinge
from fpm.elements.batch import Batch
from fpm.kernels import layout
from fpm.kernels.world import StepTime

LONG_STEP = 1e300
"""Time step (s) of a quasi-static motion, so long that forces by rates vanish."""

TIME_AFTER_START = 5e-324
"""Time (s) of all forces: that of the start, but above 0, where kernels initialise elements."""

POSE = slice(layout.X, layout.D3 + 3)
"""Fields of a particle's state by which forces are found: its position, and two of its axes."""

PLACES, WEIGHTS = np.polynomial.legendre.leggauss(3) * np.array([[0.5], [0.5]]) + np.array(
    [[0.5], [0.0]]
)
"""Places between 0 and 1, and weights, of three points that integrate polynomials of degree 5."""

PANEL = 0.3
"""Largest motion (m, rad) over which forces are integrated so."""

NUDGE = 1e-6
"""Shift (of the size) and turn (rad) by which forces are differentiated, on either side."""

NUDGE_SHARES, BEND_SHARE, BEND_TOL = (1.0, 1e-2, 1e-4, 1e-6), 0.1, 1e-7
"""Shares of it that are tried in turn where slopes on both sides differ by more than these shares:
of the slope itself, and of the largest slope."""


class ElementForces:
    """Computes the forces of `elements`, of one type, on the n particles of a scene, by their
    kernels: `forces(poses)` (6n,), force (N), then moment (N m), global, on each particle in turn,
    and `linearise(poses)`. stiff: degrees of freedom by which forces may change, beside those by
    which springs are strained. Their memory, as a bristle's deflection, goes on from call to call
    of `forces`."""

    def __init__(self, scene, elements: list, stiff: Sequence[int] = ()):
        from fpm.kernels.compiled_loop import prepare_call

        part_scene, kind = copy(scene), type(elements[0])
        part_scene.kinds = {Hinge: scene.hinges, kind: elements}
        # As at the start: kernels take means of curves over a step.
        zero = np.zeros(1)
        part_scene.curves = [type(c).table(zero, c.value(zero)) for c in scene.curves]
        kinds = [*kind.reads_in(part_scene), kind]
        batch = Batch([part_scene], kinds, 1, 1)
        self.parts, self._history = batch.parts(), batch.filled_blocks()
        self.world = batch.world()
        self.world.state[:, layout.P : layout.P + 3] = 0.0  # poses are not reached by steps
        timing = StepTime(TIME_AFTER_START, LONG_STEP, LONG_STEP)
        self._call = prepare_call("act", self.parts, self.world, timing)
        deformations = kind.deformations(part_scene)
        if deformations is not None:
            # Elements that turn joints are never strained by a shift: an opening is an angle.
            is_strained = deformations.values.reshape(-1, 4, 3).any(axis=2)
            is_strained[:, [1, 3]] = True
            stiff = [*stiff, *deformations.dofs[np.repeat(is_strained, 3, axis=1)]]
        self.stiff = np.unique(stiff).astype(int)
        self._has_memory = kind.has_memory
        size = float(np.ptp(scene.position, axis=0).max()) or 1.0
        self._particles, axes = np.divmod(self.stiff, 6)
        is_turn = axes >= 3
        self._widths = 2.0 * np.where(is_turn, NUDGE, NUDGE * size)
        self._shifts = NUDGE * size * np.eye(6, 9)[axes] * ~is_turn[:, None]
        self._turns = np.flatnonzero(is_turn), CROSS_PRODUCTS[axes[is_turn] - 3]

    def forces(self, poses: ParticlePoses) -> np.ndarray:
        """Move the elements from their last poses to `poses` (positions and frames of all
        particles); returns force (N), then moment (N m), global, on each particle in turn (6n,)."""
        self._put(poses)
        return self._act_there()[:, 0]

    def copy_history(self) -> list[np.ndarray]:
        """Return copies of the elements' float arrays (as bristle deflections), for `restore`."""
        return [array.copy() for array in self._history]

    def restore(self, history: list[np.ndarray]) -> None:
        """Put `history`, a list that `copy_history` returned, back into the elements."""
        for values, array in zip(history, self._history, strict=True):
            array[:] = values

    def linearise(self, poses: ParticlePoses, form: Form = sparse) -> tuple[np.ndarray, Any]:
        """Return forces (6n,) at `poses` and their stiffness (6n, 6n), minus the derivatives by all
        motions (m, rad); the elements' memory is kept. form: of the stiffness (`sparse`,
        `full`)."""
        history = self.copy_history()
        self._put(poses)
        forces, columns = self._act_there()[:, 0].copy(), np.arange(len(self.stiff))
        values = np.zeros((len(forces), len(columns)))
        for share in NUDGE_SHARES:
            lower, upper = self._nudge(poses, columns, share)
            widths = share * self._widths[columns]
            values[:, columns] = (lower - upper) / widths
            # Where the slopes on both sides differ, a bend as of a stop lies between them.
            bends = np.abs(lower + upper - 2.0 * forces[:, None]) / widths
            slopes = np.abs(values[:, columns])
            is_bent = bends > np.maximum(BEND_SHARE * slopes, BEND_TOL * slopes.max(initial=0.0))
            columns = columns[is_bent.any(axis=0)]
            if not len(columns):
                break
        self.restore(history)
        rows, columns = np.nonzero(values)
        entries = values[rows, columns], rows, self.stiff[columns]
        return forces, form(*entries, (len(forces), len(forces)))

    def _nudge(self, poses, columns, share: float):
        """Forces (6n, c) at `poses` less, then plus, a share of the nudge of each of c columns."""
        shifts, (turns, products), state = self._shifts.copy(), self._turns, self.world.state
        frames = poses.frame[self._particles[turns]]
        shifts[turns, 3:] = (NUDGE * (products @ frames))[:, :, 1:].swapaxes(1, 2).reshape(-1, 6)
        shifts = share * np.concatenate([-shifts[columns], shifts[columns]])
        particles, lanes = np.tile(self._particles[columns], 2), state.shape[2]
        forces = np.empty((6 * len(poses.position), len(shifts)))
        for first in range(0, len(shifts), lanes):
            chunk = slice(first, first + lanes)
            size = len(shifts[chunk])
            self._put(poses)
            state[particles[chunk], POSE, np.arange(size)] += shifts[chunk]
            forces[:, chunk] = self._act_there()[:, :size]
        return forces[:, : len(columns)], forces[:, len(columns) :]

    def _put(self, poses: ParticlePoses) -> None:
        """Place the particles of all lanes at poses."""
        arrays = poses.position, poses.frame[:, :, 1], poses.frame[:, :, 2]
        self.world.state[:, POSE] = np.concatenate(arrays, axis=1)[:, :, None]

    def _act_there(self) -> np.ndarray:
        """Evaluate the elements at the present positions, without the forces of the way there."""
        state = self.world.state
        for _ in range(1 + self._has_memory):
            state[:, layout.F : layout.M + 3] = 0.0
            self._call()
        return state[:, layout.F : layout.M + 3].reshape(-1, state.shape[2])


class BalanceForces:
    """Forces in static balance in a scene: those of its elastic bars (`bars`), and of elements
    (`sources`: ElementForces of each type), at `poses` of all particles."""

    def __init__(self, scene, sources: Sequence[ElementForces]):
        self.bars, self.sources = elastic_of(scene), sources

    def derivatives(self, poses: ParticlePoses, form: Form = sparse, convex: bool = False):
        """Return the gradient (6n,) of the potential energy (N, N m) by the motions (m, rad) of all
        particles, and the stiffness (6n, 6n), its derivatives. form, convex: as of Elastic."""
        gradient, stiffness = self.bars.derivatives(poses, form, convex)
        for source in self.sources:
            forces, slopes = source.linearise(poses, form)
            gradient, stiffness = gradient - forces, stiffness + slopes
        return gradient, stiffness

    def sizes(self, poses: ParticlePoses, scales: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Return the largest stiffness (N m) of bars and of elements, and the largest force (N m)
        that bars or elements of one type give by each degree of freedom (6n,). scales (6n,): length
        (m) or angle (rad) that is the unit of each."""
        gradient, stiffness = self.bars.derivatives(poses)
        largest = [largest_entry(scale_matrix(stiffness, scales, scales))]
        forces = np.abs(scales * gradient)
        for source in self.sources:
            source_forces, stiffness = source.linearise(poses)
            largest.append(largest_entry(scale_matrix(stiffness, scales, scales)))
            forces = np.maximum(forces, np.abs(scales * source_forces))
        return largest[0], max(largest[1:], default=0.0), forces

    def follow(self, poses: ParticlePoses) -> None:
        """Move the elements on to `poses`, from where those with memory start next time."""
        for source in self.sources:
            source.forces(poses)

    def change(self, first: ParticlePoses, last: ParticlePoses) -> float:
        """Return by how much (J) the potential energy is more at the last poses than at the first:
        the strain energy of bars, less the work of elements on the straight way there."""
        change, motion = (
            self.bars.energy(last) - self.bars.energy(first),
            displacement(first, last),
        )
        largest = float(np.abs(motion).max(initial=0.0))
        if not np.isfinite(largest):
            return np.inf
        panels, memory = max(1, int(np.ceil(largest / PANEL))), self.memory()
        for panel in range(panels if self.sources else 0):
            for place, weight in zip(PLACES, WEIGHTS, strict=True):
                poses = first.displace((panel + place) / panels * motion)
                forces = sum(source.forces(poses) for source in self.sources)
                change -= weight / panels * float(forces @ motion)
        self.restore(memory)
        return change

    def memory(self) -> list:
        """Return what elements remember of their motion, for `restore`."""
        return [source.copy_history() for source in self.sources]

    def restore(self, memory: list) -> None:
        """Set elements back to what `memory` returned, as after a trial motion."""
        for source, history in zip(self.sources, memory, strict=True):
            source.restore(history)


def displacement(first: ParticlePoses, last: ParticlePoses) -> np.ndarray:
    """Return the motion (6n,), m and rad, by which `first.displace` gives `last`."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(last.frame @ first.frame.transpose(0, 2, 1)).as_rotvec()
    return np.stack([last.position - first.position, turn], axis=1).ravel()


def acts(kind: type[Any]) -> bool:
    """Return whether an element type `kind` has a kernel that adds forces to particles."""
    from fpm.kernels.hooks import KERNELS

    kernels = kind.kernels()
    array_types = [array_type for array_type, name in KERNELS if name == "forces"]
    return any(array_type.__module__ == kernels.__name__ for array_type in array_types)
