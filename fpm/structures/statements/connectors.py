"""What acts on the openings of joints: springs, dampers, latches, motors and the like."""

from dataclasses import replace
from typing import Any

import numpy as np

from fpm import elements
from fpm.declare import Number, Word
from fpm.elements.openings.friction import DEFLECTION, SLIDE_DEFLECTION
from fpm.elements.openings.journal import PIN
from fpm.elements.openings.motor import AT_START
from fpm.elements.openings.opening import unit_of
from fpm.structures.keys import ListKey, ReferenceKey, WatchKey
from fpm.structures.statement import CLASS, JOINT, connector, element, key_of, statement

ANGLE_JOINT = replace(JOINT, slides=False)


def _of_slide(key: Any) -> Number:
    text = key.text.replace("moment", "force").replace("radian", "metre")
    return replace(key.for_slides(["joint"]), text=text)


SPRING = {
    "stiffness": key_of(elements.TorsionSpring, "stiffness"),
    "rest": key_of(elements.TorsionSpring, "rest"),
    "preload": Number(
        None, "moment at the start, positive if it opens the joint; instead of `rest`", unit="N m"
    ),
    **CLASS,
}


@statement(
    "actions",
    "torsion spring",
    joint=replace(ANGLE_JOINT, hint="; for a slide there is `spring`"),
    **SPRING,
)
def torsion_spring(build, args):
    """A torsion spring that turns a joint towards an opening."""
    rest = args.rest
    if args.preload is not None:
        if rest != 0.0:
            build.refuse("rest", rest, "none, with a `preload`")
        if not args.stiffness > 0:
            build.refuse("stiffness", args.stiffness, "above 0, with a `preload`")
        rest = build.scene.hinges[args.joint].opening + args.preload / args.stiffness
    build.scene.add(element(elements.TorsionSpring, args, rest=rest))


statement(
    "actions",
    "spring",
    "A spring that pushes or pulls a slide towards an opening.",
    joint=replace(JOINT, slides=True),
    **{name: key if name in CLASS else _of_slide(key) for name, key in SPRING.items()},
)(torsion_spring.build)

DEFLECTION_KEY = key_of(elements.Friction, "bristle_deflection", default=None)


@connector(
    elements.Friction,
    bristle_deflection=replace(
        DEFLECTION_KEY,
        text=f"{DEFLECTION_KEY.text}; default: {DEFLECTION:g} rad, {1e3 * SLIDE_DEFLECTION:g} mm",
    ),
    sticks=Word(
        "bristle", "`exactly`: it sticks without any deflection", values=("bristle", "exactly")
    ),
)
def friction(build, args):
    """Dry (Coulomb) friction in a joint."""
    if args.sticks == "exactly":
        if args.bristle_deflection is not None or args.damping is not None:
            allowed = "bristle, or neither `bristle_deflection` nor `damping`"
            build.refuse("sticks", args.sticks, allowed)
        build.scene.add(elements.Friction(args.joint, args.moment, None))
        return
    deflection = _deflection(build, args)
    build.scene.add(element(elements.Friction, args, bristle_deflection=deflection))


def _deflection(build, args) -> float:
    """The deflection of bristles that an entry states, or that which is usual on its joint."""
    slides = build.scene.hinges[args.joint].slides
    return args.bristle_deflection or (SLIDE_DEFLECTION if slides else DEFLECTION)


BEARING_LOAD = (
    "typical force in the joint, at which the friction slips after `bristle_deflection`; "
    "default: it counts in margins only and does not act in runs"
)


@statement(
    "actions",
    "bearing",
    joint=JOINT,
    mu=Number(text="coefficient of friction", least=0),
    radius=Number(None, "radius at which friction acts; for hinges only", unit="m", above=0),
    load=Number(None, BEARING_LOAD, unit="N", above=0),
    bristle_deflection=replace(
        DEFLECTION_KEY, text="deflection at which it slips; default: that of friction"
    ),
)
def bearing(build, args):
    """Friction in proportion to the force in a joint; a couple in the joint is not counted."""
    scene, lever = build.scene, args.mu * (1.0 if args.radius is None else args.radius)
    if scene.hinges[args.joint].slides == (args.radius is not None):
        build.refuse("radius", args.radius, "a length on a hinge, and none on a slide")
    joint = scene.hinges[args.joint].joint
    if scene.hinges[args.joint].type == PIN:
        build.refuse("joint", joint, f"another joint: a {PIN} has its own `friction`")
    parts = sum(names.count(joint) for names in build.joints_of.values())
    if parts > 2:  # which of them press on each other is the pin's design, and not known
        pin = "state the pin as joints of those two that rub on each other, each with its bearing"
        build.refuse("joint", f"{joint} (of {parts} parts)", f"a joint of two parts: {pin}")
    if args.load is None:
        scene.bearings[args.joint] += lever
        return
    deflection = _deflection(build, args)
    scene.add(elements.Friction(args.joint, lever * args.load, deflection, load=args.load))


@connector(
    elements.Stop,
    lower=Number(None, "opening below which it acts; give `lower`, `upper`, or both", unit="rad"),
    upper=Number(None, "opening above which it acts", unit="rad"),
)
def stop(build, args):
    """A stop, which keeps the opening of a joint from going further and never pulls."""
    if args.lower is None and args.upper is None:
        build.refuse("lower", None, "`lower`, `upper`, or both")
    if args.lower is not None and args.upper is not None and args.lower >= args.upper:
        unit = unit_of(build.scene, args.joint, "rad")
        build.refuse("lower", args.lower, f"an opening below `upper`, {args.upper:g} {unit}")
    for angle, side in ((args.lower, "below"), (args.upper, "above")):
        if angle is not None:
            build.scene.add(element(elements.Stop, args, angle=angle, side=side))


MOMENTS = ListKey(
    kind=Number(unit="N m"), least=2, text="one for each, > 0 where it opens; straight between"
)


@statement(
    "actions",
    "tabulated spring",
    joint=JOINT,
    angles=ListKey(kind=Number(unit="rad"), least=2, text="openings, increasing"),
    moments=MOMENTS,
    back=replace(
        MOMENTS,
        default=None,
        text="moments on the way back, at least `moments`; default: equal to `moments`",
    ),
    bristle_deflection=replace(
        DEFLECTION_KEY,
        text="half the change of opening between the two branches; default: that of friction",
    ),
    **CLASS,
)
def tabulated_spring(build, args):
    """A moment or force on a joint by a table, such as that of a tape spring or a harness."""
    scene, loading = build.scene, np.array(args.moments)
    unloading = loading if args.back is None else np.array(args.back)
    if len(unloading) != len(loading) or np.any(unloading < loading):
        build.refuse("back", args.back, "one for each opening, none below that on the way there")
    scene.add(element(elements.TableSpring, args, moments=tuple((loading + unloading) / 2)))
    if args.back is not None:
        most = float((unloading - loading).max() / 2)
        shares = tuple((unloading - loading) / 2 / (most or 1.0))
        table = {"angles": tuple(args.angles), "shares": shares}
        drag = elements.Friction(args.joint, most, _deflection(build, args), **table)
        scene.classes[elements.Friction, scene.add(drag)] = "HY"


@connector(
    elements.SyncLoop,
    rest=key_of(
        elements.SyncLoop,
        "rest",
        default=None,
        text="openings at which the loop exerts no force; default: those at the start",
    ),
    joints=ListKey(kind=ANGLE_JOINT, least=2, most=2, text="the two joints of its pulleys"),
)
def loop(build, args):
    """A closed cable over pulleys on two joints, which open in the ratio of the radii."""
    rest = (
        [build.scene.hinges[hinge].opening for hinge in args.joints]
        if args.rest is None
        else args.rest
    )
    build.scene.add(element(elements.SyncLoop, args, hinges=args.joints, rest=rest))


@connector(
    elements.Motor,
    start=key_of(
        elements.Motor,
        "start",
        default=None,
        text="opening before the turn; default: that at the start",
    ),
    turn=Number(None, "angle of its turn, times `curve`; this or `rate`", unit="rad"),
    rate=Number(None, "rate of the opening, multiplied by `curve`", unit="rad/s"),
    curve=ReferenceKey(text="curve of the opening, or of its rate", group="curves"),
)
def motor(build, args):
    """Prescribes the opening of a joint, exactly or through an elastic drive train."""
    start = build.scene.hinges[args.joint].opening if args.start is None else args.start
    if (args.turn is None) == (args.rate is None):
        build.refuse("turn", args.turn, "by how much it moves, or a `rate`, not both")
    by_rate = args.turn is None
    turn = args.rate if by_rate else args.turn
    build.scene.add(element(elements.Motor, args, start=start, turn=turn, by_rate=by_rate))


@connector(
    elements.Release,
    watch=WatchKey(
        None,
        "another joint, whose opening passes `level` at the release; or a latch, which catches "
        "at the release",
    ),
    level=Number(None, "opening of the watched joint at the release", unit="rad", joint="watch"),
)
def release(build, args):
    """Holds a joint until a time, an opening of another joint, or the catch of a latch."""
    latch = args.watch if isinstance(args.watch, str) else ""
    if args.time is None and args.watch is None:
        build.refuse("time", None, "a time, or a joint or latch to `watch`")
    if latch and args.level is not None:
        build.refuse("level", args.level, f"none, as it watches the latch {latch}")
    if not latch and (args.watch is None) != (args.level is None):
        build.refuse("level", args.level, "an opening, with a joint to `watch`")
    start = build.scene.hinges[args.joint].opening
    hold = start if args.hold is None else args.hold
    is_exact = args.stiffness is None
    if is_exact and build.is_balanced:
        build.openings[args.joint] = hold
    elif is_exact and abs(hold - start) > AT_START:
        unit = unit_of(build.scene, args.joint, "rad")
        allowed = (
            f"the opening at the start, {start:g} {unit}, a `stiffness`, or `start: equilibrium`"
        )
        build.refuse("hold", hold, allowed)
    watch = None if latch else args.watch
    hold = None if is_exact else hold
    build.scene.add(element(elements.Release, args, hold=hold, watch=watch, latch=latch))
