"""Joints: what parts share where they meet."""

from itertools import pairwise

import numpy as np

from fpm.kinds.hinge import unit
from fpm.structures import today
from fpm.structures.keys import Direction, Each, Either, Letters, Many, Number, Part, Reference
from fpm.structures.statement import statement

APART = 1e-9
"""Points that differ by less, as a share of the structure's size, are one."""

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
    """A hinge: two parts share a point and an axis, and turn freely about it."""
    today.check_pair(build, it)
    particles, point = meet(build, it)
    today.check_free(build, it, particles)
    references = it.references
    if references is not None:
        names = [part.name for part in it.parts]
        if references.keys() != set(names):
            build.refuse("references", list(references), f"one for each of {', '.join(names)}")
        references = [_across(build, references[name], it.axis) for name in names]
    return build.scene.add_hinge(
        it.name, particles, point, it.axis, references, it.opening, it.held
    )


def _across(build, reference, axis) -> np.ndarray:
    """A reference without the rounding along the axis."""
    along = float(reference @ axis)
    if abs(along) > 1e-6:
        build.refuse("references", reference.tolist(), "directions normal to the axis")
    return unit(reference - along * axis, "reference")
