"""Joints: what parts share where they meet; and supports, which hold points of them."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from fpm.elements.joints.hinge import unit
from fpm.structures.builder import APART
from fpm.structures.keys import Direction, Each, Letters, Many, Number, Reference
from fpm.structures.statement import statement

PART = Reference(group="parts", ground=True)
PARTS = Many(kind=PART, least=2, text="what it joins")
PAIR = Many(kind=PART, least=2, most=2, text="what it joins")
AT = Each(
    text="its point, which all parts have; or the point of each part, which must coincide",
    kind=Reference(group="points"),
    one=True,
)


def _each(build, it, key: str, what: str) -> list:
    """The values of a key for each of a joint's parts, stated for each or one for all."""
    value, names = getattr(it, key), [part.name for part in it.parts]
    if not isinstance(value, dict):
        return [value] * len(names)
    if value.keys() != set(names):
        build.refuse(key, list(value), f"{what} for each of {', '.join(names)}")
    return [value[name] for name in names]


def _meet(build, it) -> tuple[list[int], np.ndarray]:
    """The particles of a joint's parts, and their points there (k, 3); for every joint."""
    points = _each(build, it, "at", "a point")
    particles = [part.particle(p.name) for part, p in zip(it.parts, points, strict=True)]
    for (one, p), (two, q) in pairwise(zip(it.parts, points, strict=True)):
        gap = float(np.linalg.norm(p.position - q.position))
        if not gap <= APART * build.size and build.hold is None:
            found = f"{p.name} of {one.name} and {q.name} of {two.name}, {gap:.6g} m apart"
            allowed = f"points that coincide to {APART * build.size:.2g} m, or `assemble: true`"
            build.refuse("at", found, allowed)
    for particle in particles:
        build.joined.setdefault(particle, []).append(it.name)
    if build.hold is None:  # what is apart by rounding meets at the first part's point
        points = points[:1] * len(points)
    return particles, np.array([point.position for point in points])


def _axes(build, it) -> np.ndarray:
    """The axis of a revolute joint for each of its parts (k, 3)."""
    axes = np.array(_each(build, it, "axis", "one"))
    apart = float(np.abs(axes - axes[0]).max())
    if apart > APART and build.hold is None:
        build.refuse("axis", axes.tolist(), "axes that agree, or `assemble: true`")
    return axes if build.hold is not None else np.tile(axes[0], (len(axes), 1))


def _further(it, particles) -> Iterator[tuple[str, tuple[int, int], list[int]]]:
    """Name and particles of joints of the first part with those after the second, and their places
    among the parts."""
    for k in range(2, len(particles)):
        own = it.parts[k].name.rpartition(".")[2]  # without that of its unit
        yield f"{it.name}_{own}", (particles[0], particles[k]), [0, k]


@statement(
    "joints",
    "revolute",
    parts=PARTS,
    at=AT,
    axis=Each(
        text="of the turn; or the axis of each part, which must agree",
        kind=Direction(),
        one=True,
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
        kind=Direction(),
    ),
    held=Letters("", "axes along which the point is held, as by a slider"),
)
def revolute(build, it):
    """A hinge: parts share a point and an axis, and turn freely about it.

    The opening is that of the first two parts. Further ones are hinged to the first.
    """
    particles, points = _meet(build, it)
    axes, references, scene = _axes(build, it), it.references, build.scene
    if references is not None:
        references = _each(build, it, "references", "one")
        references = [_across(build, *pair) for pair in zip(references, axes, strict=True)]
    pair = particles[:2]
    hinge = scene.add_hinge(it.name, pair, points[:2], axes[:2], references, it.opening, it.held)
    for name, pair, both in _further(it, particles):
        scene.add_hinge(name, pair, points[both], axes[both])
    return hinge


def _across(build, reference, axis) -> np.ndarray:
    """A reference without the rounding along the axis."""
    along = float(reference @ axis)
    if abs(along) > 1e-6:
        build.refuse("references", reference.tolist(), "directions normal to the axis")
    return unit(reference - along * axis, "reference")


def _join(build, it, type: str) -> None:
    """Join all parts to the first."""
    particles, points = _meet(build, it)
    build.scene.add_joint(it.name, type, particles[:2], points[:2])
    for name, pair, both in _further(it, particles):
        build.scene.add_joint(name, type, pair, points[both])


@statement("joints", "spherical", parts=PARTS, at=AT)
def spherical(build, it):
    """A ball and socket: parts share a point."""
    _join(build, it, "spherical")


@statement("joints", "fixed", parts=PARTS, at=AT)
def fixed(build, it):
    """Parts that neither move nor turn against each other there."""
    _join(build, it, "fixed")


@statement(
    "joints",
    "universal",
    parts=PAIR,
    at=AT,
    axis=Direction(text="of the cross, on the first part"),
    other=Direction(text="axis of the cross on the second part, normal to that on the first"),
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
    particles, points = _meet(build, it)
    openings = it.openings or (0.0, 0.0)
    return build.scene.add_universal(it.name, particles, points, it.axis, other, openings)


@statement(
    "joints",
    "prismatic",
    parts=PAIR,
    at=AT,
    axis=Direction(text="along which the second part slides on the first"),
    opening=Number(
        0.0,
        "position at the start; grows as the second part slides along the axis against the first",
        unit="m",
    ),
)
def prismatic(build, it):
    """A slider: the second part moves along an axis of the first, and does not turn on it."""
    particles, points = _meet(build, it)
    return build.scene.add_slide(it.name, particles, points, it.axis, it.opening)


@statement(
    "supports",
    part=Reference(group="parts", text="what is held"),
    at=Reference(group="points", text="one of its points"),
    translations=Letters("xyz", "axes along which it is held"),
    rotations=Letters("xyz", "axes about which it is held"),
)
def support(build, it):
    """Holds a point of a part along and about global axes."""
    scene, particle = build.scene, it.part.particle(it.at.name)
    scene.supports[it.name] = scene.arm_to(particle, it.at.position)
    off = np.linalg.norm(it.at.position - scene.position[particle])
    whole = len(it.translations) == len(it.rotations) == len("xyz")
    if whole or off <= APART * build.size or not it.translations:
        scene.fix(particle, it.translations, it.rotations)
    else:
        scene.hold_point(it.name, particle, it.at.position, it.translations)
        build.joined.setdefault(particle, []).append(it.name)
        scene.fix(particle, "", it.rotations)
