"""How stiff cables can be at most, wherever their points move to: their part in the stable step.

Theory: docs/mechanics.md, "Cables": springs from each point to the ground, with shares s_i ~ |c_i|²
w_i by the inverse masses w_i, so that nothing is lost for free points. A cable that rubs is at most
as stiff as its stretches, each stuck at both ends, with their unstrained lengths at the start;
where one becomes much shorter, the balance of energies tells."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from fpm.elements.kind import Deformations, VirtualBeam
from fpm.elements.openings.opening import mobility, relative_turn
from fpm.elements.particles.rotation_axes import turns_of

FACTOR = 2.0


class Piece(NamedTuple):
    """What has one tension: virtual beams to its points; stiffness (N/m) at its shortest; index of
    the hinge with the drum that winds it, -1: none; radius of the drum (m)."""

    beams: Sequence[VirtualBeam]
    stiffness: float
    drum: int = -1
    radius: float = 0.0


def bounding_springs(scene, cables: Iterable[Iterable[Piece]]) -> Deformations | None:
    """Return springs from the points of cables to the ground, and on the joints of drums, at least
    as stiff as the cables in any position, as Deformations for the stable time step; None if all
    points are held. scene: of the cables; cables: parts of each with one tension (Piece)."""
    rows = []
    for number, pieces in enumerate(cables):
        for beams, stiffness, drum, radius in pieces:
            factors = [1.0, *[FACTOR**2] * (len(beams) - 2), 1.0]
            motions = [(*_motion(scene, b), x) for b, x in zip(beams, factors, strict=True)]
            total = sum(square * inverse for _, inverse, square in motions)
            spin = mobility(scene, drum) if drum >= 0 else 0.0
            total += radius**2 * spin
            for beam, (values, inverse, _) in zip(beams, motions, strict=True):
                if inverse > 0:  # |c|²/s = total/w
                    dofs = np.tile(6 * beam.particle + np.arange(6), (3, 2))
                    springs = np.full(3, stiffness * total / inverse)
                    rows.append((dofs, values, springs, np.full(3, number)))
            if spin > 0:
                turns = relative_turn(scene, [drum], [stiffness * total / spin])
                rows.append((*turns[:3], np.full(len(turns.element), number)))
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


def with_arms(bounds, pulls: Iterable[tuple[int, VirtualBeam, float]]) -> Deformations | None:
    """Return `bounds` (Deformations of cables or struts, or None) with springs against turns of the
    arms at whose ends forces act, F times the arm, which bear what a force that keeps its direction
    does to a body that turns; about the arm itself it has no moment. pulls: index of the element,
    arm and force (N) of each."""
    rows = [bounds] * (bounds is not None)
    for number, beam, force in pulls:
        length = float(np.linalg.norm(beam.arm))
        if stiffness := force * length:
            dofs, turns = np.tile(6 * beam.particle + np.arange(6), (3, 2)), np.zeros((3, 12))
            turns[:, 3:6] = np.eye(3) - np.outer(beam.arm, beam.arm) / length**2
            rows.append((dofs, turns, np.full(3, stiffness), np.full(3, number)))
    return Deformations(*(np.concatenate(x) for x in zip(*rows, strict=True))) if rows else None
