"""What a built scene is, before it runs: masses, mobility, and what sets its step."""

from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses, conditions_of, dependence
from fpm.elements.bars.beam import Beams
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.scenes.timestep import find_stable_step


class Mobility(NamedTuple):
    """Counts of a mechanism at its start, bars taken as rigid. parts: rigid ones that can move;
    conditions: scalar constraints of joints, supports and drives, redundant ones included;
    redundant: those that others imply; degrees: of freedom, 6 parts - conditions + redundant."""

    parts: int
    conditions: int
    redundant: int
    degrees: int


def bodies(scene: Scene) -> np.ndarray:
    """Return the index of the rigid body that each particle is part of, (n,) from 0, where elastic
    bars are taken as rigid: all particles that beams join are one body."""
    ends = np.concatenate([np.zeros((0, 2), int), *(beams.nodes for beams in scene.beams)]).T
    first, last = np.arange(len(scene.position)), None  # of each body's particles, the first
    while last is None or (first != last).any():  # scipy's graphs take 0.1 s to load
        last = first.copy()
        for nodes in ends:
            np.minimum.at(first, last[nodes], last[ends].min(axis=0))
        first = first[first]
    return np.unique(first, return_inverse=True)[1]


def _mask_particles(scene: Scene) -> np.ndarray:
    """Return which particles (n,) belong to the structure, not the ground."""
    is_part = np.zeros(len(scene.position), bool)
    is_part[list(scene.bodies.values())] = True
    for beams in scene.beams:
        is_part[beams.nodes.ravel()] = True
    return is_part | ~scene.fixed.all(axis=1)


def mass(scene: Scene) -> float:
    """Return the mass (kg) of a scene's structure: all particles but the ground, those held
    altogether that are no named body and on no bar."""
    return float(scene.mass[_mask_particles(scene)].sum())


def kinetic_energy(scene: Scene, velocity: np.ndarray, spin: np.ndarray) -> float:
    """Return the kinetic energy (J) at velocities (n, 3), m/s, and spins (n, 3), rad/s."""
    body_spin = np.einsum("nji,nj->ni", scene.frame, spin)
    return float((scene.mass @ velocity**2).sum() + (scene.inertia * body_spin**2).sum()) / 2


def centre(scene: Scene) -> np.ndarray:
    """Return a scene's centre of mass (3,), m, at the start, without the ground (as in `mass`)."""
    particles = _mask_particles(scene)
    return scene.mass[particles] @ scene.position[particles] / scene.mass[particles].sum()


def mobility(scene: Scene) -> Mobility:
    """Return the Mobility of a scene at the start, by the rank of its constraints, with bars as
    rigid. In a singular position, as of a mechanism folded flat, there are more freedoms than in
    the motion."""
    rows, _ = jacobian(scene)
    rank, count = dependence(rows)[0], rows.shape[1]
    return Mobility(count // 6, len(rows), len(rows) - rank, count - rank)


def jacobian(scene: Scene) -> tuple[np.ndarray, list[str]]:
    """Return the Jacobian (c, 6 b) of a scene's scalar constraints by the motions of its b moving
    rigid bodies (bars as rigid), velocity of its point at the mean of all particles and angular
    velocity times the size, and names (c), as "joint knee"; rows of angles times the size, too."""
    numbers, rules, count = bodies(scene), conditions_of(scene), len(scene.position)
    is_fixed = np.isin(numbers, numbers[scene.fixed.all(axis=1)])
    moving = np.unique(numbers[~is_fixed])
    size = float(np.ptp(scene.position, axis=0).max()) or 1.0
    motion = np.zeros((count, 6, len(moving), 6))  # of particles, by those of their parts
    for particle in np.flatnonzero(~is_fixed):
        block = motion[particle, :, np.searchsorted(moving, numbers[particle])]
        arm = scene.position[particle] - scene.position.mean(axis=0)
        block[:3, :3], block[3:, 3:] = np.eye(3), np.eye(3) / size
        block[:3, 3:] = -np.cross(np.eye(3), arm) / size
    motions = motion.reshape(6 * count, 6 * len(moving))
    slopes = rules.jacobian(ParticlePoses(scene.position, scene.frame))
    joints = size * rules.weight(size)[:, None] * (slopes @ motions)
    fixed = np.argwhere(scene.fixed & ~is_fixed[:, None])
    dofs = fixed @ (6, 1)
    supports = np.where(dofs % 6 < 3, 1.0, size)[:, None] * motions[dofs]
    support_names = {arm.particle: name for name, arm in scene.supports.items()}
    names = [f"support {support_names.get(p, f'of particle {p}')}" for p, _ in fixed]
    kinds = np.where(rules.is_on_second == 0, "support", "joint")
    names += [f"{kind} {name}" for kind, name in zip(kinds, rules.joint, strict=True)]
    return np.concatenate([supports, joints]), names


def redundant(scene: Scene) -> list[str]:
    """Return the names of joints and supports with a constraint that others imply at the start."""
    rows, names = jacobian(scene)
    shares = dependence(rows)[1]
    return list(dict.fromkeys(n for n, size in zip(names, shares, strict=True) if size > 1e-6))


def undamped_step(scene: Scene) -> float:
    """Return the stable step (s) of a scene without stiffness damping; inf: no limit."""
    plain = copy(scene)
    materials = [replace(beams.material, stiffness_damping=0.0) for beams in scene.beams]
    pairs = zip(scene.beams, materials, strict=True)
    plain.kinds = {**scene.kinds, Beams: [replace(beams, material=m) for beams, m in pairs]}
    return find_stable_step(plain).step


def longer_steps(structure: SceneType, step: float) -> list[tuple[str, float, float]]:
    """Return up to three parameter changes that lengthen a structure's stable step most, as advice:
    (parameter, value tried, ratio to `step`, > 1.03), the largest ratio first. step: the stable
    step (s) at default values. Tried: 10 % below and above the default; of whole numbers, half."""
    changes = []
    for name, parameter in structure.parameters.items():
        value = parameter.default
        if not value:
            continue
        for trial in (max(value // 2, 1),) if parameter.is_whole else (0.9 * value, 1.1 * value):
            try:
                ratio = find_stable_step(structure.build(**{name: trial})).step / step
            except Exception:  # whatever a structure's own code says to a value of ours
                continue
            if 1.03 < ratio < np.inf:
                changes.append((name, trial, ratio))
    return sorted(changes, key=lambda change: -change[2])[:3]
