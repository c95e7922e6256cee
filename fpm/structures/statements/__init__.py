"""All kinds of statements, in the order in which a scene is built of them.

A statement may refer to those of groups further up. To add a kind, write a file like those beside
this one and put it into the list.
"""

from fpm.structures.statement import Statement
from fpm.structures.statements import (
    acting,
    bars,
    bodies,
    cables,
    held,
    joints,
    masses,
    motors,
    moved,
    recorded,
    sections,
)

STATEMENTS: tuple[Statement, ...] = (
    sections.material,
    sections.square,
    sections.rectangle,
    sections.circle,
    sections.tube,
    sections.general,
    bars.bar,
    bodies.body,
    masses.mass,
    held.support,
    joints.revolute,
    joints.spherical,
    joints.fixed,
    joints.universal,
    joints.prismatic,
    moved.curve,
    acting.torsion_spring,
    acting.spring,
    acting.contact,
    acting.damper,
    acting.friction,
    acting.stop,
    acting.latch,
    acting.tape_spring,
    motors.loop,
    motors.motor,
    motors.torque_motor,
    motors.release,
    moved.load,
    cables.cable,
    moved.drive,
    moved.motion,
    recorded.recorded,
)

GROUPS: dict[str, dict[str, Statement]] = {}
for _one in STATEMENTS:
    GROUPS.setdefault(_one.group, {})[_one.type] = _one
