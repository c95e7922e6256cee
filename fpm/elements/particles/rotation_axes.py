"""How supports let particles turn (theory: docs/mechanics.md, "Particles and the step")."""

from typing import NamedTuple

import numpy as np

from fpm.errors import SceneError

TOLERANCE = 1e-12
"""Share by which inertias that are alike may differ, by rounding."""


class RotationAxes(NamedTuple):
    """How supports let the n particles of a scene turn. inertia (n, 3): moments of inertia (kg m²)
    about own axes; of a particle that turns about a single global axis that about this, repeated;
    no_turn (n, 3): whether it never turns about an own axis."""

    inertia: np.ndarray
    no_turn: np.ndarray


def turns_of(scene) -> RotationAxes:
    """Return how the supports of a scene let its particles turn. Raises SceneError for one that
    turns about two axes with unequal inertias."""
    fixed = scene.fixed[:, 3:]
    count, inertia = fixed.sum(axis=1), scene.inertia.copy()
    no_turn = np.repeat(count[:, None] == 3, 3, axis=1)
    for p in np.flatnonzero(count == 2):
        squares = scene.frame[p][~fixed[p]][0] ** 2
        inertia[p] = squares @ inertia[p]
        no_turn[p] = (squares < TOLERANCE) & (squares.max() > 1 - TOLERANCE)
    is_unequal = inertia.max(axis=1) - inertia.min(axis=1) > TOLERANCE * inertia.max(axis=1)
    for p in np.flatnonzero((count == 1) & is_unequal):
        raise SceneError(
            f"rotations of particle {p}, held about {'xyz'[fixed[p].argmax()]} alone",
            inertia[p].tolist(),
            "two or three axes, the same inertia about all of its own, or a joint to the ground, "
            "as a universal one, that holds them",
        )
    return RotationAxes(inertia, no_turn)
