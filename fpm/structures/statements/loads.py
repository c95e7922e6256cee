"""What comes from outside or moves: loads, prescribed motion, cables, motion at the start; and the
points whose motion is recorded."""

import numpy as np

from fpm.elements import Drag, Load
from fpm.elements.particles.drag import stations
from fpm.structures.builder import POINT_TOL
from fpm.structures.keys import (
    CurvesKey,
    DirectionKey,
    ListKey,
    NumberKey,
    OpeningKey,
    PointKey,
    ReferenceKey,
    TextKey,
    VectorKey,
)
from fpm.structures.reading import commas
from fpm.structures.statement import CLASS, statement

ZERO = np.zeros(3)
PART = ReferenceKey(group="parts", text="what it is about")
POINT = ReferenceKey(group="points", text="one of its points")
CURVE_KEYS = ["times", "values", "file", "column"]
CURVE = ReferenceKey(None, "scales it with time; left out: constant", group="curves")


@statement(
    "curves",
    times=ListKey(
        None, "increasing; these and `values`, or `file` and `column`", kind=NumberKey(unit="s")
    ),
    values=ListKey(None, "one for each time", kind=NumberKey()),
    file=CurvesKey(None, "with times first, and units in its first line"),
    column=TextKey(None, "name of that whose numbers, in SI units, are the values"),
)
def curve(build, args):
    """A curve of time, straight between the values given and constant outside them.

    Adds it to the scene; returns its index. build: Builder of the sample, with its scene; args:
    values of an entry: either times (s), increasing, and values (one for each), or file
    (CurvesFile) and column (name of one in it); the other two are None."""
    keys = [key for key in CURVE_KEYS if getattr(args, key) is not None]
    if keys not in (CURVE_KEYS[:2], CURVE_KEYS[2:]):
        allowed = "`times` and `values`, or `file` and `column`"
        build.refuse(keys[-1] if keys else "times", ", ".join(keys) or None, allowed)
    if args.file is None:
        if len(args.times) != len(args.values):
            build.refuse("values", args.values, f"{len(args.times)} numbers, one for each time")
        return build.scene.add_curve(args.times, args.values)
    if args.column not in args.file.columns:
        build.refuse("column", args.column, f"a column of the file, {commas(args.file.columns)}")
    return build.scene.add_curve(args.file.times, args.file.columns[args.column])


def _index(curve: int | None) -> int:
    return -1 if curve is None else curve


@statement(
    "loads",
    part=PART,
    at=POINT,
    force=VectorKey(ZERO, unit="N", text="the force"),
    moment=VectorKey(ZERO, unit="N m", text="the moment"),
    curve=CURVE,
    **CLASS,
)
def load(build, args):
    """A force and a moment in global axes at a point of a part.

    Adds a Load to the scene. build: Builder of the sample, with its scene; args: values of an
    entry: part (Body), at (one of its Points), force (3,) N, moment (3,) N m, curve (index of what
    scales both with time, or None)."""
    beam = build.scene.arm_to(args.part.particle(args.at.name), args.at.position)
    build.scene.add(Load(beam, args.force, args.moment, _index(args.curve)))


@statement(
    "drags",
    part=PART,
    through=ListKey(kind=POINT, most=2, text="one of its points, or the ends of a line of it"),
    area=NumberKey(unit="m2", least=0, text="frontal area; of a line its length times its width"),
    coefficient=NumberKey(least=0, text="drag coefficient: force over density/2 area speed**2"),
    density=NumberKey(unit="kg/m3", least=0, text="of the air"),
    normal=DirectionKey(
        None, "of a plate: only the velocity along it drags; left out: that across a line, and all "
        "of that of a point"
    ),
    wind=VectorKey(ZERO, unit="m/s", text="velocity of the air"),
)  # fmt: skip
def drag(build, args):
    """Drag of air by the square of the speed: at a point of a part, or evenly along a line of it.

    Adds a Drag to the scene, three along a line for each particle of the part. build: Builder of
    the sample, with its scene; args: values of an entry: part (Body), through (one or two Points),
    area (m²), coefficient, density (kg/m³), normal (unit vector (3,) or None), wind (3,) m/s."""
    scene, ends = build.scene, [point.position for point in args.through]
    particles = [args.part.particle(point.name) for point in args.through]
    axis, spots = ZERO if args.normal is None else args.normal, [(particles[0], ends[0], 1.0)]
    if len(ends) > 1:
        if not (length := np.linalg.norm(ends[1] - ends[0])) > POINT_TOL * build.size:
            build.refuse("through", args.through[1].name, "two points that are apart")
        axis = (ends[1] - ends[0]) / length if args.normal is None else axis
        spots = stations(scene, args.part.particles, *ends)
    factor = args.density / 2 * args.coefficient * args.area
    component = "across" if args.normal is None else "along"
    for particle, position, weight in spots:
        beam = scene.arm_to(particle, position)
        local_axis = scene.arm_to(particle, position + axis).arm - beam.arm
        scene.add(Drag(beam, weight * factor, local_axis, component, args.wind, args.name))


@statement(
    "cables",
    through=ListKey(kind=PointKey(), least=2, text="its points, in order", units=True),
    EA=NumberKey(unit="N", above=0, text="tension for a strain of one"),
    rest=NumberKey(None, "its length without tension; this or `preload`", unit="m", above=0),
    preload=NumberKey(None, "its tension at the start; this or `rest`", unit="N", least=0),
    reel=NumberKey(0.0, "length that a winch at the first point takes in, times `curve`", unit="m"),
    curve=ReferenceKey(None, "of the winch", group="curves"),
    friction=NumberKey(
        None, "coefficient of friction at the points between its ends; left out: they turn", least=0
    ),
    drum=OpeningKey(
        None, "joint whose opening winds it at the first point", types=("revolute", "universal")
    ),
    radius=NumberKey(None, "of the drum; < 0 where a growing opening unwinds it", unit="m"),
    shortest=NumberKey(
        None,
        "length without tension down to which the drum may wind it; left out: a quarter of "
        "that at the start",
        unit="m",
        above=0,
    ),
    **CLASS,
)
def cable(build, args):
    """Pulls its points together where it is tight, and runs through those between its ends.

    Adds a Cable to the scene; returns its index. build: Builder of the sample, with its scene;
    args: values of an entry: through (list of (Body, Point)), EA (stiffness, N), rest (length
    without tension, m) or preload (N), the other None, reel (m taken in, times curve), curve (index
    or None), friction (coefficient or None), drum (index of a hinge or None), radius and shortest
    (m, each or None)."""
    points = [(part.particle(point.name), point.position) for part, point in args.through]
    for particle, _ in points:
        build.joints_of.setdefault(particle, [])
    if (args.rest is None) == (args.preload is None):
        pair = None if args.rest is None else [args.rest, args.preload]
        build.refuse("rest", pair, "either `rest` or `preload`")
    if args.reel and args.curve is None:
        build.refuse("reel", args.reel, "a length with a `curve`")
    if args.drum is not None and args.curve is not None:
        build.refuse("drum", build.scene.hinges[args.drum].name, "none, with a `reel` and `curve`")
    if (args.drum is None) == bool(args.radius):
        build.refuse("radius", args.radius, "a length other than 0 with a `drum`, none without")
    if args.drum is None and args.shortest is not None:
        build.refuse("shortest", args.shortest, "none without a `drum`")
    numbers = args.EA, args.rest, args.preload, args.reel, _index(args.curve), args.friction
    drum = {"drum": _index(args.drum), "radius": args.radius or 0.0, "least": args.shortest}
    return build.scene.add_cable(args.name, points, *numbers, **drum)


@statement(
    "drives",
    part=PART,
    at=POINT,
    velocity=VectorKey(ZERO, unit="m/s", text="its velocity"),
    spin=VectorKey(ZERO, unit="rad/s", text="its angular velocity"),
    curve=CURVE,
)
def drive(build, args):
    """Prescribes how a point of a part moves and turns.

    Adds a Drive to the scene. build: Builder of the sample, with its scene; args: values of an
    entry: part (Body), at (one of its Points), velocity (3,) m/s, spin (3,) rad/s, curve (index of
    what scales both with time, or None)."""
    particle = args.part.particle(args.at.name)
    arm = build.scene.arm_to(particle, args.at.position)
    distance = float(np.linalg.norm(arm.arm))
    if distance > POINT_TOL * build.size and np.any(args.spin):
        build.refuse("at", args.at.name, "the centre of a body, or a point on the bar's axis")
    build.scene.drive(particle, args.velocity, args.spin, _index(args.curve))
    name = f"drive {args.name}" if args.name in build.scene.supports else args.name
    build.scene.supports[name] = arm


@statement(
    "initial_velocities",
    part=PART,
    velocity=VectorKey(ZERO, unit="m/s", text="of the point `about`"),
    spin=VectorKey(ZERO, unit="rad/s", text="angular velocity"),
    about=ReferenceKey(group="points", text="any point"),
)
def motion(build, args):
    """How a part moves at the start, as a rigid body.

    Sets its particles' velocities in the scene. build: Builder of the sample; args: values of an
    entry: part (Body), velocity (3,) m/s of the point about (Point), spin (3,) rad/s."""
    scene, particles = build.scene, args.part.particles
    arms = scene.position[particles] - args.about.position
    scene.velocity[particles] = args.velocity + np.cross(args.spin, arms)
    scene.spin[particles] = args.spin


@statement(
    "opening_rates",
    joint=OpeningKey(text="whose opening changes at the start"),
    rate=NumberKey(unit="rad/s", text="of its opening"),
)
def opening_rate(build, args):
    """How fast an opening changes at the start; what else moves is as after a blow in these joints.

    Notes it in the scene. build: Builder of the sample; args: values of an entry: joint (index of a
    hinge), rate (rad/s; m/s on a slide)."""
    if args.joint in build.scene.opening_rates:
        build.refuse("joint", build.scene.hinges[args.joint].name, "joints that have no other rate")
    build.scene.opening_rates[args.joint] = args.rate


@statement(
    "record", part=ReferenceKey(group="parts", text="what carries it", ground=True), at=POINT
)
def record(build, args):
    """A point of a part whose motion is recorded under this name.

    Adds a named point to the scene. build: Builder of the sample, with its scene; args: values of
    an entry: part (Body or Ground), at (one of its Points), name."""
    build.scene.add_point(args.name, args.part.particle(args.at.name), args.at.position)
