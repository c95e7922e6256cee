"""What comes from outside: loads, prescribed motion, and how parts move at the start."""

import numpy as np

from fpm.structures.keys import Many, Number, Reference, Vector
from fpm.structures.statement import Statement

ZERO = np.zeros(3)
PART = Reference(group="parts", about="a bar")
AT = Reference(group="points", about="one of its points")
CURVE = Reference(None, "scales it with time; left out: constant", group="curves")


class Curve(Statement):
    """A curve of time, straight between the values given and constant outside them."""

    group = "curves"
    keys = {
        "times": Many(kind=Number(unit="s"), about="increasing"),
        "values": Many(kind=Number(), about="one for each time"),
    }

    @staticmethod
    def build(build, it):
        return build.scene.add_curve(it.times, it.values)


def _index(curve: int | None) -> int:
    return -1 if curve is None else curve


class Load(Statement):
    """A force and a moment in global axes at a point of a part."""

    group = "loads"
    keys = {
        "part": PART,
        "at": AT,
        "force": Vector(ZERO, unit="N", about="the force"),
        "moment": Vector(ZERO, unit="N m", about="the moment"),
        "curve": CURVE,
    }

    @staticmethod
    def build(build, it):
        particle = it.part.particle(it.at.name)
        arm = it.at.position - build.scene.position[particle]
        build.scene.add_load(particle, it.force, it.moment, arm, _index(it.curve))


class Drive(Statement):
    """Prescribes how a point of a part moves and turns."""

    group = "drives"
    keys = {
        "part": PART,
        "at": AT,
        "velocity": Vector(ZERO, unit="m/s", about="its velocity"),
        "spin": Vector(ZERO, unit="rad/s", about="its angular velocity"),
        "curve": CURVE,
    }

    @staticmethod
    def build(build, it):
        particle = it.part.particle(it.at.name)
        build.scene.drive(particle, it.velocity, it.spin, _index(it.curve))


class Motion(Statement):
    """How a part moves at the start, as a rigid body."""

    group = "motions"
    keys = {
        "part": PART,
        "velocity": Vector(ZERO, unit="m/s", about="of the point `about`"),
        "spin": Vector(ZERO, unit="rad/s", about="angular velocity"),
        "about": Reference(group="points", about="any point"),
    }

    @staticmethod
    def build(build, it):
        scene, particles = build.scene, it.part.particles
        arms = scene.position[particles] - it.about.position
        scene.velocity[particles] = it.velocity + np.cross(it.spin, arms)
        scene.spin[particles] = it.spin
