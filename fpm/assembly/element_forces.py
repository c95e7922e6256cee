"""Forces of chosen elements on all particles, by the elements' own kernels."""

from collections.abc import Sequence
from copy import copy
from typing import Any

import numpy as np

from fpm.assembly.conditions import CROSS_PRODUCTS, ParticlePoses
from fpm.elements import Gravity, Hinge, SyncLoop, TorsionSpring, energies_of
from fpm.elements.batch import Batch
from fpm.kernels import layout
from fpm.kernels.world import StepTime

LONG_STEP = 1e300
"""Time step (s) of a quasi-static motion, so long that forces by rates vanish."""

TIME_AFTER_START = 5e-324
"""Time (s) of all forces: that of the start, but above 0, where kernels initialise elements."""

NUDGE = 1e-6
"""Shift (of the size) and turn (rad) by which forces are differentiated, on either side."""


MEMORYLESS = (TorsionSpring, SyncLoop, Gravity)
"""Element types whose forces do not depend on the way to where they act."""


class ElementForces:
    """Computes the forces of elements of one type on the n particles of a scene, by their kernels.
    `forces(poses)` returns (6n,): force (N), then moment (N m), global, on each particle in turn;
    `linearise(poses)` these and their stiffness (6n, 6n). scene: theirs; elements: list, of one
    type; stiff: degrees of freedom by which forces may change, beside those by which springs are
    strained, all of which are in the attribute of that name. Their memory, as of a bristle's
    deflection, goes on from call to call of `forces`."""

    def __init__(self, scene, elements: list, stiff: Sequence[int] = ()):
        from fpm.kernels.compiled_loop import prepare_call

        part_scene, kind = copy(scene), type(elements[0])
        part_scene.kinds = {Hinge: scene.hinges, kind: elements}
        kinds = [*kind.reads_in(part_scene), kind]
        rest = energies_of(kinds), lanes_of_register(), np.float64, 1, 1
        batch = Batch([part_scene], kinds, *rest)
        self.parts, self.world = batch.parts(), batch.world()
        timing = StepTime(TIME_AFTER_START, LONG_STEP, LONG_STEP)
        self._call = prepare_call("act", self.parts, self.world, timing)
        self._history = _numbers(self.parts)
        deformations = kind.deformations(part_scene)
        if deformations is not None:
            # What turns joints strains by no shift, at the start nor later: an opening is an angle.
            is_strained = deformations.values.reshape(-1, 4, 3).any(axis=2)
            is_strained[:, [1, 3]] = True
            stiff = [*stiff, *deformations.dofs[np.repeat(is_strained, 3, axis=1)]]
        self.stiff = np.unique(stiff).astype(int)
        self._is_passing = kind not in MEMORYLESS
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0

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

    def linearise(self, poses: ParticlePoses) -> tuple[np.ndarray, Any]:
        """Return forces (6n,) of the elements at `poses` (positions and frames of n particles),
        force (N), then moment (N m) on each, and their stiffness, sparse (6n, 6n): minus the
        derivatives by all motions (m, rad). The elements' memory (bristle deflections) is kept."""
        from scipy.sparse import csc_array

        forces, values = self.differentiate(poses)
        rows, columns = np.nonzero(values)
        entries = values[rows, columns], (rows, self.stiff[columns])
        return forces, csc_array(entries, shape=(len(forces), len(forces)))

    def differentiate(self, poses: ParticlePoses) -> tuple[np.ndarray, np.ndarray]:
        """Return what `linearise` does, but of the stiffness its columns (6n, k) for the degrees of
        freedom `stiff` (k,); all others are zero."""
        history = self.copy_history()
        self._put(poses)
        forces, slopes = self._act_there()[:, 0].copy(), []
        lanes = self.world.state.shape[2]
        for first in range(0, len(self.stiff), lanes):
            dofs, pair = self.stiff[first : first + lanes], []
            for sign in (1.0, -1.0):
                self._put(poses)
                steps = self._nudge(poses, dofs, sign)
                pair.append(self._act_there()[:, : len(dofs)] / (2.0 * steps))
            slopes.append(pair[1] - pair[0])
        self.restore(history)
        return forces, np.hstack([np.zeros((len(forces), 0)), *slopes])

    def _put(self, poses: ParticlePoses) -> None:
        state = self.world.state
        state[:, layout.X : layout.X + 3] = poses.position[:, :, None]
        state[:, layout.D2 : layout.D2 + 3] = poses.frame[:, :, 1, None]
        state[:, layout.D3 : layout.D3 + 3] = poses.frame[:, :, 2, None]

    def _nudge(self, poses: ParticlePoses, dofs: np.ndarray, sign: float) -> np.ndarray:
        """Move each lane along a degree of freedom, and return the sizes of steps (m or rad)."""
        (particle, axis), lane, state = np.divmod(dofs, 6), np.arange(len(dofs)), self.world.state
        k, turn = lane[axis < 3], lane[axis >= 3]
        state[particle[k], layout.X + axis[k], k] += sign * NUDGE * self._size
        frame = poses.frame[particle[turn]]
        frame = frame + sign * NUDGE * (CROSS_PRODUCTS[axis[turn] - 3] @ frame)
        for column, first in ((1, layout.D2), (2, layout.D3)):
            state[particle[turn, None], first + np.arange(3), turn[:, None]] = frame[:, :, column]
        return np.where(axis < 3, NUDGE * self._size, NUDGE)

    def _act_there(self) -> np.ndarray:
        """What the elements do where they have come to, not what they did on the way there."""
        if self._is_passing:
            self._act()
        return self._act()

    def _act(self) -> np.ndarray:
        state = self.world.state
        state[:, layout.F : layout.M + 3] = 0.0
        self._call()
        return state[:, layout.F : layout.M + 3].reshape(-1, state.shape[2])


def lanes_of_register() -> int:
    """Return how many double-precision values kernels compute at once (lanes), 8."""
    from fpm.kernels.lanes import width

    return width(np.float64)


def acts(kind: type) -> bool:
    """Return whether an element type `kind` has a kernel that adds forces to particles."""
    from fpm.kernels.hooks import KERNELS

    kernels = kind.kernels()
    array_types = [array_type for array_type, name in KERNELS if name == "forces"]
    return any(array_type.__module__ == kernels.__name__ for array_type in array_types)


def _numbers(parts) -> list[np.ndarray]:
    """All arrays of floating-point numbers in nested tuples."""
    arrays = []
    for part in parts:
        if isinstance(part, tuple):
            arrays += _numbers(part)
        elif isinstance(part, np.ndarray) and part.dtype.kind == "f":
            arrays.append(part)
    return arrays
