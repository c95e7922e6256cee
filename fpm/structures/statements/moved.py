"""What comes from outside: loads, prescribed motion, and how parts move at the start."""

import numpy as np

from fpm.elements import Load
from fpm.structures.builder import APART
from fpm.structures.keys import Many, Number, Part, Reference, Vector
from fpm.structures.statement import statement

ZERO = np.zeros(3)
PART = Part(about="what it is about")
AT = Reference(group="points", about="one of its points")
CURVE = Reference(None, "scales it with time; left out: constant", group="curves")


@statement(
    "curves",
    times=Many(kind=Number(unit="s"), about="increasing"),
    values=Many(kind=Number(), about="one for each time"),
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
    force=Vector(ZERO, unit="N", about="the force"),
    moment=Vector(ZERO, unit="N m", about="the moment"),
    curve=CURVE,
)
def load(build, it):
    """A force and a moment in global axes at a point of a part."""
    beam = build.scene.arm_to(it.part.particle(it.at.name), it.at.position)
    build.scene.add(Load(beam, it.force, it.moment, _index(it.curve)))


@statement(
    "drives",
    part=PART,
    at=AT,
    velocity=Vector(ZERO, unit="m/s", about="its velocity"),
    spin=Vector(ZERO, unit="rad/s", about="its angular velocity"),
    curve=CURVE,
)
def drive(build, it):
    """Prescribes how a point of a part moves and turns."""
    particle = it.part.particle(it.at.name)
    off = float(np.linalg.norm(build.scene.arm_to(particle, it.at.position).arm))
    if off > APART * build.size and np.any(it.spin):
        build.refuse("at", it.at.name, "the centre of a body, or a point on the bar's axis", off)
    build.scene.drive(particle, it.velocity, it.spin, _index(it.curve))
    name = f"drive {it.name}" if it.name in build.scene.supports else it.name
    build.scene.supports[name] = build.scene.arm_to(particle, it.at.position)


@statement(
    "motions",
    part=PART,
    velocity=Vector(ZERO, unit="m/s", about="of the point `about`"),
    spin=Vector(ZERO, unit="rad/s", about="angular velocity"),
    about=Reference(group="points", about="any point"),
)
def motion(build, it):
    """How a part moves at the start, as a rigid body."""
    scene, particles = build.scene, it.part.particles
    arms = scene.position[particles] - it.about.position
    scene.velocity[particles] = it.velocity + np.cross(it.spin, arms)
    scene.spin[particles] = it.spin
