"""Momenta of a whole scene, from the tracks of named points: what free bodies must keep."""

import numpy as np

import fpm


def watch(scene: fpm.Scene, particles=None) -> None:
    """Name four points per particle: its place and the tips of three unit arms along its axes."""
    for p in range(len(scene.position)) if particles is None else particles:
        scene.add_point(f"{p}", p)
        for axis in range(3):
            tip = scene.position[p] + scene.frame[p][:, axis]
            scene.add_point(f"{p} {'xyz'[axis]}", p, tip)


def motion(outcome: fpm.Outcome, p: int):
    """Position (t, 3), velocity (t, 3), axes (t, 3, 3) as columns and spin (t, 3) of particle p."""
    position, velocity = outcome.points[f"{p}"]
    arms = [outcome.points[f"{p} {axis}"] for axis in "xyz"]
    frame = np.stack([x - position for x, _ in arms], axis=2)
    rates = np.stack([v - velocity for _, v in arms], axis=2)
    # A rate is spin x arm, and the sum of arm x (spin x arm) over an orthonormal triad twice spin.
    spin = 0.5 * np.cross(frame, rates, axis=1).sum(axis=2)
    return position, velocity, frame, spin


def momenta(outcome: fpm.Outcome) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Linear and angular momentum about the origin (t, 3), and the centre of mass (t, 3)."""
    scene = outcome.scene
    linear = angular = first = 0.0
    for p, (mass, inertia) in enumerate(zip(scene.mass, scene.inertia, strict=True)):
        position, velocity, frame, spin = motion(outcome, p)
        local = np.einsum("tji,tj->ti", frame, spin)
        first = first + mass * position
        linear = linear + mass * velocity
        angular = angular + mass * np.cross(position, velocity)
        angular = angular + np.einsum("tij,tj->ti", frame, inertia * local)
    return linear, angular, first / scene.mass.sum()


def drift(values: np.ndarray, scale: float | None = None) -> float:
    """Largest distance of rows (t, 3) from the first one, as a share of its length (or scale)."""
    scale = np.linalg.norm(values[0]) if scale is None else scale
    return float(np.linalg.norm(values - values[0], axis=1).max() / scale)
