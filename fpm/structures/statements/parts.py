"""Parts: elastic bars, straight or through points, with materials and sections; rigid bodies."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from fpm.declare import Number
from fpm.elements.bars.beam import Material, Section, lump, triad
from fpm.elements.cross import length as size
from fpm.errors import SceneError
from fpm.structures.builder import POINT_TOL, Body
from fpm.structures.keys import COUNT, DirectionKey, ListKey, MapKey, ReferenceKey, VectorKey
from fpm.structures.plausible import find_dense
from fpm.structures.statement import statement

STRAIGHT = 1e-9
"""Directions (unit vectors) that differ by less are one."""

LEAST_INERTIA = 1e-6
"""Inertia about the axis of a body without width, as a share of that across: no moment turns
anything that has none at all. A rod has it that is 1/1200 as thick as long."""

POINT = ReferenceKey(group="points")


def _size(text: str, unit: str = "m") -> Number:
    return Number(unit=unit, above=0, text=text)


@statement(
    "materials",
    E=_size("Young's modulus", "Pa"),
    nu=Number(0.3, "Poisson's ratio"),
    rho=_size("density", "kg/m3"),
    stiffness_damping=Number(
        0.0, "Rayleigh's beta, the ratio of damping to stiffness: 2 zeta/omega gives a vibration"
             " at the frequency omega the damping ratio zeta", unit="s", least=0,
    ),
)  # fmt: skip
def material(build, args):
    """A linear elastic material."""
    return Material(args.E, args.nu, args.rho, args.stiffness_damping)


def _tube(build, args):
    outer, inner = args.diameter / 2, args.diameter / 2 - args.thickness
    if inner < 0:
        build.refuse("thickness", args.thickness, f"at most half the diameter, {outer:.9g} m")
    return Section.tube(outer, inner)


SECTIONS = (  # type, what it is, its sizes, and the section of them
    (
        "square", "A solid square.", {"side": _size("length of a side")},
        lambda build, args: Section.square(args.side),
    ),
    (
        "rectangle", "A solid rectangle.",
        {"width": _size("width of the section, normal to the bar's `up`"),
         "height": _size("height of the section, along the bar's `up`")},
        lambda build, args: Section.rectangle(args.width, args.height),
    ),
    (
        "circle", "A solid circle.", {"diameter": _size("diameter of the section")},
        lambda build, args: Section.circle(args.diameter / 2),
    ),
    (
        "tube", "A round tube.",
        {"diameter": _size("outer diameter"),
         "thickness": _size("wall thickness, at most half the diameter")},
        _tube,
    ),
    (
        "general", "A section of any shape, given by four numbers.",
        {"A": _size("area", "m2"), "Iy": _size("second moment of area ∫ z² dA, where z is along "
                                               "the bar's `up`", "m4"),
         "Iz": _size("second moment of area ∫ y² dA", "m4"), "J": _size("torsion constant", "m4")},
        lambda build, args: Section(args.A, args.Iy, args.Iz, args.J),
    ),
)  # fmt: skip
for _type, _text, _sizes, _build in SECTIONS:
    statement("sections", _type, _text, **_sizes)(_build)


# -- bars ------------------------------------------------------------------------------------------


@statement(
    "bars",
    through=ListKey(kind=POINT, least=2, text="points through which it passes, in order"),
    section=ReferenceKey(group="sections", text="cross-section"),
    material=ReferenceKey(group="materials", text="material"),
    elements=replace(COUNT, text="number of beam elements between two neighbouring points"),
    up=DirectionKey(
        None, "direction of the section's height; required for `curvature`, and unless the "
              "section is the same in all directions"
    ),
    carries=MapKey(
        None, "points beside its axis, each rigidly attached to one of its own points",
        group="points", kind=POINT,
    ),
    inertia_scale=Number(1.0, "factor for the rotational inertia of the section", least=1),
    strain=Number(0.0, "stress-free strain, such as that of heat; requires `assemble`", above=-0.5),
    curvature=Number(
        None, "stress-free curvature: difference of the strains of both sides divided by the "
              "height, positive if the side of `up` is longer",
        unit="/m",
    ),
)  # fmt: skip
def bar(build, args):
    """An elastic bar through points, straight between neighbouring points."""
    for key in ("strain", "curvature"):
        if getattr(args, key) and build.hold is None:
            build.refuse(key, getattr(args, key), "0, or `assemble: true`")
    names = [point.name for point in args.through]
    points = [point.position for point in args.through]
    directions = _directions(build, names, points)
    normal = _height_axis(build, args, directions)
    scene, count = build.scene, len(build.scene.beams)
    if len(points) == 2:
        shape = args.section, args.material, args.elements, args.name, args.inertia_scale
        nodes = scene.add_link(*points, normal, *shape).particles[[0, -1]].tolist()
    else:
        nodes = _lay_stretches(scene, args, points, directions, normal)
    if args.strain or args.curvature is not None:
        beams = scene.beams[count:]
        scene.beams[count:] = [b.with_strain(args.strain, args.curvature) for b in beams]
    particles = dict(zip(names, nodes, strict=True))
    for point, holder in (args.carries or {}).items():
        if holder.name not in particles:
            build.refuse(f"carries.{point}", holder.name, f"one of {', '.join(names)}")
        if point in particles:
            build.refuse("carries", point, "points that the bar does not go through")
        particles[point] = particles[holder.name]
    return Body(args.name, particles)


def _directions(build, names, points) -> list[np.ndarray]:
    """Unit vectors of the stretches; what is straight has one direction to the last digit."""
    result: list[np.ndarray] = []
    for (first, second), (start, end) in zip(pairwise(names), pairwise(points), strict=True):
        length = size(end - start)
        if not 0 < length < np.inf:
            build.refuse("through", length, f"a length above 0 m from {first} to {second}")
        direction = (end - start) / length
        is_straight = result and np.abs(direction - result[-1]).max() < STRAIGHT
        result.append(result[-1] if is_straight else direction)
    return result


def _height_axis(build, args, directions) -> np.ndarray:
    """Return the direction of the section's height, chosen where it is no matter."""
    if args.up is not None:
        cosine = max(abs(direction @ args.up) for direction in directions)
        if cosine > 1 - 1e-12:
            build.refuse("up", args.up.tolist(), "a direction that is not the bar's own")
        return args.up
    if args.section.Iy != args.section.Iz:
        build.refuse("up", None, "the direction in which the section's height points, such as z")
    if args.curvature is not None:
        build.refuse("up", None, "the direction of the side that is the longer by `curvature`")
    cosines = [max(abs(direction[k]) for direction in directions) for k in (2, 0, 1)]
    return np.eye(3)[(2, 0, 1)[int(np.argmin(cosines))]]


def _lay_stretches(scene, args, points, directions, normal) -> list[int]:
    """Add a bar through more than two points, stretch by stretch; return the particles at the
    points. Each stretch is lumped by itself (beam.py); where two meet, masses and inertias add."""
    axes = [triad(direction, normal) for direction in directions]
    shape = args.elements, args.section, args.material, args.inertia_scale
    lumps = [lump(size(end - start), *shape) for start, end in pairwise(points)]
    nodes: list[int] = []
    inner = np.zeros(0, int)
    steps = np.linspace(0.0, 1.0, args.elements + 1)[1:-1, None]
    for k, point in enumerate(points):
        # Here meet the last lump of the stretch before and the first of the one after.
        ends = [(k - 1, -1)] * (k > 0) + [(k, 0)] * (k < len(axes))
        inertia, frame = _sum_inertias([(lumps[j][1][i], axes[j]) for j, i in ends])
        mass = sum(lumps[j][0][i] for j, i in ends)
        node = scene.add_particles(point, mass, inertia, frame)
        if k:
            line = np.array([nodes[-1], *inner, node[0]])
            label = f"{args.name} from {args.through[k - 1].name.rpartition('.')[2]}"
            pairs = np.column_stack([line[:-1], line[1:]])
            scene.add_beams(pairs, args.section, args.material, normal, label)
        nodes.append(int(node[0]))
        if k < len(axes):
            masses, inertias = lumps[k]
            inner_points = point + steps * (points[k + 1] - point)
            if len(inner_points):  # none in a stretch of one element
                inner = scene.add_particles(inner_points, masses[1:-1], inertias[1:-1], axes[k])
    return nodes


def _sum_inertias(parts) -> tuple[np.ndarray, np.ndarray]:
    """Principal inertias (3,) and axes (3, 3) of inertias that add up, each in its own axes."""
    if len(parts) == 1 or np.abs(parts[0][1] - parts[1][1]).max() < STRAIGHT:
        return sum(inertia for inertia, _ in parts), parts[0][1]
    return _principal_axes(sum(frame * inertia @ frame.T for inertia, frame in parts))


def _principal_axes(tensor, axes: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Principal inertias (3,) and axes (3, 3) of an inertia tensor; `axes` where they are such."""
    if axes is not None:
        local = axes.T @ tensor @ axes
        values = np.diagonal(local).copy()
        if np.abs(local - np.diag(values)).max() < STRAIGHT * values.max():
            return values, axes
    values, axes = np.linalg.eigh(tensor)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return values, axes


# -- bodies and masses -----------------------------------------------------------------------------


POINTS = ListKey((), "points that are fixed to it", kind=POINT, units=True)


@statement(
    "bodies",
    mass=_size("mass", "kg"),
    centre=ReferenceKey(group="points", text="centre of mass"),
    box=VectorKey(
        None, "edge lengths of a uniform box with this mass, along x, up × x and up; give this "
              "or `inertia`", unit="m",
    ),
    inertia=VectorKey(
        None, "principal moments of inertia about x, up × x and up, for axes through the centre",
        unit="kg m2",
    ),
    points=POINTS,
    x=DirectionKey(np.array([1.0, 0.0, 0.0]), "direction of its first principal axis"),
    up=DirectionKey(np.array([0.0, 0.0, 1.0]), "direction of its third principal axis, normal to"
                                               " x"),
)  # fmt: skip
def body(build, args):
    """A rigid body (without `type`), which moves freely unless joints or supports hold it."""
    if (args.box is None) == (args.inertia is None):
        pair = None if args.box is None else [list(args.box), list(args.inertia)]
        build.refuse("box" if pair else "box or inertia", pair, "one of the two")
    inertia = args.inertia
    if args.box is not None:
        if not (np.all(args.box >= 0) and np.any(args.box)):
            build.refuse("box", args.box.tolist(), "edges >= 0, at most two of them 0")
        squares = args.box**2
        inertia = args.mass / 12 * (squares.sum() - squares)
    if not (np.all(_fill(inertia) > 0) and 2 * np.max(inertia) <= np.sum(inertia) * (1 + 1e-9)):
        allowed = "values >= 0, at most one 0, none of them more than the sum of the other two"
        build.refuse("inertia", np.array(inertia).tolist(), allowed)
    if abs(args.x @ args.up) > 1e-6:
        build.refuse("up", args.up.tolist(), f"a direction normal to x, {args.x.tolist()}")
    axes = triad(args.x, args.up)
    return _add_body(build, args, args.mass, args.centre.position, inertia, axes, [args.centre])


def _fill(inertia) -> np.ndarray:
    """Principal inertias (3,), with LEAST_INERTIA in the place of one that is 0 to rounding."""
    largest = np.max(inertia)
    return np.where(np.abs(inertia) <= 1e-12 * largest, LEAST_INERTIA * largest, inertia)


def _add_body(build, args, mass, centre, inertia, axes, points) -> Body:
    """Add a rigid body to the scene of `build`. mass (kg), centre (3,), principal inertias (3,) and
    axes (3, 3); points: Points of its own, beside those in `args`."""
    try:
        particles = build.scene.add_particles(centre, mass, _fill(inertia), axes)
    except SceneError as error:
        build.refuse("mass", error.value, error.allowed)
    particle = build.scene.bodies[args.name] = int(particles[0])
    return Body(args.name, {point.name: particle for point in (*points, *args.points)})


MASS = {
    "mass": replace(_size("mass, evenly distributed; give this or `density`", "kg"), default=None),
    "density": replace(_size("density of its material, instead of `mass`", "kg/m3"), default=None),
}
END_TEXTS = {"from": "point at one end of its axis", "to": "point at the other end of its axis"}
LINE = {**{key: replace(POINT, text=text) for key, text in END_TEXTS.items()}, **MASS}
ROD_DIAMETER = "diameter of a solid round rod; default: a line, about whose axis no moment may act"


def _mass_of(build, args, volume: float, remedy: str) -> float:
    """Mass (kg) of a body by its `mass` or `density`, which needs a volume (m³)."""
    if (args.mass is None) == (args.density is None):
        build.refuse("mass", args.mass, "either `mass` or `density`, one of them")
    if args.density and not volume > 0:
        build.refuse("density", args.density, f"`mass`, or also {remedy}")
    mass = args.mass or args.density * volume
    build.scene.doubts += find_dense(args.name, mass, volume)
    return mass


def _cylinder(build, args, section: Section | None) -> Body:
    """A round body from one point to another; section: across, None: none, of a line."""
    start, end = (vars(args)[key].position for key in ("from", "to"))
    direction, length = end - start, float(np.linalg.norm(end - start))
    if not 0 < length < np.inf:
        build.refuse("to", args.to.name, f"a point apart from {vars(args)['from'].name}")
    area, second = (section.A, section.Iy) if section else (0.0, 0.0)
    mass = _mass_of(build, args, area * length, "a `diameter`")
    radius2 = second / area if area else 0.0  # square of the section's radius of gyration
    inertia = mass * np.array([2 * radius2, *[radius2 + length**2 / 12] * 2])
    axes = triad(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    ends = [vars(args)["from"], args.to]
    return _add_body(build, args, mass, (start + end) / 2, inertia, axes, ends)


@statement(
    "bodies",
    "rod",
    **LINE,
    diameter=Number(None, ROD_DIAMETER, unit="m", above=0),
    points=POINTS,
)
def rod(build, args):
    """A straight rigid rod between two points, with its mass evenly distributed."""
    return _cylinder(build, args, args.diameter and Section.circle(args.diameter / 2))


@statement(
    "bodies",
    "tube",
    **LINE,
    diameter=_size("outer diameter"),
    thickness=_size("wall thickness, at most half the diameter"),
    points=POINTS,
)
def tube(build, args):
    """A straight round rigid tube between two points, with open ends."""
    return _cylinder(build, args, _tube(build, args))


@statement(
    "bodies",
    "plate",
    corners=ListKey(
        kind=POINT, least=3, text="corner points in one plane, in order around the plate; the "
                                  "first sees all the others",
    ),
    **MASS,
    thickness=Number(0.0, "thickness, half on each side of the corners' plane", unit="m", least=0),
    points=POINTS,
)  # fmt: skip
def plate(build, args):
    """A flat rigid plate between its corners, with its mass evenly distributed."""
    places = np.array([corner.position for corner in args.corners])
    arms = places[1:] - places[0]
    first, second = arms[:-1], arms[1:]  # sides of triangles that begin at the first corner
    total = np.cross(first, second).sum(axis=0) / 2
    area, names = float(np.linalg.norm(total)), ", ".join(corner.name for corner in args.corners)
    normal = total / area
    areas = np.cross(first, second) @ normal / 2
    if not area > 0 or not np.all(areas > -POINT_TOL * area):
        build.refuse("corners", names, "corners in order around an area, all seen from the first")
    if not np.abs(arms @ normal).max() <= POINT_TOL * build.size:
        build.refuse("corners", names, "corners in one plane")
    mass = _mass_of(build, args, area * args.thickness, "a `thickness`")
    sums, weights = first + second, areas / area
    centre = weights @ sums / 3
    squares = [np.einsum("ti,tj,t->ij", x, x, weights) for x in (first, second, sums)]
    moments = sum(squares) / 12 - np.outer(centre, centre)  # of area, over it
    moments += args.thickness**2 / 12 * np.outer(normal, normal)
    tensor = mass * (np.trace(moments) * np.eye(3) - moments)
    inertia, axes = _principal_axes(tensor, triad(arms[0], normal))
    return _add_body(build, args, mass, places[0] + centre, inertia, axes, args.corners)


@statement(
    "masses",
    part=ReferenceKey(group="parts", text="part that carries it"),
    at=ReferenceKey(group="points", text="any point of a rigid body, or a point on a bar's axis"),
    mass=_size("mass", "kg"),
    inertia=Number(0.0, "moment of inertia, the same about every axis", unit="kg m2", least=0),
)
def mass(build, args):
    """A mass whose centre is at a point of a part."""
    scene, particle = build.scene, args.part.particle(args.at.name)
    distance = float(np.linalg.norm(args.at.position - scene.position[particle]))
    if distance > POINT_TOL * build.size:
        if particle not in scene.bodies.values():
            build.refuse("at", args.at.name, f"a point on the axis of {args.part.name}")
        reduced_mass = scene.mass[particle] * args.mass / (scene.mass[particle] + args.mass)
        arm = args.at.position - scene.position[particle]
        axes = scene.frame[particle]
        point_inertia = reduced_mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        tensor = axes * scene.inertia[particle] @ axes.T + point_inertia
        scene.position[particle] += arm * reduced_mass / scene.mass[particle]
        scene.inertia[particle], scene.frame[particle] = _principal_axes(tensor, axes)
    scene.mass[particle] += args.mass
    scene.inertia[particle] += args.inertia
