"""What a built scene is, before it runs: masses, mobility, and what a run costs."""

import math
from typing import NamedTuple

import numpy as np

from fpm.kinds.kind import AXES
from fpm.scene import Scene
from fpm.timestep import stable_step

SMALLEST = 1e-9
"""Singular values below this share of the largest are zero: what a joint adds there is rounding."""


class Mobility(NamedTuple):
    """parts: rigid ones that are not held altogether; conditions: of joints, supports and drives;
    redundant: conditions that others imply; degrees: ways to move that are left, at the start.
    """

    parts: int
    conditions: int
    redundant: int
    degrees: int


class Cost(NamedTuple):
    """step (s) with its limiting element, number of steps, and of steps times elements."""

    step: float
    element: str
    steps: int
    element_steps: int


def bodies(scene: Scene) -> np.ndarray:
    """The part (n,) to which each particle belongs; beams make particles one part."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(scene.position)
    nodes = np.concatenate([np.zeros((0, 2), int), *(beams.nodes for beams in scene.beams)])
    links = coo_array((np.ones(len(nodes)), (nodes[:, 0], nodes[:, 1])), shape=(count, count))
    return connected_components(links, directed=False)[1]


def _counted(scene: Scene) -> np.ndarray:
    """Which particles (n,) are the structure's own: the ground's stands for no mass."""
    on_beams = np.zeros(len(scene.position), bool)
    for beams in scene.beams:
        on_beams[beams.nodes.ravel()] = True
    return on_beams | ~scene.fixed.all(axis=1)


def mass(scene: Scene) -> float:
    """Total mass, kg."""
    return float(scene.mass[_counted(scene)].sum())


def centre(scene: Scene) -> np.ndarray:
    """Centre of mass at the start (3,), m."""
    counted = _counted(scene)
    return scene.mass[counted] @ scene.position[counted] / scene.mass[counted].sum()


def mobility(scene: Scene) -> Mobility:
    """Ways in which the parts can move as rigid bodies, by the rank of the joints' Jacobian.

    Elastic bars are taken as rigid. The rank is that at the start; in a singular position, such as
    a mechanism that is folded flat, more ways are open than in the motion that follows.
    """
    rows, parts = jacobian(scene)
    if not rows.size:
        return Mobility(parts, len(rows), len(rows), 6 * parts)
    sizes = np.linalg.svd(rows, compute_uv=False)
    rank = int((sizes > SMALLEST * sizes[0]).sum()) if sizes[0] > 0 else 0
    return Mobility(parts, len(rows), len(rows) - rank, 6 * parts - rank)


def jacobian(scene: Scene) -> tuple[np.ndarray, int]:
    """Conditions (c, 6 parts) on the parts' velocities and spins, and how many parts may move.

    A part's columns are its velocity at the structure's middle, and its spin times the structure's
    size; parts that are held altogether have none.
    """
    own = bodies(scene)
    held = {own[p] for p in np.flatnonzero(scene.fixed.all(axis=1))}
    moving = {part: k for k, part in enumerate(p for p in range(own.max() + 1) if p not in held)}
    middle = scene.position.mean(axis=0)
    size = float(np.ptp(scene.position, axis=0).max()) or 1.0

    def motion(particle: int, point: np.ndarray) -> np.ndarray:
        """Velocity of a point and spin (6, 6 parts) of a particle's part."""
        out = np.zeros((6, 6 * len(moving)))
        if own[particle] in moving:
            at = 6 * moving[own[particle]]
            arm = (point - middle) / size
            out[:3, at : at + 3] = np.eye(3)
            out[:3, at + 3 : at + 6] = -np.cross(np.eye(3), arm)
            out[3:, at + 3 : at + 6] = np.eye(3)
        return out

    rows = []
    for particle in np.flatnonzero(scene.fixed.any(axis=1)):
        if own[particle] in moving:
            rows.append(motion(particle, scene.position[particle])[scene.fixed[particle]])
    for hinge in scene.hinges:
        one, two = hinge.particles
        point = scene.position[one] + scene.frame[one] @ hinge.beams[0].arm
        axis = scene.frame[one] @ hinge.axes[0]
        across = np.linalg.svd(axis[None])[2][1:]
        first, second = motion(one, point), motion(two, point)
        gap = second - first
        rows += [gap[:3], across @ gap[3:], first[[AXES.index(c) for c in hinge.support]]]
    return np.concatenate([np.zeros((0, 6 * len(moving))), *rows]), len(moving)


def cost(scene: Scene, duration: float, safety: float = 0.9) -> Cost:
    """What a run over `duration` (s) takes, at `safety` times the stable step."""
    limit = stable_step(scene)
    steps = max(1, math.ceil(duration / (safety * limit.step))) if limit.step < np.inf else 1
    return Cost(limit.step, limit.element, steps, steps * len(scene.elements))
