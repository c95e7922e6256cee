"""Struts between two points of any parts: springs, dampers, gas springs, constant forces."""

from dataclasses import replace

from fpm.declare import NO_VALUE, Number, Word
from fpm.elements import Strut
from fpm.elements.cables.strut import gas_table
from fpm.structures.keys import ListKey, PointKey
from fpm.structures.statement import CLASS, statement

ENDS = ListKey(kind=PointKey(), least=2, most=2, text="its two points, of different parts")
DAMPING = Number(0.0, "force for a rate of its length, both ways", unit="N s/m", least=0)
FORCES = ListKey(kind=Number(unit="N"), least=2, text="one for each length, > 0 where it pushes")
SIDES = {"both ways": (1.0, 1.0), "push": (1.0, 0.0), "pull": (0.0, 1.0)}


def _add(build, args, lengths, forces, slopes=(0.0, 0.0)) -> None:
    """Add a Strut to the scene of `build`. args: values of an entry; lengths (m), forces (N),
    slopes (N/m): of the Strut."""
    points = [(part.particle(point.name), point.position) for part, point in args.between]
    if points[0][0] == points[1][0] or not _length(build, args) > 0:
        places = " and ".join(f"{point.name} of {part.name}" for part, point in args.between)
        build.refuse("between", places, "points of two parts, or of two ends of a bar, apart")
    for particle, _ in points:
        build.joints_of.setdefault(particle, [])
    beams = tuple(build.scene.arm_to(particle, place) for particle, place in points)
    build.scene.add(Strut(args.name, beams, tuple(lengths), tuple(forces), slopes, args.damping))


def _length(build, args) -> float:
    """Length (m) of a strut at the start."""
    (_, first), (_, second) = args.between
    return sum((first.position - second.position) ** 2) ** 0.5


@statement(
    "struts",
    "spring",
    between=ENDS,
    stiffness=Number(unit="N/m", least=0, text="force for a change of its length"),
    rest=Number(None, "its length without force; this or `preload`", unit="m", above=0),
    preload=Number(None, "its force at the start, > 0 where it pushes", unit="N"),
    acts=Word("both ways", "`push`, `pull`: only so, else slack", values=tuple(SIDES)),
    damping=replace(DAMPING, text=DAMPING.text + "; 0 where it acts one way"),
    **CLASS,
)
def spring(build, args):
    """Pushes or pulls two points towards a distance."""
    if (args.rest is None) == (args.preload is None):
        pair = None if args.rest is None else [args.rest, args.preload]
        build.refuse("rest", pair, "either `rest` or `preload`")
    if args.rest is None and not args.stiffness > 0:
        build.refuse("stiffness", args.stiffness, "above 0, with a `preload`")
    if args.preload and args.acts == ("pull" if args.preload > 0 else "push"):
        build.refuse("preload", args.preload, f"one that a strut may have that acts in {args.acts}")
    rest = args.rest
    if rest is None:
        rest = _length(build, args) + args.preload / args.stiffness
        if not rest > 0:
            build.refuse("preload", args.preload, "one with a length without force above 0 m")
    sides = SIDES[args.acts]
    if args.acts != "both ways" and args.damping:
        build.refuse("damping", args.damping, "0 where it acts one way: a damper of its own")
    _add(build, args, [rest], [0.0], tuple(-args.stiffness * side for side in sides))


@statement(
    "struts",
    "tabulated spring",
    between=ENDS,
    lengths=ListKey(kind=Number(unit="m", above=0), least=2, text="increasing"),
    forces=FORCES,
    damping=DAMPING,
    **CLASS,
)
def tabulated_spring(build, args):
    """Pushes or pulls two points by a table over their distance, constant beyond its ends."""
    _add(build, args, args.lengths, args.forces)
    if not vars(args)["class"]:
        build.scene.classes[Strut, len(Strut.find(build.scene)) - 1] = "HA"  # as tables on joints


@statement(
    "struts",
    "gas spring",
    between=ENDS,
    force=Number(unit="N", above=0, text="with which it pushes all the way out"),
    length=Number(unit="m", above=0, text="of it, all the way out"),
    stroke=Number(unit="m", above=0, text="how far it goes in"),
    ratio=Number(unit="", above=1, text="force all the way in over `force`"),
    exponent=Number(1.0, "of the gas: 1 slow, 1.4 fast", unit="", least=1),
    damping=DAMPING,
    **CLASS,
)
def gas_spring(build, args):
    """Pushes two points apart by an enclosed gas; its force is constant beyond its stroke."""
    if not args.stroke < args.length:
        build.refuse("stroke", args.stroke, f"below the length, {args.length:g} m")
    table = gas_table(args.force, args.length, args.stroke, args.ratio, args.exponent)
    least, start = args.length - args.stroke, _length(build, args)
    if not least * (1 - 1e-9) <= start <= args.length * (1 + 1e-9):
        text = f"at least {start:.4g} m, the distance of its points at the start, and at most its "
        build.refuse("length", args.length, f"{text}stroke, {args.stroke:.4g} m, more")
    _add(build, args, *table)


@statement(
    "struts",
    "constant force",
    between=ENDS,
    force=Number(unit="N", text="> 0 where it pushes"),
    damping=DAMPING,
    **CLASS,
)
def constant_force(build, args):
    """Pushes or pulls two points with the same force at any distance."""
    _add(build, args, [_length(build, args)], [args.force])


@statement("struts", "damper", between=ENDS, damping=replace(DAMPING, default=NO_VALUE))
def damper(build, args):
    """Resists changes of the distance of two points."""
    _add(build, args, [_length(build, args)], [0.0])
