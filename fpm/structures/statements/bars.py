"""Elastic bars, straight or through points."""

from itertools import pairwise

import numpy as np

from fpm.elements.beam import triad
from fpm.elements.lumping import lump
from fpm.structures.builder import Part
from fpm.structures.keys import Direction, Each, Many, Number, Reference, Whole
from fpm.structures.statement import Statement

STRAIGHT = 1e-9
"""Directions (unit vectors) that differ by less are one."""


class Bar(Statement):
    """An elastic bar through points, each stretch between two of them straight."""

    group = "bars"
    keys = {
        "through": Many(kind=Reference(group="points"), least=2, about="its points, in order"),
        "section": Reference(group="sections", about="its cross-section"),
        "material": Reference(group="materials", about="its material"),
        "elements": Whole(about="beam elements of each stretch between two points"),
        "up": Direction(None, "where the section's height points; needed where it matters"),
        "carries": Each(
            None, "points off its axis, each rigidly held at one of its points",
            group="points", kind=Reference(group="points"),
        ),
        "inertia_scale": Number(1.0, "factor on the section's rotational inertia", least=1),
    }  # fmt: skip

    @staticmethod
    def build(build, it):
        names = [point.name for point in it.through]
        points = [point.position for point in it.through]
        directions = _directions(build, names, points)
        up = _up(build, it, directions)
        axes = [triad(direction, up) for direction in directions]
        nodes = _particles(build, it, points, axes)
        for stretch, (first, last) in enumerate(pairwise(nodes)):
            # One call for each stretch; the inner particles follow one another.
            inner = build.inner[it.name, stretch]
            line = np.array([first, *inner, last])
            ends = np.column_stack([line[:-1], line[1:]])
            label = it.name if len(nodes) == 2 else f"{it.name} {names[stretch]}"
            build.scene.add_beams(ends, it.section, it.material, up, label)
        particles = dict(zip(names, nodes, strict=True))
        for point, holder in (it.carries or {}).items():
            if holder.name not in particles:
                build.refuse(f"carries.{point}", holder.name, f"one of {', '.join(names)}")
            if point in particles:
                build.refuse("carries", point, "points that the bar does not go through")
            particles[point] = particles[holder.name]
        return Part(it.name, particles)


def _directions(build, names, points) -> list[np.ndarray]:
    """Unit vectors of the stretches; what is straight has one direction to the last digit."""
    found: list[np.ndarray] = []
    for (one, two), (start, end) in zip(pairwise(names), pairwise(points), strict=True):
        length = np.linalg.norm(end - start)
        if not 0 < length < np.inf:
            build.refuse("through", length, f"a length above 0 m from {one} to {two}")
        direction = (end - start) / length
        same = found and np.abs(direction - found[-1]).max() < STRAIGHT
        found.append(found[-1] if same else direction)
    return found


def _up(build, it, directions) -> np.ndarray:
    """The vector in the plane of the section's height; a choice of ours where it is no matter."""
    if it.up is not None:
        along = max(abs(direction @ it.up) for direction in directions)
        if along > 1 - 1e-12:
            build.refuse("up", it.up.tolist(), "a direction that is not the bar's own")
        return it.up
    if it.section.Iy != it.section.Iz:
        build.refuse("up", None, "the direction in which the section's height points")
    across = [max(abs(direction[k]) for direction in directions) for k in (2, 0, 1)]
    return np.eye(3)[(2, 0, 1)[int(np.argmin(across))]]


def _particles(build, it, points, axes) -> list[int]:
    """Add all particles, stretch by stretch; the indices of those at the points.

    Each stretch is lumped by itself (elements/lumping.py); where two meet, masses and inertias add.
    """
    scene, count = build.scene, len(axes)
    lumped = [
        lump(np.linalg.norm(end - start), it.elements, it.section, it.material, it.inertia_scale)
        for start, end in pairwise(points)
    ]
    nodes = []
    for k in range(count + 1):
        ends = [(lumped[j], j, i) for j, i in ((k - 1, -1), (k, 0)) if 0 <= j < count]
        mass = sum(masses[i] for (masses, _), _, i in ends)
        inertia, frame = _joined([(inertias[i], axes[j]) for (_, inertias), j, i in ends])
        nodes.append(int(scene.add_particles(points[k], mass, inertia, frame)[0]))
        if k < count:
            steps = np.linspace(0.0, 1.0, it.elements + 1)[1:-1, None]
            along = points[k] + steps * (points[k + 1] - points[k])
            masses, inertias = lumped[k]
            added = scene.add_particles(along, masses[1:-1], inertias[1:-1], axes[k])
            build.inner[it.name, k] = added
    return nodes


def _joined(parts) -> tuple[np.ndarray, np.ndarray]:
    """Principal inertias (3,) and axes (3, 3) of inertias that add up, each in its own axes."""
    if len(parts) == 1 or np.abs(parts[0][1] - parts[1][1]).max() < STRAIGHT:
        return sum(inertia for inertia, _ in parts), parts[0][1]
    values, frame = np.linalg.eigh(sum(frame * inertia @ frame.T for inertia, frame in parts))
    frame[:, 2] = np.cross(frame[:, 0], frame[:, 1])
    return values, frame
