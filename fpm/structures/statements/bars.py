"""Elastic bars, straight or through points."""

from itertools import pairwise

import numpy as np

from fpm.elements.bars.beam import triad
from fpm.elements.bars.lumping import lump
from fpm.structures.builder import Part
from fpm.structures.keys import Direction, Each, Many, Number, Reference, Whole
from fpm.structures.statement import statement

STRAIGHT = 1e-9
"""Directions (unit vectors) that differ by less are one."""


@statement(
    "bars",
    through=Many(kind=Reference(group="points"), least=2, about="its points, in order"),
    section=Reference(group="sections", about="its cross-section"),
    material=Reference(group="materials", about="its material"),
    elements=Whole(about="beam elements of each stretch between two points"),
    up=Direction(None, "where the section's height points; needed where it matters"),
    carries=Each(
        None,
        "points off its axis, each rigidly held at one of its points",
        group="points",
        kind=Reference(group="points"),
    ),
    inertia_scale=Number(1.0, "factor on the section's rotational inertia", least=1),
)
def bar(build, it):
    """An elastic bar through points, each stretch between two of them straight."""
    names = [point.name for point in it.through]
    points = [point.position for point in it.through]
    directions = _directions(build, names, points)
    up = _up(build, it, directions)
    lay = _straight if len(points) == 2 else _stretches
    nodes = lay(build.scene, it, points, directions, up)
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


def _straight(scene, it, points, directions, up) -> list[int]:
    """A bar between two points; the particles at both."""
    link = scene.add_link(
        *points, up, it.section, it.material, it.elements, it.name, it.inertia_scale
    )
    return [int(link.particles[0]), int(link.particles[-1])]


def _stretches(scene, it, points, directions, up) -> list[int]:
    """A bar through more points, stretch by stretch; the particles at the points.

    Each stretch is lumped by itself (kinds/lumping.py); where two meet, masses and inertias add.
    """
    axes = [triad(direction, up) for direction in directions]
    lumped = [
        lump(np.linalg.norm(end - start), it.elements, it.section, it.material, it.inertia_scale)
        for start, end in pairwise(points)
    ]
    nodes: list[int] = []
    inner = np.zeros(0, int)
    steps = np.linspace(0.0, 1.0, it.elements + 1)[1:-1, None]
    for k, point in enumerate(points):
        # The end of the stretch before, and the start of the one after.
        ends = [(*lumped[j], axes[j], i) for j, i in ((k - 1, -1), (k, 0)) if 0 <= j < len(axes)]
        inertia, frame = _joined([(inertias[i], own) for _, inertias, own, i in ends])
        node = scene.add_particles(
            point, sum(masses[i] for masses, _, _, i in ends), inertia, frame
        )
        if k:
            line = np.array([nodes[-1], *inner, node[0]])
            label = f"{it.name} from {it.through[k - 1].name.rpartition('.')[2]}"
            pairs = np.column_stack([line[:-1], line[1:]])
            scene.add_beams(pairs, it.section, it.material, up, label)
        nodes.append(int(node[0]))
        if k < len(axes):
            masses, inertias = lumped[k]
            along = point + steps * (points[k + 1] - point)
            if len(along):  # none in a stretch of one element
                inner = scene.add_particles(along, masses[1:-1], inertias[1:-1], axes[k])
    return nodes


def _joined(parts) -> tuple[np.ndarray, np.ndarray]:
    """Principal inertias (3,) and axes (3, 3) of inertias that add up, each in its own axes."""
    if len(parts) == 1 or np.abs(parts[0][1] - parts[1][1]).max() < STRAIGHT:
        return sum(inertia for inertia, _ in parts), parts[0][1]
    values, frame = np.linalg.eigh(sum(frame * inertia @ frame.T for inertia, frame in parts))
    frame[:, 2] = np.cross(frame[:, 0], frame[:, 1])
    return values, frame
