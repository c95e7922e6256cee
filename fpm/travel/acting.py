"""What some elements do to all particles, by their own kernels: no kind's physics stands twice."""

from copy import copy
from typing import Any

import numpy as np

from fpm.assembly.conditions import Places
from fpm.elements import Hinge, energies_of
from fpm.elements.batch import Batch
from fpm.kernels import layout as at
from fpm.kernels.world import StepTime

SLOWLY = 1e300
"""Seconds of a step: whatever depends on rates vanishes."""

JUST_AFTER = 5e-324
"""The time (s): that of the start, and not the start, where kernels look at the way so far."""

NUDGE = 1e-6
"""Shift (of the size) and turn (rad) by which forces are differentiated, on either side."""

ABOUT = np.cross(np.eye(3)[:, None], np.eye(3)[None]).swapaxes(1, 2)
"""Matrices (3, 3) of the products with the global axes."""


class Acting:
    """Elements of one kind of a scene, alone: the forces that they have where particles are put.

    They keep what they keep from one place to the next, as the foot of a bristle.
    """

    def __init__(self, scene, elements: list):
        alone, kind = copy(scene), type(elements[0])
        alone.kinds = {Hinge: scene.hinges, kind: elements}
        kinds = [*kind.reads, kind]
        batch = Batch([alone], kinds, energies_of(kinds), at_once(), np.float64, 1, 1)
        self.parts, self.world = batch.parts(), batch.world()
        found = kind.deformations(alone)
        self._stiff = np.zeros(0, int) if found is None else np.unique(found.dofs)
        self._size = float(np.ptp(scene.position, axis=0).max()) or 1.0

    def forces(self, places: Places) -> np.ndarray:
        """Forces and moments (6n,), in global axes, of elements that came here from where they
        were last."""
        self._put(places)
        self._act()
        return self._act()[:, 0]  # once more: nothing is passed on the way

    def kept(self) -> list[np.ndarray]:
        """What the elements keep."""
        return [array.copy() for array in _numbers(self.parts)]

    def restore(self, kept: list[np.ndarray]) -> None:
        """Let them keep it again."""
        for before, array in zip(kept, _numbers(self.parts), strict=True):
            array[:] = before

    def tried(self, places: Places) -> tuple[np.ndarray, Any]:
        """The same, and minus its derivatives, sparse (6n, 6n), by the motions of all; the elements
        stay where they were."""
        from scipy.sparse import csc_array

        before = self.kept()
        self._put(places)
        self._act()
        found, slopes = self._act()[:, 0].copy(), []
        lanes = self.world.state.shape[2]
        for first in range(0, len(self._stiff), lanes):
            dofs = self._stiff[first : first + lanes]
            pair = []
            for sign in (1.0, -1.0):
                self._put(places)
                steps = [self._nudge(places, lane, dof, sign) for lane, dof in enumerate(dofs)]
                self._act()
                pair.append(self._act()[:, : len(dofs)] / (2.0 * np.array(steps)))
            slopes.append(pair[1] - pair[0])
        self.restore(before)
        count = len(found)
        if not slopes:
            return found, csc_array((count, count))
        values = np.hstack(slopes)
        rows, columns = np.nonzero(values)
        entries = values[rows, columns], (rows, self._stiff[columns])
        return found, csc_array(entries, shape=(count, count))

    def _put(self, places: Places) -> None:
        state = self.world.state
        state[:, at.X : at.X + 3] = places.position[:, :, None]
        state[:, at.D2 : at.D2 + 3] = places.frame[:, :, 1, None]
        state[:, at.D3 : at.D3 + 3] = places.frame[:, :, 2, None]

    def _nudge(self, places: Places, lane: int, dof: int, sign: float) -> float:
        """Move one lane along a degree of freedom; by how much, m or rad."""
        (i, k), state = divmod(int(dof), 6), self.world.state
        if k < 3:
            state[i, at.X + k, lane] += sign * NUDGE * self._size
            return NUDGE * self._size
        turned = places.frame[i] + sign * NUDGE * (ABOUT[k - 3] @ places.frame[i])
        state[i, at.D2 : at.D2 + 3, lane] = turned[:, 1]
        state[i, at.D3 : at.D3 + 3, lane] = turned[:, 2]
        return NUDGE

    def _act(self) -> np.ndarray:
        from fpm.kernels.compiled import loop_for

        state = self.world.state
        state[:, at.F : at.M + 3] = 0.0
        arguments = self.parts, self.world, StepTime(JUST_AFTER, SLOWLY, SLOWLY)
        loop_for(arguments, "act")(*arguments)
        return state[:, at.F : at.M + 3].reshape(-1, state.shape[2])


def at_once() -> int:
    """Lanes of a register."""
    from fpm.kernels.lanes import width

    return width(np.float64)


def acts(kind: type) -> bool:
    """Whether a kind has forces in the places of particles."""
    from fpm.kernels.hooks import KERNELS

    own = kind.kernels()
    arrays = [found for found, name in KERNELS if name == "forces"]
    return any(found.__module__ == own.__name__ for found in arrays)


def _numbers(parts) -> list[np.ndarray]:
    """All arrays of numbers in tuples of arrays."""
    found = []
    for part in parts:
        if isinstance(part, tuple):
            found += _numbers(part)
        elif isinstance(part, np.ndarray) and part.dtype.kind == "f":
            found.append(part)
    return found
