"""Parts: elastic bars, straight or through points, with materials and sections; rigid bodies."""

from itertools import pairwise

import numpy as np

from fpm.elements.bars.beam import Material, Section, triad
from fpm.elements.bars.lumping import lump
from fpm.errors import SceneError
from fpm.structures.builder import APART, Part
from fpm.structures.keys import Direction, Each, Many, Number, Reference, Vector, Whole
from fpm.structures.statement import statement

STRAIGHT = 1e-9
"""Directions (unit vectors) that differ by less are one."""

POINT = Reference(group="points")


def _size(text: str, unit: str = "m") -> Number:
    return Number(unit=unit, above=0, text=text)


@statement(
    "materials",
    E=_size("Young's modulus", "Pa"),
    nu=Number(0.3, "Poisson's ratio"),
    rho=_size("density", "kg/m3"),
)
def material(build, it):
    """A linear elastic material."""
    return Material(it.E, it.nu, it.rho)


def _tube(build, it):
    outer, inner = it.diameter / 2, it.diameter / 2 - it.thickness
    if inner < 0:
        build.refuse("thickness", it.thickness, f"at most half the diameter, {outer:.9g} m")
    return Section.tube(outer, inner)


SECTIONS = (  # type, what it is, its sizes, and the section of them
    (
        "square", "A solid square.", {"side": _size("its side")},
        lambda build, it: Section.square(it.side),
    ),
    (
        "rectangle", "A solid rectangle.",
        {"width": _size("across the bar's `up`"), "height": _size("along the bar's `up`")},
        lambda build, it: Section.rectangle(it.width, it.height),
    ),
    (
        "circle", "A solid circle.", {"diameter": _size("its diameter")},
        lambda build, it: Section.circle(it.diameter / 2),
    ),
    (
        "tube", "A round tube.",
        {"diameter": _size("outer diameter"),
         "thickness": _size("of the wall, at most half the diameter")},
        _tube,
    ),
    (
        "general", "Any section, by its four numbers.",
        {"A": _size("area", "m2"), "Iy": _size("∫ z² dA; z is the bar's `up`", "m4"),
         "Iz": _size("∫ y² dA", "m4"), "J": _size("torsion constant", "m4")},
        lambda build, it: Section(it.A, it.Iy, it.Iz, it.J),
    ),
)  # fmt: skip
for _type, _about, _sizes, _build in SECTIONS:
    statement("sections", _type, _about, **_sizes)(_build)


# -- bars ------------------------------------------------------------------------------------------


@statement(
    "bars",
    through=Many(kind=POINT, least=2, text="its points, in order"),
    section=Reference(group="sections", text="its cross-section"),
    material=Reference(group="materials", text="its material"),
    elements=Whole(text="beam elements of each stretch between two points"),
    up=Direction(
        None, "where the section's height points; needed where it matters, and for `curvature`"
    ),
    carries=Each(
        None, "points off its axis, each rigidly held at one of its points",
        group="points", kind=POINT,
    ),
    inertia_scale=Number(1.0, "factor on the section's rotational inertia", least=1),
    strain=Number(0.0, "of what is free of stress, as by heat; with `assemble`", above=-0.5),
    curvature=Number(
        None, "likewise, > 0 where the side of `up` is longer: difference of strains over height",
        unit="/m",
    ),
)  # fmt: skip
def bar(build, it):
    """An elastic bar through points, each stretch between two of them straight."""
    for key in ("strain", "curvature"):
        if getattr(it, key) and build.hold is None:
            build.refuse(key, getattr(it, key), "0, or `assemble: true`")
    names = [point.name for point in it.through]
    points = [point.position for point in it.through]
    directions = _directions(build, names, points)
    up = _up(build, it, directions)
    lay = _straight if len(points) == 2 else _stretches
    scene, before = build.scene, len(build.scene.beams)
    nodes = lay(scene, it, points, directions, up)
    if it.strain or it.curvature is not None:
        beams = scene.beams[before:]
        scene.beams[before:] = [b.with_strain(it.strain, it.curvature) for b in beams]
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
    if it.curvature is not None:
        build.refuse(
            "up", "(left out)", "the direction of the side that is the longer by `curvature`"
        )
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

    Each stretch is lumped by itself (lumping.py); where two meet, masses and inertias add.
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
            scene.add_beams(
                np.column_stack([line[:-1], line[1:]]), it.section, it.material, up, label
            )
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


# -- bodies and masses -----------------------------------------------------------------------------


@statement(
    "bodies",
    mass=_size("its mass", "kg"),
    centre=Reference(group="points", text="its centre of mass"),
    box=Vector(
        None, "edges of a box filled evenly with the mass, along x, up × x and up; this or "
        "`inertia`", unit="m",
    ),
    inertia=Vector(
        None, "principal moments of inertia about its centre, about x, up × x and up",
        unit="kg m2",
    ),
    points=Many((), "points rigidly held at it", kind=POINT, units=True),
    x=Direction(np.array([1.0, 0.0, 0.0]), "its first principal axis"),
    up=Direction(np.array([0.0, 0.0, 1.0]), "its third principal axis, normal to x"),
)  # fmt: skip
def body(build, it):
    """A rigid body, free until something joins or holds it."""
    if (it.box is None) == (it.inertia is None):
        found = None if it.box is None else [list(it.box), list(it.inertia)]
        build.refuse("box", found, "either `box` or `inertia`")
    inertia = it.inertia
    if it.box is not None:
        if not (np.all(it.box >= 0) and np.count_nonzero(it.box) >= 2):
            build.refuse("box", it.box.tolist(), "edges >= 0, at most one of them 0")
        squares = it.box**2
        inertia = it.mass / 12 * (squares.sum() - squares)
    largest, total = float(np.max(inertia)), float(np.sum(inertia))
    if not (np.min(inertia) > 0 and 2 * largest <= total * (1 + 1e-9)):
        allowed = "values above 0, none of them more than the sum of the other two"
        build.refuse("inertia", inertia.tolist(), allowed)
    if abs(it.x @ it.up) > 1e-6:
        build.refuse("up", it.up.tolist(), f"a direction normal to x, {it.x.tolist()}")
    try:
        axes = triad(it.x, it.up)
        made = build.scene.add_particles(it.centre.position, it.mass, inertia, axes)
    except SceneError as error:
        build.refuse("mass", error.value, error.allowed)
    particle = build.scene.bodies[it.name] = int(made[0])
    return Part(it.name, {point.name: particle for point in (it.centre, *it.points)})


@statement(
    "masses",
    part=Reference(group="parts", text="what carries it"),
    at=Reference(group="points", text="a point that the part goes through"),
    mass=_size("its mass", "kg"),
    inertia=Number(0.0, "its moment of inertia, about every axis", unit="kg m2", least=0),
)
def mass(build, it):
    """A mass at a point of a part, with its centre there."""
    scene, particle = build.scene, it.part.particle(it.at.name)
    off = float(np.linalg.norm(it.at.position - scene.position[particle]))
    if off > APART * build.size:
        build.refuse("at", it.at.name, f"a point on the axis of {it.part.name}, or its centre")
    scene.mass[particle] += it.mass
    scene.inertia[particle] += it.inertia
