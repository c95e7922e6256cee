"""Forces of chosen elements on all particles, by the elements' own kernels."""

from collections.abc import Sequence
from copy import copy
from typing import Any

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.elements import Hinge, energies_of
from fpm.elements.batch import Batch
from fpm.kernels import layout
from fpm.kernels.world import StepTime

LONG_STEP = 1e300
"""Time step (s) of a quasi-static motion, so long that forces by rates vanish."""

TIME_AFTER_START = 5e-324
"""Time (s) of all forces: that of the start, but above 0, where kernels initialise elements."""

NUDGE = 1e-6
"""Shift (of the size) and turn (rad) by which forces are differentiated, on either side."""

CROSS_PRODUCTS = np.cross(np.eye(3)[:, None], np.eye(3)[None]).swapaxes(1, 2)
"""Matrices (3, 3, 3) of the vector products with the three global axes."""


class ElementForces:
    """Computes the forces of elements of one type on the n particles of a scene, by their kernels.
    `forces(poses)` returns (6n,): force (N), then moment (N m), global, on each particle in turn;
    `linearise(poses)` these and their stiffness (6n, 6n). scene: theirs; elements: list, of one
    type; stiff: degrees of freedom by which forces may change, beside those by which springs are
    strained. Their memory, as of a bristle's deflection, goes on from call to call of `forces`."""

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
        deformations = kind.deformations(part_scene)
        dofs = () if deformations is None else deformations.dofs.ravel()
        self._stiff = np.unique([*dofs, *stiff]).astype(int)
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0

    def forces(self, poses: ParticlePoses) -> np.ndarray:
        """Move the elements from their last poses to `poses` (positions and frames of all
        particles); returns force (N), then moment (N m), global, on each particle in turn (6n,)."""
        self._put(poses)
        self._act()
        return self._act()[:, 0]  # once more: nothing is passed on the way

    def copy_history(self) -> list[np.ndarray]:
        """Return copies of the elements' float arrays (as bristle deflections), for `restore`."""
        return [array.copy() for array in _numbers(self.parts)]

    def restore(self, history: list[np.ndarray]) -> None:
        """Put `history`, a list that `copy_history` returned, back into the elements."""
        for values, array in zip(history, _numbers(self.parts), strict=True):
            array[:] = values

    def linearise(self, poses: ParticlePoses) -> tuple[np.ndarray, Any]:
        """Return forces (6n,) of the elements at `poses` (positions and frames of n particles),
        force (N), then moment (N m) on each, and their stiffness, sparse (6n, 6n): minus the
        derivatives by all motions (m, rad). The elements' memory (bristle deflections) is kept."""
        from scipy.sparse import csc_array

        history = self.copy_history()
        self._put(poses)
        self._act()
        forces, slopes = self._act()[:, 0].copy(), []
        lanes = self.world.state.shape[2]
        for first in range(0, len(self._stiff), lanes):
            dofs = self._stiff[first : first + lanes]
            pair = []
            for sign in (1.0, -1.0):
                self._put(poses)
                steps = [self._nudge(poses, lane, dof, sign) for lane, dof in enumerate(dofs)]
                self._act()
                pair.append(self._act()[:, : len(dofs)] / (2.0 * np.array(steps)))
            slopes.append(pair[1] - pair[0])
        self.restore(history)
        count = len(forces)
        if not slopes:
            return forces, csc_array((count, count))
        values = np.hstack(slopes)
        rows, columns = np.nonzero(values)
        entries = values[rows, columns], (rows, self._stiff[columns])
        return forces, csc_array(entries, shape=(count, count))

    def _put(self, poses: ParticlePoses) -> None:
        state = self.world.state
        state[:, layout.X : layout.X + 3] = poses.position[:, :, None]
        state[:, layout.D2 : layout.D2 + 3] = poses.frame[:, :, 1, None]
        state[:, layout.D3 : layout.D3 + 3] = poses.frame[:, :, 2, None]

    def _nudge(self, poses: ParticlePoses, lane: int, dof: int, sign: float) -> float:
        """Move one lane along a degree of freedom, and return the size of the step (m or rad)."""
        (i, k), state = divmod(int(dof), 6), self.world.state
        if k < 3:
            state[i, layout.X + k, lane] += sign * NUDGE * self._size
            return NUDGE * self._size
        frame = poses.frame[i] + sign * NUDGE * (CROSS_PRODUCTS[k - 3] @ poses.frame[i])
        state[i, layout.D2 : layout.D2 + 3, lane] = frame[:, 1]
        state[i, layout.D3 : layout.D3 + 3, lane] = frame[:, 2]
        return NUDGE

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
