"""How stiff cables can be at most, wherever their points move to: their part in the stable step.

A cable's length changes by sum c_i · y_i with the motions y_i of its points, |c_i| = 1 at the ends
and at most 2 between (there and back again). By Cauchy and Schwarz (sum c_i · y_i)² is at most the
sum of |c_i|² |y_i|²/s_i for any shares s_i that add up to 1: springs from each point to the ground,
along all axes. With s_i ~ |c_i|² w_i, w_i being the inverse masses, nothing is lost for free
points. These springs bear the tension's stiffness across, T/l for a stretch l, as well, as long as
T/l <= EA/R: what is watched as crowding.

A cable that rubs is at most as stiff as its stretches, each stuck at both ends. Their unstrained
lengths are those at the start; where one becomes much shorter, the balance of energies tells."""

from collections.abc import Iterable, Sequence

import numpy as np

from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.elements.kind import Deformations
from fpm.elements.particles.rotation_axes import turns_of

FACTOR = 2.0

Piece = tuple[Sequence[VirtualBeam], float]
"""The points of what has one tension, and its stiffness (N/m) at its shortest."""


def bounding_springs(scene, cables: Iterable[Iterable[Piece]]) -> Deformations | None:
    """Return springs from the points of cables to the ground at least as stiff as the cables in any
    position, as Deformations for the stable time step; None if all points are held. scene: of the
    cables; cables: parts of each with one tension (virtual beams, stiffness in N/m)."""
    rows = []
    for number, pieces in enumerate(cables):
        for beams, stiffness in pieces:
            factors = [1.0, *[FACTOR**2] * (len(beams) - 2), 1.0]
            motions = [(*_motion(scene, b), x) for b, x in zip(beams, factors, strict=True)]
            total = sum(square * mobility for _, mobility, square in motions)
            for beam, (values, mobility, _) in zip(beams, motions, strict=True):
                if mobility > 0:  # |c|²/s = total/w
                    dofs = np.tile(6 * beam.particle + np.arange(6), (3, 2))
                    springs = np.full(3, stiffness * total / mobility)
                    rows.append((dofs, values, springs, np.full(3, number)))
    return Deformations(*(np.concatenate(x) for x in zip(*rows, strict=True))) if rows else None


def _motion(scene, beam: VirtualBeam) -> tuple[np.ndarray, float]:
    """Rows (3, 12) of the motion of a beam's free end, and its largest inverse mass (1/kg)."""
    p = beam.particle
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    turns = -np.array([np.cross(beam.arm, e) for e in np.eye(3)]).T
    values = np.hstack([np.eye(3), frame[p] @ turns, np.zeros((3, 6))])
    inertia = np.concatenate([np.full(3, scene.mass[p]), scene.inertia[p]])
    no_motion = np.concatenate([scene.fixed[p, :3], turns_of(scene).no_turn[p]])
    inverse = np.where(no_motion, 0.0, 1.0 / inertia)
    return values, float(np.linalg.eigvalsh((values[:, :6] * inverse) @ values[:, :6].T)[-1])
