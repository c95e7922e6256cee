"""What a built scene is, before it runs: masses, mobility, and what a run costs."""

import math
from typing import NamedTuple

import numpy as np

from fpm.elements.joints.joint import Joint, as_joints
from fpm.elements.kind import AXES
from fpm.scenes.effort import machine, run_seconds
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.scenes.timestep import stable_step

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
    """step (s) with its limiting element, number of steps, and of steps times elements; seconds of
    a core of this machine for one of eight runs side by side, without what is recorded."""

    step: float
    element: str
    steps: int
    element_steps: int
    seconds: float


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
    found, parts = jacobian(scene)
    rows = np.concatenate([np.zeros((0, 6 * parts)), *found.values()])
    rank = _rank(rows)
    return Mobility(parts, len(rows), len(rows) - rank, 6 * parts - rank)


def jacobian(scene: Scene) -> tuple[dict[str, np.ndarray], int]:
    """Conditions (c, 6 parts) on the parts' velocities and spins, by joint or support, and how many
    parts may move.

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

    rows: dict[str, np.ndarray] = {}
    names = {arm.particle: name for name, arm in scene.supports.items()}
    for particle in np.flatnonzero(scene.fixed.any(axis=1)):
        if own[particle] in moving:
            found = motion(particle, scene.position[particle])[scene.fixed[particle]]
            rows[f"support {names.get(particle, f'of particle {particle}')}"] = found
    for joint in _as_joints(scene):
        first = joint.beams[0].particle
        point = scene.position[first] + scene.frame[first] @ joint.beams[0].arm
        one = motion(first, point)
        if joint.type == "held":
            rows[f"support {joint.name}"] = one[[AXES.index(c) for c in joint.held]]
            continue
        second = joint.beams[1].particle
        gap = motion(second, point) - one
        axis, across = scene.frame[first] @ joint.axes[0], scene.frame[first] @ joint.references[0]
        other = scene.frame[second] @ joint.axes[1]
        plane = np.array([across, np.cross(axis, across)])
        points = plane if joint.type == "prismatic" else np.eye(3)
        turns = {
            "spherical": np.zeros((0, 3)),
            "revolute": plane,
            "universal": np.cross(axis, other)[None],
        }.get(joint.type, np.eye(3))
        rows[f"joint {joint.name}"] = np.concatenate([points @ gap[:3], turns @ gap[3:]])
    return rows, len(moving)


def _as_joints(scene: Scene) -> list[Joint]:
    """All joints of a scene, its hinges among them, whoever solves them."""
    hinges = [joint for hinge in scene.hinges for joint in as_joints(hinge)]
    return [*hinges, *scene.kinds.get(Joint, [])]


def _rank(rows: np.ndarray) -> int:
    sizes = np.linalg.svd(rows, compute_uv=False) if rows.size else np.zeros(1)
    return int((sizes > SMALLEST * sizes[0]).sum()) if sizes[0] > 0 else 0


def redundant(scene: Scene) -> list[str]:
    """Names of the joints and supports whose conditions depend on those of others.

    Rigid parts can only bear them if lengths and axes fit exactly; elastic ones give way.
    """
    rows, _ = jacobian(scene)
    if not rows:
        return []
    all_rows = np.concatenate(list(rows.values()))
    left, sizes, _ = np.linalg.svd(all_rows)
    rank = int((sizes > SMALLEST * sizes[0]).sum()) if sizes[0] > 0 else 0
    # Combinations of conditions that are nothing: whoever has a share in one is redundant.
    shares = np.linalg.norm(left[:, rank:], axis=1)
    ends = np.cumsum([len(r) for r in rows.values()])[:-1]
    parts = np.split(shares, ends)
    return [name for name, share in zip(rows, parts, strict=True) if share.max(initial=0.0) > 1e-6]


def longer_steps(found: SceneType, step: float) -> list[tuple[str, float, float]]:
    """The parameters by which a stable step (s) of the defaults grows most, at most three.

    Each with a value a tenth away, or half of a whole number, and how many times as long the step
    is there.
    """
    ways = []
    for name, parameter in found.parameters.items():
        value = parameter.default
        if not value or parameter.kind not in ("real", "integer"):
            continue
        whole = parameter.kind == "integer"
        for other in (max(value // 2, 1),) if whole else (0.9 * value, 1.1 * value):
            try:
                share = stable_step(found.build(**{name: other})).step / step
            except Exception:  # whatever a structure's own code says to a value of ours
                continue
            if 1.03 < share < np.inf:
                ways.append((name, other, share))
    return sorted(ways, key=lambda way: -way[2])[:3]


def cost(scene: Scene, duration: float, safety: float = 0.9) -> Cost:
    """What a run over `duration` (s) takes, at `safety` times the stable step."""
    limit = stable_step(scene)
    steps = max(1, math.ceil(duration / (safety * limit.step))) if limit.step < np.inf else 1
    seconds = machine() * run_seconds(scene, steps, 0)
    return Cost(limit.step, limit.element, steps, steps * len(scene.elements), seconds)
