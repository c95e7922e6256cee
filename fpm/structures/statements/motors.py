"""What opens joints together, by a motor, or lets them go."""

import numpy as np

from fpm.elements import Motor, TorqueMotor
from fpm.elements.joints.rigid_motor import RigidMotor
from fpm.elements.joints.rigid_release import RigidRelease
from fpm.elements.openings.opening import unit_of
from fpm.elements.openings.release import Release
from fpm.elements.openings.sync_loop import SyncLoop
from fpm.structures.keys import Many, Number, Opening, Reference
from fpm.structures.statement import statement
from fpm.structures.statements.acting import JOINT, TURNING

CURVE = {"group": "curves"}

AT_START = 1e-9
"""What holds exactly holds where the joint is at the start, to this angle (rad)."""


def _at_start(build, hinge: int) -> float:
    return build.scene.hinges[hinge].opening


@statement(
    "actions",
    "loop",
    joints=Many(kind=TURNING, least=2, most=2, about="the two on which its pulleys sit"),
    radii=Many(
        kind=Number(unit="m"),
        least=2,
        most=2,
        about="of the pulleys; opposite in sign where the loop is crossed",
    ),
    stiffness=Number(unit="N/m", least=0, about="pull at the rims for each metre of slip: 2 EA/l"),
    preload=Number(None, "tension of each strand; left out: never slack", unit="N", least=0),
    rest=Many(
        None,
        "openings without slip; left out: those at the start",
        kind=Number(unit="rad"),
        least=2,
        most=2,
    ),
)
def loop(build, it):
    """A closed cable over pulleys on two joints, which so open in the ratio of the radii."""
    rest = [_at_start(build, hinge) for hinge in it.joints] if it.rest is None else it.rest
    preload = np.inf if it.preload is None else it.preload
    build.scene.add(
        SyncLoop(it.name, tuple(it.joints), tuple(it.radii), it.stiffness, tuple(rest), preload)
    )


@statement(
    "actions",
    "motor",
    joint=JOINT,
    turn=Number(None, "by how much it turns, times `curve`; this or `rate`", unit="rad"),
    rate=Number(None, "how fast it turns, times `curve`", unit="rad/s"),
    curve=Reference(**CURVE, about="of the opening, or of its rate"),
    start=Number(None, "opening before the turn; left out: that at the start", unit="rad"),
    stiffness=Number(
        None, "of its drive train; left out: it prescribes exactly", unit="N m/rad", least=0
    ),
    damping=Number(0.0, "of its drive train", unit="N m s/rad", least=0),
)
def motor(build, it):
    """Prescribes the opening of a joint, exactly or through an elastic drive train."""
    start = _at_start(build, it.joint) if it.start is None else it.start
    if (it.turn is None) == (it.rate is None):
        build.refuse("turn", it.turn, "by how much it moves, or a `rate`, not both")
    by_rate = it.turn is None
    how = start, it.rate if by_rate else it.turn, it.curve, by_rate
    if it.stiffness is None:
        if it.damping > 0:
            build.refuse("damping", it.damping, "none without a `stiffness`")
        build.scene.add(RigidMotor(it.joint, *how))
    else:
        build.scene.add(Motor(it.joint, it.stiffness, it.damping, *how))


@statement(
    "actions",
    "torque motor",
    joint=JOINT,
    torque=Number(unit="N m", about="its moment at rest"),
    curve=Reference(None, "scales it with time; left out: constant", **CURVE),
    no_load=Number(
        None, "speed at which no torque is left; left out: it does not fall", unit="rad/s", above=0
    ),
)
def torque_motor(build, it):
    """Moves a joint by a torque, or force, that falls with the speed, evenly down to none."""
    curve = -1 if it.curve is None else it.curve
    no_load = np.inf if it.no_load is None else it.no_load
    build.scene.add(TorqueMotor(it.joint, it.torque, curve, no_load))


@statement(
    "actions",
    "release",
    joint=JOINT,
    stiffness=Number(
        None, "with which it holds; left out: it holds exactly", unit="N m/rad", least=0
    ),
    damping=Number(0.0, "with which it holds", unit="N m s/rad", least=0),
    hold=Number(None, "opening at which it holds; left out: that at the start", unit="rad"),
    time=Number(None, "when it lets go", unit="s", above=0),
    watch=Opening(None, "another joint: it lets go where its opening passes `level`"),
    level=Number(None, "opening of the joint that is watched", unit="rad", joint="watch"),
)
def release(build, it):
    """Holds a joint until a time, or until another has opened so far; the first counts."""
    if it.time is None and it.watch is None:
        build.refuse("time", None, "a time, or a joint to `watch`")
    if (it.watch is None) != (it.level is None):
        build.refuse("level", it.level, "an opening, with a joint to `watch`")
    start = _at_start(build, it.joint)
    hold = start if it.hold is None else it.hold
    when = {
        "time": np.inf if it.time is None else it.time,
        "watch": -1 if it.watch is None else it.watch,
        "level": 0.0 if it.level is None else it.level,
    }
    if it.stiffness is None:
        if it.damping > 0:
            build.refuse("damping", it.damping, "none without a `stiffness`")
        if abs(hold - start) > AT_START:
            unit = unit_of(build.scene, it.joint, "rad")
            build.refuse(
                "hold", hold, f"the opening at the start, {start:g} {unit}, or a `stiffness`"
            )
        build.scene.add(RigidRelease(it.joint, **when))
    else:
        build.scene.add(Release(it.joint, it.stiffness, it.damping, hold=hold, **when))
