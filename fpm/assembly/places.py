"""Where all particles are, and how they are turned."""

from typing import NamedTuple

import numpy as np

STEP = 1e-30
"""Of derivatives by complex numbers (Squire, Trapp, SIAM Review 40 (1998) 110): they are exact."""


class Places(NamedTuple):
    """Positions (n, 3) m, and frames (n, 3, 3) with the particles' axes as columns."""

    position: np.ndarray
    frame: np.ndarray

    def moved(self, step: np.ndarray) -> "Places":
        """After a motion (6n,) of all particles: a shift (m) and a turn (rad), in global axes."""
        from scipy.spatial.transform import Rotation

        shift, turn = step.reshape(-1, 2, 3).transpose(1, 0, 2)
        return Places(self.position + shift, Rotation.from_rotvec(turn).as_matrix() @ self.frame)

    def of(self, particles: np.ndarray) -> "Places":
        """Those of some particles (k,)."""
        return Places(self.position[particles], self.frame[particles])

    def nudged(self, direction: int) -> "Places":
        """After an infinitely small shift (direction 0 to 2) or turn (3 to 5), which is complex."""
        if direction < 3:
            return self._replace(position=self.position + 1j * STEP * np.eye(3)[direction])
        turn = np.cross(np.eye(3)[direction - 3], np.eye(3)).T
        return self._replace(frame=self.frame + 1j * STEP * (turn @ self.frame))


def slopes(function, first: Places, second: Places) -> np.ndarray:
    """Derivatives (e, k, 12) of function(first, second) -> (e, k), by the motions of both."""
    ends = [(first.nudged(d), second) for d in range(6)]
    ends += [(first, second.nudged(d)) for d in range(6)]
    return np.stack([function(*pair).imag / STEP for pair in ends], axis=-1)


def gathered(blocks: np.ndarray, pairs: np.ndarray, count: int):
    """The sparse matrix (6 count, 6 count) of blocks (e, 12, 12) on pairs (e, 2) of particles."""
    from scipy.sparse import coo_array

    dofs = dofs_of(pairs)
    rows, columns = np.repeat(dofs, 12, axis=1).ravel(), np.tile(dofs, 12).ravel()
    return coo_array((blocks.ravel(), (rows, columns)), shape=(6 * count, 6 * count)).tocsc()


def dofs_of(pairs: np.ndarray) -> np.ndarray:
    """Degrees of freedom (e, 12) of pairs (e, 2) of particles."""
    return (6 * pairs[:, :, None] + np.arange(6)).reshape(len(pairs), 12)
