"""Openings of hinges: the angles that springs, contacts and their like act on.

An opening is the angle about a hinge's axis between a reference direction of either particle. It
grows when the second turns by the right-hand rule about the axis against the first, and it counts
full turns: of all angles that differ by them it is the one closest to the last.
"""

from dataclasses import dataclass

import numpy as np

from fpm.errors import SceneError
from fpm.kinds.kind import Deformations, Kind, Recorded, rows_of


@dataclass(frozen=True)
class Opening(Kind):
    """The opening of a hinge; nothing states it, every hinge of a scene has one, with its index."""

    @classmethod
    def of(cls, scene):
        return scene.hinges

    @classmethod
    def topology_of(cls, scene):
        """Names and particles of all hinges, as openings go by their index."""
        return tuple((hinge.name, hinge.particles) for hinge in scene.hinges)

    @classmethod
    def pack(cls, batch):
        from fpm.kinds.opening_kernels import SIDE, Openings

        hinges = batch.one.hinges
        rows = batch.instants + 1
        return Openings(
            ends=batch.integers(p for hinge in hinges for p in hinge.particles),
            sides=batch.stack(2 * len(hinges), SIDE, _sides),
            angles=batch.table(cls, 2, lambda hinge: [hinge.opening] * 2),
            followed=batch.is_read(cls),
            track=batch.blank(rows * len(hinges), 1),
        )

    @classmethod
    def recorded(cls, part, scene, lane):
        """The openings."""
        names = tuple(hinge.name for hinge in scene.hinges)
        values = part.track[:, 0, lane].reshape(-1, len(names))
        return {"opening": Recorded(values, "rad", "opening of the hinges", "hinge", names)}


def _sides(scene) -> np.ndarray:
    """Axis and reference (2h, 6) of either side of every hinge."""
    sides = [np.hstack([hinge.axes, hinge.references]) for hinge in scene.hinges]
    return np.concatenate(sides)


def relative_turn(scene, on, stiffness) -> Deformations:
    """The deformations of elements that are strained by the openings `on` (indices)."""
    hinges, zero = [scene.hinges[h] for h in on], np.zeros(3)
    values = [np.concatenate([zero, -h.axes[0], zero, h.axes[1]]) for h in hinges]
    return rows_of([h.particles for h in hinges], values, stiffness)


def check_stiffness(scene, what: str, hinge: int, stiffness: float) -> None:
    """SceneError unless `what` of a stiffness (N m/rad) can act on a hinge of that index."""
    check_hinge(scene, what, hinge)
    if not (np.isfinite(stiffness) and stiffness >= 0):
        raise SceneError(f"{what} stiffness", stiffness, "a finite number >= 0 (N m/rad)")


def check_hinge(scene, what: str, hinge: int) -> None:
    """SceneError unless there is a hinge of that index for `what`."""
    count = len(scene.hinges)
    if not 0 <= hinge < count:
        raise SceneError(f"hinge of {what}", hinge, f"0 to {count - 1}")


def opening_angle(axis, first, second, near: float) -> float:
    """Angle (rad) from `first` to `second` about `axis`, on the turn closest to `near`."""
    angle = np.arctan2(np.dot(axis, np.cross(first, second)), np.dot(first, second))
    return float(angle + 2 * np.pi * np.round((near - angle) / (2 * np.pi)))
