"""What acts on a joint's opening."""

from dataclasses import replace

from fpm.elements import (
    Contact,
    Damper,
    Friction,
    Latch,
    RigidFriction,
    RigidLatch,
    Stop,
    TableSpring,
    TorsionSpring,
)
from fpm.elements.openings.friction import BEND, SLIDE_BEND
from fpm.elements.openings.opening import unit_of
from fpm.structures.elements import JOINT, acting, element, key_of, keys_of
from fpm.structures.keys import Choice, Many, Number
from fpm.structures.statement import statement

TURNING = replace(JOINT, types=("revolute", "universal"))

contact = acting(Contact)
damper = acting(Damper)


def _add_spring(build, it) -> None:
    """A spring at rest at an opening, or such that it has its preload at the start."""
    rest = it.rest
    if it.preload is not None:
        if rest != 0.0:
            build.refuse("rest", rest, "none, with a `preload`")
        if not it.stiffness > 0:
            build.refuse("stiffness", it.stiffness, "above 0, with a `preload`")
        rest = build.scene.hinges[it.joint].opening + it.preload / it.stiffness
    build.scene.add(element(TorsionSpring, it, rest=rest))


@statement(
    "actions",
    "torsion spring",
    joint=replace(TURNING, hint="; for a slide there is `spring`"),
    **keys_of(TorsionSpring, "stiffness", "rest"),
    preload=Number(None, "moment at the start, > 0 where it opens, for `rest`", unit="N m"),
)
def torsion_spring(build, it):
    """Turns a joint towards an opening."""
    _add_spring(build, it)


@statement(
    "actions",
    "spring",
    joint=replace(JOINT, types=("prismatic",)),
    stiffness=key_of(TorsionSpring, "stiffness", unit="N/m", about="force for each metre"),
    rest=key_of(TorsionSpring, "rest", unit="m"),
    preload=Number(None, "force at the start, > 0 where it opens, for `rest`", unit="N"),
)
def spring(build, it):
    """Pushes or pulls a slide towards an opening."""
    _add_spring(build, it)


@statement(
    "actions",
    "friction",
    joint=JOINT,
    moment=key_of(Friction, "moment"),
    bend=key_of(Friction, "bend", f"{BEND:g} rad, {1e3 * SLIDE_BEND:g} mm"),
    damping=key_of(Friction, "damping"),
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
    build.scene.add(element(Friction, it, bend=it.bend or (SLIDE_BEND if slides else BEND)))


@statement(
    "actions",
    "stop",
    joint=JOINT,
    least=Number(None, "opening below which it acts; this, `most`, or both", unit="rad"),
    most=Number(None, "opening above which it acts", unit="rad"),
    **keys_of(Stop, "stiffness", "damping"),
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


@statement(
    "actions",
    "latch",
    joint=JOINT,
    **keys_of(Latch, "angle", "tolerance", "side", "fastest"),
    stiffness=key_of(Latch, "stiffness", "it holds exactly"),
    damping=key_of(Latch, "damping"),
    holds=Choice("both ways", "`one way`: only against going back",
                 options=("both ways", "one way")),
)  # fmt: skip
def latch(build, it):
    """Catches a joint at an opening and holds it from then on."""
    one_sided = it.holds == "one way"
    if it.stiffness is None:
        for key, given in (("damping", it.damping > 0), ("holds", one_sided)):
            if given:
                build.refuse(key, getattr(it, key), "none without a `stiffness`")
    kind = RigidLatch if it.stiffness is None else Latch
    build.scene.add(element(kind, it, one_sided=one_sided))


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
    build.scene.add(element(TableSpring, it))
