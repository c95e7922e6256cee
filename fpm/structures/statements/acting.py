"""What acts on a joint's opening."""

from dataclasses import replace

import numpy as np

from fpm.elements import Damper, Friction, Latch, RigidFriction, RigidLatch, Stop, TableSpring
from fpm.elements.openings.friction import BEND, SLIDE_BEND
from fpm.elements.openings.opening import unit_of
from fpm.structures.keys import Choice, Many, Number, Opening
from fpm.structures.statement import statement

JOINT = Opening(about="on which joint it acts")
TURNING = replace(JOINT, types=("revolute", "universal"))


def _add_spring(build, it) -> None:
    """A spring at rest at an opening, or such that it has its preload at the start."""
    rest = it.rest
    if it.preload is not None:
        if rest != 0.0:
            build.refuse("rest", rest, "none, with a `preload`")
        if not it.stiffness > 0:
            build.refuse("stiffness", it.stiffness, "above 0, with a `preload`")
        rest = build.scene.hinges[it.joint].opening + it.preload / it.stiffness
    build.scene.add_torsion_spring(it.joint, it.stiffness, rest)


@statement(
    "actions",
    "torsion spring",
    joint=replace(TURNING, hint="; for a slide there is `spring`"),
    stiffness=Number(unit="N m/rad", least=0, about="moment for each radian"),
    rest=Number(0.0, "opening at which it is at rest", unit="rad"),
    preload=Number(None, "moment at the start, > 0 where it opens, for `rest`", unit="N m"),
)
def torsion_spring(build, it):
    """Turns a joint towards an opening."""
    _add_spring(build, it)


@statement(
    "actions",
    "spring",
    joint=replace(JOINT, types=("prismatic",)),
    stiffness=Number(unit="N/m", least=0, about="force for each metre"),
    rest=Number(0.0, "opening at which it is at rest", unit="m"),
    preload=Number(None, "force at the start, > 0 where it opens, for `rest`", unit="N"),
)
def spring(build, it):
    """Pushes or pulls a slide towards an opening."""
    _add_spring(build, it)


@statement(
    "actions",
    "contact",
    joint=replace(JOINT, types=("revolute",)),
    stiffness=Number(unit="N m/rad", least=0, about="moment for each radian below zero"),
)
def contact(build, it):
    """Faces that touch where the opening of a revolute joint is below zero."""
    build.scene.add_contact(it.joint, it.stiffness)


@statement(
    "actions",
    "damper",
    joint=JOINT,
    damping=Number(unit="N m s/rad", least=0, about="moment for each radian a second"),
)
def damper(build, it):
    """Resists the motion of a joint, in proportion to its rate."""
    build.scene.add(Damper(it.joint, it.damping))


@statement(
    "actions",
    "friction",
    joint=JOINT,
    moment=Number(unit="N m", least=0, about="at which it slips; below, it sticks for ever"),
    bend=Number(
        None, unit="rad", above=0,
        about="by how much it gives before it slips; left out: "
        f"{BEND:g} rad, {1e3 * SLIDE_BEND:g} mm",
    ),
    damping=Number(
        None, "while it sticks; left out: 0.3 of critical for the joint's own two particles",
        unit="N m s/rad", least=0,
    ),
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
        build.scene.add(RigidFriction(it.joint, it.moment))
        return
    bend = it.bend or (SLIDE_BEND if slides else BEND)
    build.scene.add(Friction(it.joint, it.moment, bend, it.damping))


@statement(
    "actions",
    "stop",
    joint=JOINT,
    least=Number(None, "opening below which it acts; this, `most`, or both", unit="rad"),
    most=Number(None, "opening above which it acts", unit="rad"),
    stiffness=Number(unit="N m/rad", least=0, about="moment for each radian beyond"),
    damping=Number(0.0, "moment for each radian a second, beyond", unit="N m s/rad", least=0),
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
            build.scene.add(Stop(it.joint, angle, side, it.stiffness, it.damping))


@statement(
    "actions",
    "latch",
    joint=JOINT,
    angle=Number(unit="rad", about="opening at which it catches"),
    tolerance=Number(0.0, "how far from `angle` it catches as well", unit="rad", least=0),
    side=Choice("either", "from where the opening comes when it is caught",
                options=("below", "above", "either")),
    fastest=Number(None, "rate above which it does not catch", unit="rad/s", above=0),
    stiffness=Number(None, "with which it holds; left out: it holds exactly", unit="N m/rad",
                     least=0),
    damping=Number(0.0, "with which it holds", unit="N m s/rad", least=0),
    holds=Choice("both ways", "`one way`: only against going back",
                 options=("both ways", "one way")),
)  # fmt: skip
def latch(build, it):
    """Catches a joint at an opening and holds it from then on."""
    fastest = np.inf if it.fastest is None else it.fastest
    if it.stiffness is None:
        for key, given in (("damping", it.damping > 0), ("holds", it.holds == "one way")):
            if given:
                build.refuse(key, getattr(it, key), "none without a `stiffness`")
        build.scene.add(RigidLatch(it.joint, it.angle, it.tolerance, it.side, fastest, it.name))
        return
    build.scene.add(
        Latch(
            it.joint, it.angle, it.stiffness, it.damping, it.tolerance, it.side, fastest,
            it.holds == "one way", it.name,
        )
    )  # fmt: skip


@statement(
    "actions",
    "tape spring",
    joint=JOINT,
    angles=Many(kind=Number(unit="rad"), least=2, about="openings, increasing"),
    moments=Many(
        kind=Number(unit="N m"), least=2, about="one for each, > 0 where it opens; straight between"
    ),
)
def tape_spring(build, it):
    """Moves a joint by a moment, or force, that a table gives, with a peak and a plateau, say."""
    build.scene.add(TableSpring(it.joint, tuple(it.angles), tuple(it.moments)))
