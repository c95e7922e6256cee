"""Static balance of an assembly during its travel, and forces in bearings with their friction."""

from collections.abc import Sequence

import numpy as np

from fpm.assembly.element_forces import BalanceForces, ElementForces
from fpm.travel.components import components_of

FRICTION_STEPS, LOCKING_DETERMINANT = 8, 1e-3
"""Number of steps in which the friction of bearings is raised to its full value, and determinant of
the forces' equations below which a bearing locks itself."""

SOFT, STIFF = 1e-8, 1e-13
"""What decides motions that nothing stiffens, as shares of the stiffness of springs and their like,
and at least of that of bars."""

MAX_ITERATIONS = 40
"""Number of iterations of Newton's method, at most."""

TINY = 1e-300
"""Least force or moment (N, N m) by which is divided, so that nothing is divided by zero."""


def balance_of(scene) -> BalanceForces:
    """Return the forces in static equilibrium of a scene: those of its elastic bars and of all
    elements that store energy or load it, not of those that only resist, as friction."""
    by_kind: dict[type, list] = {}
    for part in components_of(scene):
        if not part.drags:
            by_kind.setdefault(type(part.element), []).append(part.element)
    return BalanceForces(scene, [ElementForces(scene, elements) for elements in by_kind.values()])


def forces_with_friction(
    base: Sequence[np.ndarray], slopes: Sequence[np.ndarray]
) -> tuple[np.ndarray, bool]:
    """Return forces F (b,) N in b bearings whose own friction loads them further, and whether there
    is a solution (False: a bearing locks itself): F_i = |base_i + slopes_i F|. base: by bearing i,
    the force (r,) N in its joint without bearing friction; slopes: by bearing, its derivatives (r,
    b) by all F. The solution is followed by Newton's method from no friction on; where its
    equations become singular, a bearing locks itself."""
    forces = np.array([np.linalg.norm(x) for x in base])
    for factor in np.linspace(0.0, 1.0, 1 + FRICTION_STEPS)[1:]:
        for _ in range(MAX_ITERATIONS):
            joint_forces = [x + factor * c @ forces for x, c in zip(base, slopes, strict=True)]
            size = np.array([np.linalg.norm(x) for x in joint_forces])
            rows = zip(joint_forces, slopes, size, strict=True)
            jacobian = np.eye(len(size)) - factor * np.stack(
                [x @ c / max(f, TINY) for x, c, f in rows]
            )
            if np.linalg.det(jacobian) < LOCKING_DETERMINANT:
                return forces, False
            change = np.linalg.solve(jacobian, size - forces)
            forces = np.maximum(forces + change, 0.0)
            if np.abs(change).max() <= 1e-10 * forces.max(initial=TINY):
                break
        else:
            return forces, False
    return forces, True
