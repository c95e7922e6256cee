"""The balance of an assembly on its way, and the forces in bearings with their own friction."""

from collections.abc import Sequence

import numpy as np

from fpm.assembly.conditions import Places as At
from fpm.assembly.elastic import elastic_of
from fpm.travel.acting import Acting
from fpm.travel.components import components_of

SHARES, LOCKED = 8, 1e-3
"""In how many steps the friction of bearings grows to its own, and the determinant of the forces'
equations below which it presses its joint as hard as it is pushed."""

SOFT, STIFF = 1e-8, 1e-13
"""What decides motions that nothing stiffens, as shares of the stiffness of springs and their like,
and at least of that of bars."""

ROUNDS = 40

TINY = 1e-300
"""N m, so that nothing is divided by zero where nothing acts."""


class Balance:
    """Bars, and what else has no losses, for the balance of an assembly (fpm/assembly)."""

    def __init__(self, scene):
        self._bars = elastic_of(scene)
        by_kind: dict[type, list] = {}
        for part in components_of(scene):
            if not part.drags:
                by_kind.setdefault(type(part.balanced), []).append(part.balanced)
        self.acting = [Acting(scene, elements) for elements in by_kind.values()]

    def strain(self, places: At) -> float:
        """Energy (J) of the bars."""
        return self._bars.energy(places) if len(self._bars.nodes) else 0.0

    def derivatives(self, places: At):
        """Gradient (6n,) and its derivatives, sparse (6n, 6n)."""
        gradient, stiffness = self._of_bars(places)
        for acting in self.acting:
            forces, slopes = acting.tried(places)
            gradient, stiffness = gradient - forces, stiffness + slopes
        return gradient, stiffness

    def ease(self, places: At, scales: np.ndarray) -> float:
        """What decides motions that nothing stiffens (N m)."""
        from scipy.sparse import diags

        own = diags(scales)
        soft = [acting.tried(places)[1] for acting in self.acting]
        bars, *others = (abs(own @ k @ own).max() for k in (self._of_bars(places)[1], *soft))
        return max(STIFF * bars, SOFT * max(others, default=0.0)) or 1.0

    def _of_bars(self, places: At):
        from scipy.sparse import csc_array

        if len(self._bars.nodes):
            return self._bars.derivatives(places)
        count = 2 * places.position.size
        return np.zeros(count), csc_array((count, count))

    def follow(self, places: At) -> None:
        """Everything has come here."""
        for acting in self.acting:
            acting.forces(places)


def forces_with_friction(
    base: Sequence[np.ndarray], slopes: Sequence[np.ndarray]
) -> tuple[np.ndarray, bool]:
    """The forces F (b,) N in bearings with their own friction, and whether there are such forces.

    F_i = |base_i + slopes_i F|, base_i (r,) being the force in joint i without the bearings'
    friction, slopes_i (r, b) how it goes with theirs. The solution is followed by Newton's method
    from no friction on; where its equations become singular, a bearing locks itself.
    """
    forces = np.array([np.linalg.norm(x) for x in base])
    for share in np.linspace(0.0, 1.0, 1 + SHARES)[1:]:
        for _ in range(ROUNDS):
            borne = [x + share * c @ forces for x, c in zip(base, slopes, strict=True)]
            size = np.array([np.linalg.norm(x) for x in borne])
            jacobian = np.eye(len(size)) - share * np.stack([
                x @ c / max(f, TINY) for x, c, f in zip(borne, slopes, size, strict=True)
            ])  # fmt: skip
            if np.linalg.det(jacobian) < LOCKED:
                return forces, False
            change = np.linalg.solve(jacobian, size - forces)
            forces = np.maximum(forces + change, 0.0)
            if np.abs(change).max() <= 1e-10 * forces.max(initial=TINY):
                break
        else:
            return forces, False
    return forces, True
