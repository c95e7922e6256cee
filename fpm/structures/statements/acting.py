"""What acts on the openings of joints: springs, dampers, latches, motors and the like."""

from dataclasses import replace

import numpy as np

from fpm.elements import (
    Contact,
    Damper,
    Friction,
    Latch,
    Motor,
    Release,
    RigidFriction,
    RigidLatch,
    RigidMotor,
    RigidRelease,
    Stop,
    SyncLoop,
    TableSpring,
    TorqueMotor,
    TorsionSpring,
)
from fpm.elements.openings.friction import BEND, SLIDE_BEND
from fpm.elements.openings.opening import unit_of
from fpm.structures.keys import Choice, Many, Number, Opening, Reference
from fpm.structures.statement import CLASS, JOINT, SLIDE, acting, element, key_of, statement, whole

TURNING = replace(JOINT, types=("revolute", "universal"))
AT_START = 1e-9
"""What holds exactly holds where the joint is at the start, to this angle (rad)."""


def _at_start(build, hinge: int) -> float:
    return build.scene.hinges[hinge].opening


def _rigid(build, it, **without) -> bool:
    """Whether it holds exactly, having no stiffness; then it has none of what needs one either."""
    for key, given in without.items() if it.stiffness is None else ():
        if given:
            build.refuse(key, getattr(it, key), "none without a `stiffness`")
    return it.stiffness is None


def _of_slide(key: Number) -> Number:
    about = key.text.replace("moment", "force").replace("radian", "metre")
    return replace(key.sliding(["joint"]), text=about)


SPRING = {
    "stiffness": key_of(TorsionSpring, "stiffness"),
    "rest": key_of(TorsionSpring, "rest"),
    "preload": Number(None, "moment at the start, > 0 where it opens, for `rest`", unit="N m"),
    **CLASS,
}


@statement(
    "actions",
    "torsion spring",
    joint=replace(TURNING, hint="; for a slide there is `spring`"),
    **SPRING,
)
def torsion_spring(build, it):
    """Turns a joint towards an opening."""
    rest = it.rest
    if it.preload is not None:
        if rest != 0.0:
            build.refuse("rest", rest, "none, with a `preload`")
        if not it.stiffness > 0:
            build.refuse("stiffness", it.stiffness, "above 0, with a `preload`")
        rest = _at_start(build, it.joint) + it.preload / it.stiffness
    build.scene.add(element(TorsionSpring, it, rest=rest))


statement(
    "actions",
    "spring",
    "Pushes or pulls a slide towards an opening.",
    joint=replace(JOINT, types=(SLIDE,)),
    **{name: key if name in CLASS else _of_slide(key) for name, key in SPRING.items()},
)(torsion_spring.build)

whole(Contact)
whole(Damper)


@acting(
    Friction,
    left_out={"bend": f"{BEND:g} rad, {1e3 * SLIDE_BEND:g} mm"},
    sticks=Choice("by its bend", "`exactly`: without any bend",
                  options=("by its bend", "exactly")),
)  # fmt: skip
def friction(build, it):
    """Dry (Coulomb) friction in a joint."""
    slides = build.scene.hinges[it.joint].slides
    if it.sticks == "exactly":
        if it.bend is not None or it.damping is not None:
            build.refuse("sticks", it.sticks, "by its bend, or neither `bend` nor `damping`")
        if slides:
            build.refuse("sticks", it.sticks, "by its bend, on a slide")
        build.scene.add(element(RigidFriction, it))
        return
    build.scene.add(element(Friction, it, bend=it.bend or _bend(build.scene, it.joint)))


def _bend(scene, hinge: int) -> float:
    return SLIDE_BEND if scene.hinges[hinge].slides else BEND


@statement(
    "actions",
    "bearing",
    joint=JOINT,
    mu=Number(text="coefficient of friction", least=0),
    radius=Number(None, "at which it rubs; of hinges only", unit="m", above=0),
    load=Number(
        None, "force that the joint bears as a rule, at which it gives by `bend` before it slips; "
        "left out: it counts in margins only, and a motion has none of it", unit="N", above=0,
    ),
    bend=key_of(Friction, "bend", default=None, text="left out: as that of friction"),
)  # fmt: skip
def bearing(build, it):
    """Friction by the force that a joint itself bears."""
    scene, lever = build.scene, it.mu * (1.0 if it.radius is None else it.radius)
    if scene.hinges[it.joint].slides == (it.radius is not None):
        build.refuse("radius", it.radius, "a length on a hinge, and none on a slide")
    joint = scene.hinges[it.joint].joint
    parts = sum(names.count(joint) for names in build.joined.values())
    if parts > 2:  # which of them press on each other is the pin's design, and not known
        build.refuse(
            "joint", f"{joint} (of {parts} parts)", "a joint of two parts: state the pin as joints "
            "of those two that rub on each other, each with its bearing"
        )  # fmt: skip
    if it.load is None:
        scene.bearings[it.joint] += lever
        return
    bend = it.bend or _bend(scene, it.joint)
    scene.add(Friction(it.joint, lever * it.load, bend, load=it.load))


@acting(
    Stop,
    without=("angle", "side"),
    least=Number(None, "opening below which it acts; this, `most`, or both", unit="rad"),
    most=Number(None, "opening above which it acts", unit="rad"),
)
def stop(build, it):
    """Keeps the opening of a joint from going further; never pulls."""
    if it.least is None and it.most is None:
        build.refuse("least", None, "`least`, `most`, or both")
    if it.least is not None and it.most is not None and it.least >= it.most:
        unit = unit_of(build.scene, it.joint, "rad")
        build.refuse("least", it.least, f"an opening below `most`, {it.most:g} {unit}")
    for angle, side in ((it.least, "below"), (it.most, "above")):
        if angle is not None:
            build.scene.add(element(Stop, it, angle=angle, side=side))


@acting(
    Latch,
    without=("one_sided", "name"),
    left_out={"stiffness": "it holds exactly"},
    holds=Choice("both ways", "`one way`: only against going back",
                 options=("both ways", "one way")),
)  # fmt: skip
def latch(build, it):
    """Catches a joint at an opening and holds it from then on."""
    one_sided = it.holds == "one way"
    rigid = _rigid(build, it, damping=it.damping > 0, holds=one_sided)
    build.scene.add(element(RigidLatch if rigid else Latch, it, one_sided=one_sided))


MOMENTS = Many(
    kind=Number(unit="N m"), least=2, text="one for each, > 0 where it opens; straight between"
)


@statement(
    "actions",
    "tape spring",
    joint=JOINT,
    angles=Many(kind=Number(unit="rad"), least=2, text="openings, increasing"),
    moments=MOMENTS,
    back=replace(
        MOMENTS, default=None, text="on the way back, none below `moments`; left out: the same"
    ),
    bend=key_of(
        Friction, "bend", default=None,
        text="half of the way from one branch to the other; left out: as that of friction",
    ),
    **CLASS,
)  # fmt: skip
def tape_spring(build, it):
    """Moves a joint by a moment, or force, that a table gives: a tape spring, a harness.

    With `back` the mean of both is the spring's, and what depends on the sense is hysteresis.
    """
    scene, there = build.scene, np.array(it.moments)
    back = there if it.back is None else np.array(it.back)
    if len(back) != len(there) or np.any(back < there):
        build.refuse("back", it.back, "one for each opening, none below that on the way there")
    scene.add(element(TableSpring, it, moments=tuple((there + back) / 2)))
    if it.back is not None:
        most = float((back - there).max() / 2)
        shares = tuple((back - there) / 2 / (most or 1.0))
        bend = it.bend or _bend(scene, it.joint)
        drag = Friction(it.joint, most, bend, angles=tuple(it.angles), shares=shares)
        scene.classes[Friction, scene.add(drag)] = "HY"


@acting(
    SyncLoop,
    without=("hinges", "name"),
    left_out={"rest": "those at the start"},
    joints=Many(kind=TURNING, least=2, most=2, text="the two on which its pulleys sit"),
)
def loop(build, it):
    """A closed cable over pulleys on two joints, which so open in the ratio of the radii."""
    rest = [_at_start(build, hinge) for hinge in it.joints] if it.rest is None else it.rest
    build.scene.add(element(SyncLoop, it, hinges=it.joints, rest=rest))


@acting(
    Motor,
    without=("by_rate",),
    left_out={"start": "that at the start", "stiffness": "it prescribes exactly"},
    damping=key_of(Motor, "damping", default=0.0),
    turn=Number(None, "by how much it turns, times `curve`; this or `rate`", unit="rad"),
    rate=Number(None, "how fast it turns, times `curve`", unit="rad/s"),
    curve=Reference(text="of the opening, or of its rate", group="curves"),
)
def motor(build, it):
    """Prescribes the opening of a joint, exactly or through an elastic drive train."""
    start = _at_start(build, it.joint) if it.start is None else it.start
    if (it.turn is None) == (it.rate is None):
        build.refuse("turn", it.turn, "by how much it moves, or a `rate`, not both")
    kind = RigidMotor if _rigid(build, it, damping=it.damping > 0) else Motor
    by_rate = it.turn is None
    turn = it.rate if by_rate else it.turn
    build.scene.add(element(kind, it, start=start, turn=turn, by_rate=by_rate))


whole(TorqueMotor)


@acting(
    Release,
    left_out={"stiffness": "it holds exactly", "hold": "that at the start"},
    damping=key_of(Release, "damping", default=0.0),
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
    rigid = _rigid(build, it, damping=it.damping > 0)
    if rigid and abs(hold - start) > AT_START:
        unit = unit_of(build.scene, it.joint, "rad")
        build.refuse("hold", hold, f"the opening at the start, {start:g} {unit}, or a `stiffness`")
    build.scene.add(element(RigidRelease if rigid else Release, it, hold=hold))
