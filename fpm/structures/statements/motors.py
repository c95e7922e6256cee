"""What opens joints together, by a motor, or lets them go."""

from fpm.elements import Motor, Release, RigidMotor, RigidRelease, SyncLoop, TorqueMotor
from fpm.elements.openings.opening import unit_of
from fpm.structures.elements import JOINT, acting, element, key_of, keys_of
from fpm.structures.keys import Many, Number, Opening, Reference
from fpm.structures.statement import statement
from fpm.structures.statements.acting import TURNING

AT_START = 1e-9
"""What holds exactly holds where the joint is at the start, to this angle (rad)."""


def _at_start(build, hinge: int) -> float:
    return build.scene.hinges[hinge].opening


@statement(
    "actions",
    "loop",
    joints=Many(kind=TURNING, least=2, most=2, about="the two on which its pulleys sit"),
    **keys_of(SyncLoop, "radii", "stiffness", "preload"),
    rest=key_of(SyncLoop, "rest", "those at the start"),
)
def loop(build, it):
    """A closed cable over pulleys on two joints, which so open in the ratio of the radii."""
    rest = [_at_start(build, hinge) for hinge in it.joints] if it.rest is None else it.rest
    build.scene.add(element(SyncLoop, it, hinges=it.joints, rest=rest))


@statement(
    "actions",
    "motor",
    joint=JOINT,
    turn=Number(None, "by how much it turns, times `curve`; this or `rate`", unit="rad"),
    rate=Number(None, "how fast it turns, times `curve`", unit="rad/s"),
    curve=Reference(about="of the opening, or of its rate", group="curves"),
    start=key_of(Motor, "start", "that at the start"),
    stiffness=key_of(Motor, "stiffness", "it prescribes exactly"),
    damping=key_of(Motor, "damping", default=0.0),
)
def motor(build, it):
    """Prescribes the opening of a joint, exactly or through an elastic drive train."""
    start = _at_start(build, it.joint) if it.start is None else it.start
    if (it.turn is None) == (it.rate is None):
        build.refuse("turn", it.turn, "by how much it moves, or a `rate`, not both")
    by_rate = it.turn is None
    if it.stiffness is None and it.damping > 0:
        build.refuse("damping", it.damping, "none without a `stiffness`")
    kind = RigidMotor if it.stiffness is None else Motor
    turn = it.rate if by_rate else it.turn
    build.scene.add(element(kind, it, start=start, turn=turn, by_rate=by_rate))


torque_motor = acting(TorqueMotor)


@statement(
    "actions",
    "release",
    joint=JOINT,
    stiffness=key_of(Release, "stiffness", "it holds exactly"),
    damping=key_of(Release, "damping", default=0.0),
    hold=key_of(Release, "hold", "that at the start"),
    time=key_of(Release, "time"),
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
    if it.stiffness is None:
        if it.damping > 0:
            build.refuse("damping", it.damping, "none without a `stiffness`")
        if abs(hold - start) > AT_START:
            unit = unit_of(build.scene, it.joint, "rad")
            build.refuse(
                "hold", hold, f"the opening at the start, {start:g} {unit}, or a `stiffness`"
            )
    kind = RigidRelease if it.stiffness is None else Release
    build.scene.add(element(kind, it, hold=hold))
