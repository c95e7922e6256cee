"""What comes from outside or moves: loads, prescribed motion, cables, motion at the start; and the
points whose motion is recorded."""

import numpy as np

from fpm.elements import Load
from fpm.structures.builder import POINT_TOL
from fpm.structures.keys import ListOf, Number, PointOfPart, Reference, Vector
from fpm.structures.statement import CLASS, statement

ZERO = np.zeros(3)
PART = Reference(group="parts", text="what it is about")
POINT = Reference(group="points", text="one of its points")
CURVE = Reference(None, "scales it with time; left out: constant", group="curves")


@statement(
    "curves",
    times=ListOf(kind=Number(unit="s"), text="increasing"),
    values=ListOf(kind=Number(), text="one for each time"),
)
def curve(build, args):
    """A curve of time, straight between the values given and constant outside them."""
    return build.scene.add_curve(args.times, args.values)


def _index(curve: int | None) -> int:
    return -1 if curve is None else curve


@statement(
    "loads",
    part=PART,
    at=POINT,
    force=Vector(ZERO, unit="N", text="the force"),
    moment=Vector(ZERO, unit="N m", text="the moment"),
    curve=CURVE,
    **CLASS,
)
def load(build, args):
    """A force and a moment in global axes at a point of a part."""
    beam = build.scene.arm_to(args.part.particle(args.at.name), args.at.position)
    build.scene.add(Load(beam, args.force, args.moment, _index(args.curve)))


@statement(
    "cables",
    through=ListOf(kind=PointOfPart(), least=2, text="its points, in order", units=True),
    EA=Number(unit="N", above=0, text="tension for a strain of one"),
    rest=Number(None, "its length without tension; this or `preload`", unit="m", above=0),
    preload=Number(None, "its tension at the start; this or `rest`", unit="N", least=0),
    reel=Number(0.0, "length that a winch at the first point takes in, times `curve`", unit="m"),
    curve=Reference(None, "of the winch", group="curves"),
    friction=Number(
        None, "coefficient of friction at the points between its ends; left out: they turn", least=0
    ),
    **CLASS,
)
def cable(build, args):
    """Pulls its points together where it is tight, and runs through those between its ends."""
    points = [(part.particle(point.name), point.position) for part, point in args.through]
    for particle, _ in points:
        build.joints_of.setdefault(particle, [])
    if (args.rest is None) == (args.preload is None):
        pair = None if args.rest is None else [args.rest, args.preload]
        build.refuse("rest", pair, "either `rest` or `preload`")
    if args.reel and args.curve is None:
        build.refuse("reel", args.reel, "a length with a `curve`")
    numbers = args.EA, args.rest, args.preload, args.reel, _index(args.curve), args.friction
    return build.scene.add_cable(args.name, points, *numbers)


@statement(
    "drives",
    part=PART,
    at=POINT,
    velocity=Vector(ZERO, unit="m/s", text="its velocity"),
    spin=Vector(ZERO, unit="rad/s", text="its angular velocity"),
    curve=CURVE,
)
def drive(build, args):
    """Prescribes how a point of a part moves and turns."""
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
    velocity=Vector(ZERO, unit="m/s", text="of the point `about`"),
    spin=Vector(ZERO, unit="rad/s", text="angular velocity"),
    about=Reference(group="points", text="any point"),
)
def motion(build, args):
    """How a part moves at the start, as a rigid body."""
    scene, particles = build.scene, args.part.particles
    arms = scene.position[particles] - args.about.position
    scene.velocity[particles] = args.velocity + np.cross(args.spin, arms)
    scene.spin[particles] = args.spin


@statement("record", part=Reference(group="parts", text="what carries it", ground=True), at=POINT)
def record(build, args):
    """A point of a part whose motion is recorded under this name."""
    build.scene.add_point(args.name, args.part.particle(args.at.name), args.at.position)
