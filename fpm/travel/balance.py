"""Static balance of an assembly during its travel, and forces in bearings with their friction."""

from collections.abc import Sequence

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.assembly.elastic import elastic_of
from fpm.assembly.element_forces import ElementForces
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


class Balance:
    """What enters the static equilibrium of a scene: its elastic bars and all elements that store
    energy or load it, not those that only resist, as friction. The solver of equilibria calls its
    methods with `poses`, positions and frames of all n particles."""

    def __init__(self, scene):
        self._bars = elastic_of(scene)
        by_kind: dict[type, list] = {}
        for part in components_of(scene):
            if not part.drags:
                by_kind.setdefault(type(part.element), []).append(part.element)
        self.sources = [ElementForces(scene, elements) for elements in by_kind.values()]

    def strain(self, poses: ParticlePoses) -> float:
        """Return strain energy (J) of all bars at `poses` (particles' positions and frames)."""
        return self._bars.energy(poses) if len(self._bars.nodes) else 0.0

    def derivatives(self, poses: ParticlePoses):
        """Return the gradient (6n,) of the potential energy (N, N m) by the motions (m, rad) of n
        particles at `poses`, and the stiffness, its derivatives, sparse (6n, 6n)."""
        gradient, stiffness = self._of_bars(poses)
        for source in self.sources:
            forces, slopes = source.linearise(poses)
            gradient, stiffness = gradient - forces, stiffness + slopes
        return gradient, stiffness

    def dense_derivatives(self, poses: ParticlePoses) -> tuple[np.ndarray, np.ndarray]:
        """Return what `derivatives` does, with the stiffness as an array (6n, 6n)."""
        count = 2 * poses.position.size
        gradient, stiffness = np.zeros(count), np.zeros((count, count))
        if len(self._bars.nodes):
            gradient, bars = self._bars.derivatives(poses)
            stiffness += bars
        for source in self.sources:
            forces, columns = source.differentiate(poses)
            gradient = gradient - forces
            stiffness[:, source.stiff] += columns
        return gradient, stiffness

    def ease(self, poses: ParticlePoses, scales: np.ndarray) -> float:
        """Return an artificial stiffness (N m), small beside that of springs and bars at `poses`,
        by which the solver decides motions that no element stiffens. scales (6n,): length (m) or
        angle (rad) that is the unit of each degree of freedom of the n particles."""
        from scipy.sparse import diags

        units = diags(scales)
        soft = [source.linearise(poses)[1] for source in self.sources]
        bars, *springs = (abs(units @ k @ units).max() for k in (self._of_bars(poses)[1], *soft))
        return max(STIFF * bars, SOFT * max(springs, default=0.0)) or 1.0

    def _of_bars(self, poses: ParticlePoses):
        from scipy.sparse import csc_array

        if len(self._bars.nodes):
            return self._bars.derivatives(poses)
        count = 2 * poses.position.size
        return np.zeros(count), csc_array((count, count))

    def follow(self, poses: ParticlePoses) -> None:
        """Move the elements on to `poses` (positions and frames of all particles), where those with
        memory, as bristles with a deflection, start next time."""
        for source in self.sources:
            source.forces(poses)


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
