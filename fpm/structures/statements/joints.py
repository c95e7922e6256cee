"""Joints: what parts share where they meet."""

from itertools import pairwise

import numpy as np

from fpm.elements.joints.hinge import unit
from fpm.structures.builder import APART
from fpm.structures.keys import Direction, Each, Either, Letters, Many, Number, Part, Reference
from fpm.structures.statement import statement

PARTS = Many(kind=Part(ground=True), least=2, about="what it joins")
AT = Either(
    about="its point, which all parts have; or the point of each part, which must coincide",
    kind=Reference(group="points"),
    each=Each(group="parts", kind=Reference(group="points")),
)


def meet(build, it) -> tuple[list[int], np.ndarray]:
    """The particles of a joint's parts, and their points there (k, 3); for every joint."""
    each = it.at if isinstance(it.at, dict) else {part.name: it.at for part in it.parts}
    names = [part.name for part in it.parts]
    if each.keys() != set(names):
        build.refuse("at", list(each), f"a point for each of {', '.join(names)}")
    points = [each[name] for name in names]
    particles = [part.particle(p.name) for part, p in zip(it.parts, points, strict=True)]
    for (one, two), (p, q) in zip(pairwise(names), pairwise(points), strict=True):
        gap = float(np.linalg.norm(p.position - q.position))
        if not gap <= APART * build.size and build.hold is None:
            build.refuse(
                "at", f"{p.name} of {one} and {q.name} of {two}, {gap:.6g} m apart",
                f"points that coincide to {APART * build.size:.2g} m, or `assemble: true`", gap,
            )  # fmt: skip
    for particle in particles:
        build.joined.setdefault(particle, []).append(it.name)
    if build.hold is None:  # what is apart by rounding meets at the first part's point
        points = points[:1] * len(points)
    return particles, np.array([point.position for point in points])


def axes_of(build, it) -> np.ndarray:
    """The axis of a revolute joint for each of its parts (k, 3)."""
    names = [part.name for part in it.parts]
    if not isinstance(it.axis, dict):
        return np.tile(it.axis, (len(names), 1))
    if it.axis.keys() != set(names):
        build.refuse("axis", list(it.axis), f"one for each of {', '.join(names)}")
    axes = np.array([it.axis[name] for name in names])
    apart = float(np.abs(axes - axes[0]).max())
    if apart > APART and build.hold is None:
        build.refuse("axis", axes.tolist(), "axes that agree, or `assemble: true`", apart)
    return axes if build.hold is not None else np.tile(axes[0], (len(names), 1))


@statement(
    "joints",
    "revolute",
    parts=PARTS,
    at=AT,
    axis=Either(
        about="of the turn; or the axis of each part, which must agree",
        kind=Direction(),
        each=Each(group="parts", kind=Direction()),
    ),
    opening=Number(
        0.0,
        "angle at the start; grows as the second part turns about the axis against the "
        "first, by the right-hand rule",
        unit="rad",
    ),
    references=Each(
        None,
        "a direction fixed to each part, normal to the axis: the opening is their angle, "
        "on the turn closest to `opening`",
        group="parts",
        kind=Direction(),
    ),
    held=Letters("", "axes along which the point is held, as by a slider"),
)
def revolute(build, it):
    """A hinge: parts share a point and an axis, and turn freely about it.

    The opening is that of the first two parts. Further ones are hinged to the first.
    """
    particles, points = meet(build, it)
    axes, references = axes_of(build, it), it.references
    if references is not None:
        names = [part.name for part in it.parts]
        if references.keys() != set(names):
            build.refuse("references", list(references), f"one for each of {', '.join(names)}")
        references = [
            _across(build, references[name], axis) for name, axis in zip(names, axes, strict=True)
        ]
    scene = build.scene
    pair = particles[:2]
    hinge = scene.add_hinge(it.name, pair, points[:2], axes[:2], references, it.opening, it.held)
    for k in range(2, len(particles)):
        both = [0, k]
        name, pair = f"{it.name}_{_own(it.parts[k])}", (particles[0], particles[k])
        scene.add_hinge(name, pair, points[both], axes[both])
    return hinge


def _own(part) -> str:
    """A part's name without that of its unit."""
    return part.name.rpartition(".")[2]


def _join(build, it, type: str) -> None:
    """Join all parts to the first."""
    particles, points = meet(build, it)
    for k in range(1, len(particles)):
        name = f"{it.name}_{_own(it.parts[k])}" if k > 1 else it.name
        pair = (particles[0], particles[k])
        build.scene.add_joint(name, type, pair, points[[0, k]])


@statement("joints", "spherical", parts=PARTS, at=AT)
def spherical(build, it):
    """A ball and socket: parts share a point."""
    _join(build, it, "spherical")


@statement("joints", "fixed", parts=PARTS, at=AT)
def fixed(build, it):
    """Parts that neither move nor turn against each other there."""
    _join(build, it, "fixed")


PAIR = Many(kind=Part(ground=True), least=2, most=2, about="what it joins")


@statement(
    "joints",
    "universal",
    parts=PAIR,
    at=AT,
    axis=Direction(about="of the cross, on the first part"),
    other=Direction(about="axis of the cross on the second part, normal to that on the first"),
    openings=Many(
        None,
        "its angles at the start: of the cross about `axis` against the first part, and of the "
        "second part about `other` against the cross; left out: 0",
        kind=Number(unit="rad"), least=2, most=2,
    ),
)  # fmt: skip
def universal(build, it):
    """Cardan's joint: parts share a point, and a cross about two axes that stay normal."""
    if abs(it.axis @ it.other) > 1e-6:
        build.refuse("other", it.other.tolist(), f"a direction normal to {it.axis.tolist()}")
    other = unit(it.other - (it.axis @ it.other) * it.axis, "other")
    particles, points = meet(build, it)
    openings = it.openings or (0.0, 0.0)
    return build.scene.add_universal(it.name, particles, points, it.axis, other, openings)


@statement(
    "joints",
    "prismatic",
    parts=PAIR,
    at=AT,
    axis=Direction(about="along which the second part slides on the first"),
    opening=Number(
        0.0,
        "position at the start; grows as the second part slides along the axis against the first",
        unit="m",
    ),
)
def prismatic(build, it):
    """A slider: the second part moves along an axis of the first, and does not turn on it."""
    particles, points = meet(build, it)
    return build.scene.add_slide(it.name, particles, points, it.axis, it.opening)


def _across(build, reference, axis) -> np.ndarray:
    """A reference without the rounding along the axis."""
    along = float(reference @ axis)
    if abs(along) > 1e-6:
        build.refuse("references", reference.tolist(), "directions normal to the axis")
    return unit(reference - along * axis, "reference")
