"""What comes from outside or moves: loads, prescribed motion, cables, motion at the start; and the
points whose motion is recorded."""

import numpy as np

from fpm.elements import Load
from fpm.structures.builder import APART
from fpm.structures.keys import Many, Number, PointOfPart, Reference, Vector
from fpm.structures.statement import CLASS, statement

ZERO = np.zeros(3)
PART = Reference(group="parts", text="what it is about")
AT = Reference(group="points", text="one of its points")
CURVE = Reference(None, "scales it with time; left out: constant", group="curves")


@statement(
    "curves",
    times=Many(kind=Number(unit="s"), text="increasing"),
    values=Many(kind=Number(), text="one for each time"),
)
def curve(build, it):
    """A curve of time, straight between the values given and constant outside them."""
    return build.scene.add_curve(it.times, it.values)


def _index(curve: int | None) -> int:
    return -1 if curve is None else curve


@statement(
    "loads",
    part=PART,
    at=AT,
    force=Vector(ZERO, unit="N", text="the force"),
    moment=Vector(ZERO, unit="N m", text="the moment"),
    curve=CURVE,
    **CLASS,
)
def load(build, it):
    """A force and a moment in global axes at a point of a part."""
    beam = build.scene.arm_to(it.part.particle(it.at.name), it.at.position)
    build.scene.add(Load(beam, it.force, it.moment, _index(it.curve)))


@statement(
    "cables",
    through=Many(kind=PointOfPart(), least=2, text="its points, in order", units=True),
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
def cable(build, it):
    """Pulls its points together where it is tight, and runs through those between its ends."""
    points = [(part.particle(point.name), point.position) for part, point in it.through]
    for particle, _ in points:
        build.joined.setdefault(particle, [])
    if (it.rest is None) == (it.preload is None):
        found = None if it.rest is None else [it.rest, it.preload]
        build.refuse("rest", found, "either `rest` or `preload`")
    if it.reel and it.curve is None:
        build.refuse("reel", it.reel, "a length with a `curve`")
    numbers = it.EA, it.rest, it.preload, it.reel, _index(it.curve), it.friction
    return build.scene.add_cable(it.name, points, *numbers)


@statement(
    "drives",
    part=PART,
    at=AT,
    velocity=Vector(ZERO, unit="m/s", text="its velocity"),
    spin=Vector(ZERO, unit="rad/s", text="its angular velocity"),
    curve=CURVE,
)
def drive(build, it):
    """Prescribes how a point of a part moves and turns."""
    particle = it.part.particle(it.at.name)
    arm = build.scene.arm_to(particle, it.at.position)
    off = float(np.linalg.norm(arm.arm))
    if off > APART * build.size and np.any(it.spin):
        build.refuse("at", it.at.name, "the centre of a body, or a point on the bar's axis")
    build.scene.drive(particle, it.velocity, it.spin, _index(it.curve))
    name = f"drive {it.name}" if it.name in build.scene.supports else it.name
    build.scene.supports[name] = arm


@statement(
    "motions",
    part=PART,
    velocity=Vector(ZERO, unit="m/s", text="of the point `about`"),
    spin=Vector(ZERO, unit="rad/s", text="angular velocity"),
    about=Reference(group="points", text="any point"),
)
def motion(build, it):
    """How a part moves at the start, as a rigid body."""
    scene, particles = build.scene, it.part.particles
    arms = scene.position[particles] - it.about.position
    scene.velocity[particles] = it.velocity + np.cross(it.spin, arms)
    scene.spin[particles] = it.spin


@statement("record", part=Reference(group="parts", text="what carries it", ground=True), at=AT)
def recorded(build, it):
    """A point of a part whose motion is recorded under this name."""
    build.scene.add_point(it.name, it.part.particle(it.at.name), it.at.position)
