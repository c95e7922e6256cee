"""Newton's method for static balance with closed joints: its linear equations, and masses.

Theory: docs/mechanics.md, "Parts that are forced together" (proximal method of multipliers:
Rockafellar, Math. Oper. Res. 1 (1976) 97)."""

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.assembly.matrices import Form, largest_entry, saddle_solver, scale_matrix, sparse

EASE = 1e-13
"""δ, where the largest entries of H, M and G are one."""


def linearise(
    scene,
    poses,
    conditions,
    balance,
    impulses,
    scales,
    free,
    weight,
    ease,
    mass=None,
    form=sparse,
    convex=False,
):
    """Set up linear equations of a Newton step to static balance; returns a function solve(forces,
    gap_changes) and the gradient (6n,) of strain energy plus conditions times impulses.

    solve: from forces (6n,), N and N m, and gap_changes (c,) of the conditions times `weight`, the
    motion (6n,), over `scales`, and change (c,) of impulses, NaN where the matrix is singular.
    conditions: Conditions, c of them; balance: Elastic or BalanceForces; impulses (c,): their
    Lagrange multipliers (N m); scales (6n,): size (m) for shifts, 1 for turns; free: degrees of
    freedom not held; weight (c,): makes conditions dimensionless; ease: stiffness (N m) by which
    the largest mass, others in proportion, holds back motions that strain nothing; mass: mass
    matrix, None: the scene's; form: of matrices, `full` for few particles; convex: without what
    makes bars' energy concave."""
    count = len(scales)
    gradient, stiffness = balance.derivatives(poses, form, convex)
    rows, curvature = conditions.derivatives(poses, weight * impulses, form)
    stiffness, gradient = stiffness + curvature, gradient + rows.T @ (weight * impulses)
    stiffness = scale_matrix(stiffness, scales, scales)
    if mass is None:
        mass = scale_matrix(masses(scene, poses, form), scales, scales)
    unit = max(largest_entry(stiffness), ease)
    inner = (stiffness / unit + mass * (ease / unit / mass.max()))[free][:, free]
    solve_system = saddle_solver(inner, scale_matrix(rows, weight, scales)[:, free], EASE)

    def solve(forces, gap_changes):
        solution = solve_system(np.concatenate([(scales * forces)[free] / unit, gap_changes]))
        step = np.zeros(count)
        step[free] = solution[: len(free)]
        return step, unit * solution[len(free) :]

    return solve, gradient


def masses(scene, poses: ParticlePoses, form: Form = sparse):
    """Return a mass matrix (6n, 6n) of all n particles of a scene at `poses`, in global axes: 3 by
    3 blocks of mass (kg), then inertia (kg m²), of one particle after the other. form: of the
    matrix (`sparse`, `full`)."""
    blocks = mass_blocks(scene, poses)
    dofs = np.arange(6 * len(blocks)).reshape(-1, 2, 3)
    rows, columns = np.broadcast_arrays(dofs[..., None], dofs[:, :, None])
    places = np.nonzero(blocks)
    return form(blocks[places], rows[places], columns[places], (dofs.size, dofs.size))


def mass_blocks(scene, poses: ParticlePoses) -> np.ndarray:
    """Return the blocks (n, 2, 3, 3) of the mass matrix of all n particles of a scene at `poses`,
    in global axes: that of the mass (kg), then that of the inertia (kg m²)."""
    blocks = np.zeros((len(scene.mass), 2, 3, 3))
    blocks[:, 0] = scene.mass[:, None, None] * np.eye(3)
    blocks[:, 1] = poses.frame * scene.inertia[:, None] @ poses.frame.transpose(0, 2, 1)
    return blocks
