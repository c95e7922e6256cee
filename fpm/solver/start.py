"""The motion with which a run begins: one that joints, motors and drives allow.

Theory: docs/mechanics.md, "Openings that are held exactly": of all velocities that fit, those at
which the impact changes the motion least (Gauss's principle; Moreau 1988). Friction bears no more
than a finite moment, and nothing in an impact, so it is no condition."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpm.assembly.conditions import Conditions, ParticlePoses, conditions_of
from fpm.assembly.matrices import dofs_of, saddle_solver
from fpm.elements.batch import turns_of
from fpm.elements.joints.turn import Turn
from fpm.elements.openings.opening import moving_at_start
from fpm.elements.reads import SceneList
from fpm.errors import SceneError

if TYPE_CHECKING:
    from fpm.scenes.scene import Scene

AGREES = 1e-12
"""Share of the fastest condition's rate by which a motion may deviate and is left as it is."""

CONTINUES = 1e-3
"""AGREES for a motion that nothing prescribes. That with which a run ended agrees to the second
order in its step only; to change it would be another motion, which does not lead back."""

EASE, ROUNDS = 1e-13, 30
"""By which redundant conditions are eased, and how often at most the equations are solved."""

MASS_RATIO = 1e6
"""How many times as heavy as another a body may be without a closer look."""

MIN_RANK_RATIO, REDUNDANT = 1e-8, 1e-24
"""Eigenvalues of the matrix of all conditions, its diagonal being one: above the first they are a
hundred times what eases the joints (EASE in joint.py), so that a first solution is accurate to 1 %,
and after the correction to 1e-4; below the second they are of conditions that others imply."""


def consistent_scene(scene: Scene) -> Scene:
    """Return the scene, or a copy with velocities that its joints, motors and drives allow at the
    start; where these contradict each other, those with the least error: joints gape then, and the
    run fails."""
    return consistent_scenes([scene])[0]


def consistent_scenes(scenes: Sequence[Scene]) -> list[Scene]:
    """Do as `consistent_scene` for several scenes; what they share is found once."""
    rates = list(SceneList(scenes).map(_rates_of))
    is_moved = [
        bool(scene.drives or any(rate for _, rate in pairs))
        or bool(scene.velocity.any() or scene.spin.any())
        for scene, pairs in zip(scenes, rates, strict=True)
    ]
    moving_scenes = [scene for scene, moves in zip(scenes, is_moved, strict=True) if moves]
    conditions = SceneList(moving_scenes).map(_conditions_at_start)
    return [
        _with_motion(scene, pairs, *next(conditions)) if moves else scene
        for scene, pairs, moves in zip(scenes, rates, is_moved, strict=True)
    ]


def _rates_of(scene: Scene) -> list[tuple]:
    """Return the hinges whose rates are prescribed, with these; the masses are checked."""
    check_masses(scene)
    # A hinge with a motor and a latch has only the motor's rate; the latch's is None.
    rates = [(scene.hinges[h.hinge], h.rate_at_start(scene)) for h in Turn.find(scene)]
    rates += [(scene.hinges[hinge], rate) for hinge, rate in scene.opening_rates.items()]
    return [(hinge, rate) for hinge, rate in rates if rate is not None]


def _conditions_at_start(scene: Scene) -> tuple[int, Any]:
    """Number of the conditions, and their derivatives, with those of rigid bars below them."""
    conditions = conditions_of(scene, [hinge.name for hinge, _ in _rates_of(scene)])
    rows = _rows(scene, conditions)
    if scene.opening_rates and scene.beams:
        from scipy.sparse import vstack

        rows = vstack([rows, _rigid_rows(scene)]).tocsr()
    return len(conditions.joint), rows


def _with_motion(scene: Scene, rates: list[tuple], count: int, rows: Any) -> Scene:
    """Return the scene with a motion that its first `count` rows, conditions, allow."""
    motion = moving_at_start(scene)
    velocities = np.hstack([motion.velocity, motion.spin]).ravel()
    target = np.zeros(rows.shape[0])
    # The condition on a slide is that its first point is not behind the second.
    target[count - len(rates) : count] = [-rate if h.slides else rate for h, rate in rates]
    residual = rows @ velocities - target
    fastest = (abs(rows) @ abs(velocities) + abs(target)).max(initial=0.0)
    is_led = any(rate for _, rate in rates) or bool(scene.drives)
    most = (AGREES if is_led else CONTINUES) * fastest
    if np.abs(residual).max(initial=0.0) <= most:
        return scene
    change = _least_change(scene, rows, residual, most)
    result = copy.copy(scene)
    result.velocity, result.spin = scene.velocity + change[:, :3], scene.spin + change[:, 3:]
    return result


def check_masses(scene: Scene) -> None:
    """Check that masses at joints are not too far apart for double precision; raises SceneError
    where light bodies between heavy ones would hide from joints how these move."""
    masses = scene.mass[~scene.fixed.all(axis=1)]
    if masses.max(initial=0.0) <= MASS_RATIO * masses.min(initial=np.inf):
        return
    rows = _scale_rows(scene, _rows(scene, conditions_of(scene)))[0]
    values = np.linalg.svd(rows.toarray(), compute_uv=False) ** 2
    if np.any((values > REDUNDANT) & (values < MIN_RANK_RATIO)):
        raise SceneError(
            "masses of joined bodies (kg)",
            [float(masses.min()), float(masses.max())],
            "masses less far apart: of bodies that join others, double precision resolves some "
            "1e-7 of these; give the lightest more mass, or join its neighbours without it",
        )


def _rows(scene: Scene, conditions: Conditions):
    """Sparse derivatives (c, 6n) of conditions at the start."""
    return conditions.jacobian(ParticlePoses(scene.position, scene.frame))


def _rigid_rows(scene: Scene):
    """Sparse derivatives (6m, 6n) of the rates by which m elements of bars deform: 0 where rates of
    openings are stated, as bars start as rigid bodies then."""
    from scipy.sparse import coo_array

    nodes = np.concatenate([beams.nodes for beams in scene.beams])
    chord = scene.position[nodes[:, 1]] - scene.position[nodes[:, 0]]
    first = np.tile(-np.eye(6), (len(nodes), 1, 1))
    first[:, :3, 3:] = np.cross(chord[:, None], np.eye(3)[None]).swapaxes(1, 2)
    blocks = np.concatenate([first, np.tile(np.eye(6), (len(nodes), 1, 1))], axis=2)
    columns = np.repeat(dofs_of(nodes), 6, axis=0)
    rows = np.repeat(np.arange(6 * len(nodes)), 12)
    shape = 6 * len(nodes), 6 * len(scene.position)
    return coo_array((blocks.ravel(), (rows, columns.ravel())), shape=shape)


def _scale_rows(scene: Scene, rows):
    """Rows of unit length, by motions times the roots of masses; inverse roots of the masses (6n,
    6n); and factors (c,), the length by which each row was divided."""
    from scipy.sparse import block_diag, diags

    free = ~scene.fixed
    linear = free[:, None, :3] * np.eye(3) / np.sqrt(scene.mass)[:, None, None]
    inertia = turns_of(scene).inertia
    inverse_root = (scene.frame / np.sqrt(inertia)[:, None, :]) @ np.swapaxes(scene.frame, 1, 2)
    rotation = free[:, 3:, None] * inverse_root
    blocks = np.stack([linear, rotation], axis=1).reshape(-1, 3, 3)
    root = block_diag(list(blocks), format="csc")
    rows = (rows @ root).tocsc()
    sizes = np.sqrt(rows.power(2).sum(axis=1))
    scale = np.divide(1.0, sizes, out=np.zeros(len(sizes)), where=sizes > 0)
    return (diags(scale) @ rows).tocsc(), root, scale


def _least_change(scene: Scene, rows, residual: np.ndarray, most: float) -> np.ndarray:
    """Change (n, 6) of velocities (m/s) and spins (rad/s), the least by masses, that changes rates
    of conditions by -residual. Where masses lie far apart, what joins light bodies says little
    about heavy ones: the unknowns are d times the root of M, and residuals are solved for again."""
    from scipy.sparse import identity

    rows, root, scale = _scale_rows(scene, rows)
    residual = scale * residual
    solve = saddle_solver(identity(root.shape[0]), rows, EASE)
    change, impulses = np.zeros(root.shape[0]), np.zeros(len(residual))
    for _ in range(ROUNDS):
        remainder = -residual - rows @ change
        if np.all(np.abs(remainder) <= most * scale):
            break
        correction = solve(np.concatenate([-change - rows.T @ impulses, remainder]))
        change, impulses = change + correction[: len(change)], impulses + correction[len(change) :]
    return (root @ change).reshape(-1, 6)
