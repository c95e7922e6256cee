"""Joints: what parts share where they meet."""

from itertools import pairwise

import numpy as np

from fpm.kinds.hinge import unit
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
    """The particles of a joint's parts and the point where they meet (3,); for every joint."""
    each = it.at if isinstance(it.at, dict) else {part.name: it.at for part in it.parts}
    names = [part.name for part in it.parts]
    if each.keys() != set(names):
        build.refuse("at", list(each), f"a point for each of {', '.join(names)}")
    points = [each[name] for name in names]
    particles = [part.particle(p.name) for part, p in zip(it.parts, points, strict=True)]
    for (one, two), (p, q) in zip(pairwise(names), pairwise(points), strict=True):
        gap = float(np.linalg.norm(p.position - q.position))
        if not gap <= APART * build.size:
            build.refuse(
                "at", f"{p.name} of {one} and {q.name} of {two}, {gap:.6g} m apart",
                f"points that coincide to {APART * build.size:.2g} m", gap,
            )  # fmt: skip
    for particle in particles:
        build.joined.setdefault(particle, []).append(it.name)
    return particles, points[0].position


@statement(
    "joints",
    "revolute",
    parts=PARTS,
    at=AT,
    axis=Direction(about="of the turn"),
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
    particles, point = meet(build, it)
    references = it.references
    if references is not None:
        names = [part.name for part in it.parts]
        if references.keys() != set(names):
            build.refuse("references", list(references), f"one for each of {', '.join(names)}")
        references = [_across(build, references[name], it.axis) for name in names]
    scene = build.scene
    pair = particles[:2]
    hinge = scene.add_hinge(it.name, pair, point, it.axis, references, it.opening, it.held)
    for part, particle in zip(it.parts[2:], particles[2:], strict=True):
        scene.add_hinge(f"{it.name}_{_own(part)}", (particles[0], particle), point, it.axis)
    return hinge


def _own(part) -> str:
    """A part's name without that of its unit."""
    return part.name.rpartition(".")[2]


def _join(build, it, type: str, axis=(1.0, 0.0, 0.0), other=None) -> None:
    """Join all parts to the first."""
    particles, point = meet(build, it)
    for k, (part, particle) in enumerate(zip(it.parts[1:], particles[1:], strict=True)):
        name = f"{it.name}_{_own(part)}" if k else it.name
        build.scene.add_joint(name, type, (particles[0], particle), point, axis, other)


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
)
def universal(build, it):
    """Cardan's joint: parts share a point, and a cross about two axes that stay normal."""
    if abs(it.axis @ it.other) > 1e-6:
        build.refuse("other", it.other.tolist(), f"a direction normal to {it.axis.tolist()}")
    other = unit(it.other - (it.axis @ it.other) * it.axis, "other")
    _join(build, it, "universal", it.axis, other)


@statement(
    "joints",
    "prismatic",
    parts=PAIR,
    at=AT,
    axis=Direction(about="along which the second part slides on the first"),
)
def prismatic(build, it):
    """A slider: the second part moves along an axis of the first, and does not turn on it."""
    _join(build, it, "prismatic", it.axis)


def _across(build, reference, axis) -> np.ndarray:
    """A reference without the rounding along the axis."""
    along = float(reference @ axis)
    if abs(along) > 1e-6:
        build.refuse("references", reference.tolist(), "directions normal to the axis")
    return unit(reference - along * axis, "reference")
