"""What comes from outside or moves: loads, prescribed motion, cables, struts, motion at the start;
and the points whose motion is recorded."""

from contextlib import suppress
from dataclasses import replace
from functools import lru_cache, partial
from itertools import compress

import numpy as np

from fpm.arithmetic.expressions import Expression, ExpressionError
from fpm.declare import NO_VALUE, Number, Word
from fpm.elements import Drag, Load, Strut
from fpm.elements.cables.strut import gas_table
from fpm.elements.joints.hinge import list_names
from fpm.elements.joints.joint import Joint
from fpm.elements.particles.drag import stations
from fpm.errors import SceneError
from fpm.scenes.curve import Curve, CurveError
from fpm.structures.builder import POINT_TOL
from fpm.structures.keys import (
    CurveExpressionKey,
    CurvesKey,
    DirectionKey,
    LettersKey,
    ListKey,
    OpeningKey,
    PointKey,
    ReferenceKey,
    TextKey,
    VectorKey,
)
from fpm.structures.statement import CLASS, statement

ZERO = np.zeros(3)
MASSLESS = 1e-30
"""Mass (kg) and inertia (kg m2) of a particle that only leads a point."""

PART = ReferenceKey(group="parts", text="part that has the point")
POINT = ReferenceKey(group="points", text="point of the part")
CURVE_KEYS = ["times", "values", "file", "column", "expression", "over"]
CURVE = ReferenceKey(None, "curve that scales it over time; default: constant", group="curves")


@statement(
    "curves",
    times=ListKey(
        None,
        "increasing times. Give `times` and `values`, or `file` and `column`, or `expression` "
        "and `over`",
        kind=Number(unit="s"),
    ),
    values=ListKey(None, "one value for each time", kind=Number()),
    file=CurvesKey(None, "CSV file of curves of time, with units"),
    column=TextKey(None, "name of the column whose numbers, converted to SI units, are the values"),
    smooth=Word(
        "false", "whether monotone cubics join the values, with zero slope at both ends",
        values=("true", "false"),
    ),
    expression=CurveExpressionKey(
        None, "expression of u, which goes from 0 to 1 over `over`, or of the time t"
    ),
    over=ListKey(None, "start and end of the expression", Number(unit="s"), 2, 2),
)  # fmt: skip
def curve(build, args):
    """A curve of time, through values or from an expression; constant before and after it."""
    keys = [key for key in CURVE_KEYS if getattr(args, key) is not None]
    if keys not in (CURVE_KEYS[:2], CURVE_KEYS[2:4], CURVE_KEYS[4:]):
        allowed = "`times` and `values`, or `file` and `column`, or `expression` and `over`"
        build.refuse(keys[-1] if keys else "times", ", ".join(keys) or None, allowed)
    smooth = args.smooth == "true"
    if args.expression is not None:
        if smooth:
            build.refuse("smooth", args.smooth, "false: an expression is as smooth as it says")
        expression, numbers = args.expression
        if not args.over[0] < args.over[1]:
            build.refuse("over", args.over, "a start, and an end that is later")
        items = tuple((name, np.asarray(value, float).tobytes()) for name, value in numbers.items())
        try:
            build.scene.curves.append(_fit(expression, items, *args.over))
        except CurveError as error:
            allowed = f"a finite function without jumps; {error}"
            build.refuse("expression", expression.text, allowed)
        return len(build.scene.curves) - 1
    if args.file is None:
        if len(args.times) != len(args.values):
            build.refuse("values", args.values, f"{len(args.times)} numbers, one for each time")
        return build.scene.add_curve(args.times, args.values, smooth)
    column = args.column
    if column not in args.file.columns:
        allowed = f"a column of the file, {', '.join((*args.file.columns, *args.file.faults))}"
        raise SceneError("column", column, allowed, args.file.faults.get(column, ""))
    build.scene.doubts += args.file.doubts
    return build.scene.add_curve(args.file.times, args.file.columns[column], smooth)


@lru_cache(maxsize=64)
def _fit(expression: Expression, numbers: tuple, start: float, end: float) -> Curve:
    """Return the curve that an expression is from a time `start` to another, `end` (s). numbers:
    names and values, numbers or vectors, as bytes, which can be hashed."""
    arrays = {name: np.frombuffer(data) for name, data in numbers}
    numbers_by_name = {name: a if a.size > 1 else float(a[0]) for name, a in arrays.items()}

    def value(u: float) -> float:
        time = start + u * (end - start)
        try:
            return expression.value({**numbers_by_name, "u": u, "t": time})
        except ExpressionError as error:
            raise CurveError(f"at {time:.9g} s it is {error}") from None

    def part_value(part, u: float) -> float:
        with suppress(ArithmeticError, ValueError, TypeError):  # it may be a vector
            return float(part({**numbers_by_name, "u": u, "t": start + u * (end - start)}))
        return np.nan

    return Curve.fit(value, start, end, [partial(part_value, part) for part in expression.parts])


def _index(curve: int | None) -> int:
    return -1 if curve is None else curve


@statement(
    "loads",
    part=PART,
    at=POINT,
    force=VectorKey(ZERO, unit="N", text="the force"),
    moment=VectorKey(ZERO, unit="N m", text="the moment"),
    curve=CURVE,
    **CLASS,
)
def load(build, args):
    """A force and a moment in global axes at a point of a part."""
    beam = build.scene.arm_to(args.part.particle(args.at.name), args.at.position)
    build.scene.add(Load(beam, args.force, args.moment, _index(args.curve)))


@statement(
    "drags",
    part=PART,
    through=ListKey(kind=POINT, most=2, text="a point of the part, or the two ends of a line on "
                                             "it"),
    area=Number(unit="m2", least=0, text="frontal area; for a line, its length times its width"),
    coefficient=Number(least=0, text="drag coefficient: force over density/2 area speed**2"),
    density=Number(unit="kg/m3", least=0, text="density of the air"),
    normal=DirectionKey(
        None, "normal of a plate, for which only the velocity along the normal counts; default: "
              "the velocity across a line, or the whole velocity of a point"
    ),
    wind=VectorKey(ZERO, unit="m/s", text="velocity of the air"),
)  # fmt: skip
def drag(build, args):
    """Air drag, in proportion to the square of the speed, at a point of a part or along a line."""
    scene, ends = build.scene, [point.position for point in args.through]
    particles = [args.part.particle(point.name) for point in args.through]
    axis, spots = ZERO if args.normal is None else args.normal, [(particles[0], ends[0], 1.0)]
    if len(ends) > 1:
        if not (length := np.linalg.norm(ends[1] - ends[0])) > POINT_TOL * build.size:
            build.refuse("through", args.through[1].name, "two points that are apart")
        axis = (ends[1] - ends[0]) / length if args.normal is None else axis
        spots = stations(scene, args.part.particles, *ends)
    factor = args.density / 2 * args.coefficient * args.area
    component = "across" if args.normal is None else "along"
    for particle, position, weight in spots:
        beam = scene.arm_to(particle, position)
        local_axis = scene.arm_to(particle, position + axis).arm - beam.arm
        scene.add(Drag(beam, weight * factor, local_axis, component, args.wind, args.name))


@statement(
    "cables",
    through=ListKey(
        kind=PointKey(), least=2, text="points through which it passes, in order", units=True
    ),
    EA=Number(unit="N", above=0, text="tension at a strain of one"),
    rest=Number(None, "length without tension; give `rest` or `preload`", unit="m", above=0),
    preload=Number(None, "tension at the start; give `preload` or `rest`", unit="N", least=0),
    reel=Number(
        None, "length that a winch at the first point takes in, multiplied by `curve`", unit="m"
    ),
    curve=ReferenceKey(None, "curve of the winch over time", group="curves"),
    friction=Number(
        None,
        "coefficient of friction at the points between its ends; default: free pulleys",
        least=0,
    ),
    drum=OpeningKey(
        None,
        "joint of the drum that winds the cable at its first point",
        types=("revolute", "universal"),
    ),
    radius=Number(
        None, "radius of the drum; negative if a growing opening unwinds the cable", unit="m"
    ),
    shortest=Number(
        None,
        "shortest length without tension that may remain outside the drum; default: a quarter of"
        " that at the start",
        unit="m",
        above=0,
    ),
    **CLASS,
)
def cable(build, args):
    """A tight cable pulls its points together, and runs through those between its ends."""
    points = [(part.particle(point.name), point.position) for part, point in args.through]
    for particle, _ in points:
        build.joints_of.setdefault(particle, [])
    if (args.rest is None) == (args.preload is None):
        pair = None if args.rest is None else f"{args.rest:g} m and {args.preload:g} N"
        build.refuse("rest", pair, "either `rest` or `preload`")
    if args.reel is None and args.curve is not None and args.drum is None:
        build.refuse("reel", None, "a length, with a `curve`")
    if args.friction is not None and len(points) == 2:
        build.refuse("friction", args.friction, "none on a cable that runs through no point")
    if args.drum is None and args.shortest is not None:
        build.refuse("shortest", args.shortest, "none without a `drum`")
    numbers = args.EA, args.rest, args.preload, args.reel or 0.0, _index(args.curve), args.friction
    drum = {"drum": _index(args.drum), "radius": args.radius or 0.0, "least": args.shortest}
    return build.scene.add_cable(args.name, points, *numbers, **drum)


@statement(
    "drives",
    part=PART,
    at=POINT,
    velocity=VectorKey(ZERO, unit="m/s", text="velocity of the point"),
    spin=VectorKey(ZERO, unit="rad/s", text="angular velocity of the point"),
    curve=CURVE,
    translations=LettersKey("xyz", "axes along which it is driven; it is free along the others"),
    rotations=LettersKey(
        "xyz", "axes about which it is driven: all (if it is driven along all axes), or none"
    ),
)
def drive(build, args):
    """Prescribes the velocity and spin of a point, or its velocity along some global axes."""
    scene, particle = build.scene, args.part.particle(args.at.name)
    arm = scene.arm_to(particle, args.at.position)
    is_taken = args.name in {*scene.supports, *list_names(scene)}
    name = f"drive {args.name}" if is_taken else args.name
    if len(args.translations + args.rotations) < 6:
        _lead(build, args, name, particle, arm)
    else:
        distance = float(np.linalg.norm(arm.arm))
        if distance > POINT_TOL * build.size and np.any(args.spin):
            build.refuse("at", args.at.name, "the centre of a body, or a point on the bar's axis")
        scene.drive(particle, args.velocity, args.spin, _index(args.curve))
    scene.supports[name] = arm


def _lead(build, args, name: str, particle: int, arm) -> None:
    """Lead a point along some global axes, as one of a part that is free along and about others."""
    scene, axes = build.scene, args.translations
    if args.rotations:
        build.refuse("rotations", args.rotations, "xyz with all `translations`, or none")
    if not axes:
        build.refuse("translations", "none", "one of x, y, z, or several, with `rotations: none`")
    moves = np.abs(args.velocity) > 1e-12 * np.linalg.norm(args.velocity)  # but for rounding
    if free := [axis for axis in compress("xyz", moves) if axis not in axes]:
        allowed = f"0 along {', '.join(free)}, or `translations` with it"
        build.refuse("velocity", args.velocity.tolist(), allowed)
    if np.any(args.spin):
        build.refuse("spin", args.spin.tolist(), "none with `rotations: none`")
    held_axes = ""
    for joint in scene.kinds.get(Joint, []):
        is_of_part = joint.type == "held" and joint.particles[0] == particle
        if is_of_part and np.allclose(joint.beams[0].arm, arm.arm):
            held_axes += joint.support_axes
    if not np.any(arm.arm):
        held_axes += "".join(compress("xyz", scene.fixed[particle]))
    if set(held_axes) & set(axes):
        allowed = f"axes along which nothing else holds the point, not {', '.join(held_axes)}"
        build.refuse("translations", axes, allowed)
    # Where the point is once parts are assembled.
    leader = int(scene.add_particles(arm.end_in(scene), MASSLESS, MASSLESS)[0])
    scene.drive(leader, args.velocity, args.spin, _index(args.curve))
    scene.add(Joint.held_point(scene, name, particle, args.at.position, axes, leader))
    build.joints_of.setdefault(particle, []).append(args.name)


@statement(
    "initial_velocities",
    part=PART,
    velocity=VectorKey(ZERO, unit="m/s", text="velocity of the point `about`"),
    spin=VectorKey(ZERO, unit="rad/s", text="angular velocity"),
    about=ReferenceKey(group="points", text="point whose velocity is given"),
)
def motion(build, args):
    """Velocity and spin of a part at the start."""
    scene, particles = build.scene, args.part.particles
    centre = args.about.position
    if args.about.name in args.part.points:  # where it is, if parts were moved before the start
        centre = scene.arm_to(args.part.particle(args.about.name), centre).end_in(scene)
    arms = scene.position[particles] - centre
    scene.velocity[particles] = args.velocity + np.cross(args.spin, arms)
    scene.spin[particles] = args.spin


@statement(
    "opening_rates",
    joint=OpeningKey(text="joint whose opening changes at the start"),
    rate=Number(unit="rad/s", text="rate of its opening"),
)
def opening_rate(build, args):
    """The rate of an opening at the start.

    Unstated velocities follow as after an impact in these joints."""
    if args.joint in build.scene.opening_rates:
        build.refuse("joint", build.scene.hinges[args.joint].name, "joints that have no other rate")
    build.scene.opening_rates[args.joint] = args.rate


@statement(
    "record", part=ReferenceKey(group="parts", text="part that carries it", ground=True), at=POINT
)
def record(build, args):
    """A point of a part whose motion is recorded under this name."""
    build.scene.add_point(args.name, args.part.particle(args.at.name), args.at.position)


ENDS = ListKey(kind=PointKey(), least=2, most=2, text="its two end points, of different parts")
DAMPING = Number(0.0, "force per rate of length, in both directions", unit="N s/m", least=0)
FORCES = ListKey(
    kind=Number(unit="N"), least=2, text="one force for each length, positive if it pushes"
)
SIDES = {"both ways": (1.0, 1.0), "push": (1.0, 0.0), "pull": (0.0, 1.0)}


def _add(build, args, lengths, forces, slopes=(0.0, 0.0)) -> None:
    """Add a Strut of lengths (m), forces (N) and slopes (N/m) to the scene."""
    points = [(part.particle(point.name), point.position) for part, point in args.between]
    if points[0][0] == points[1][0] or not _length(args) > 0:
        places = " and ".join(f"{point.name} of {part.name}" for part, point in args.between)
        build.refuse("between", places, "points of two parts, or of two ends of a bar, apart")
    for particle, _ in points:
        build.joints_of.setdefault(particle, [])
    beams = tuple(build.scene.arm_to(particle, place) for particle, place in points)
    build.scene.add(Strut(args.name, beams, tuple(lengths), tuple(forces), slopes, args.damping))


def _length(args) -> float:
    """Length (m) of a strut at the start."""
    (_, first), (_, second) = args.between
    return sum((first.position - second.position) ** 2) ** 0.5


@statement(
    "struts",
    "spring",
    between=ENDS,
    stiffness=Number(unit="N/m", least=0, text="force per change of length"),
    rest=Number(None, "length without force; give `rest` or `preload`", unit="m", above=0),
    preload=Number(None, "force at the start, positive if it pushes", unit="N"),
    acts=Word(
        "both ways",
        "`push` or `pull`: it acts only in this direction and is slack otherwise",
        values=tuple(SIDES),
    ),
    damping=replace(DAMPING, text=DAMPING.text + "; 0 for a spring that acts in one direction"),
    **CLASS,
)
def spring(build, args):
    """A spring that pushes or pulls two points towards a distance."""
    if (args.rest is None) == (args.preload is None):
        pair = None if args.rest is None else f"{args.rest:g} m and {args.preload:g} N"
        build.refuse("rest", pair, "either `rest` or `preload`")
    if args.rest is None and not args.stiffness > 0:
        build.refuse("stiffness", args.stiffness, "above 0, with a `preload`")
    if args.preload and args.acts == ("pull" if args.preload > 0 else "push"):
        build.refuse("preload", args.preload, f"one that a strut may have that acts in {args.acts}")
    rest = args.rest
    if rest is None:
        rest = _length(args) + args.preload / args.stiffness
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
    lengths=ListKey(kind=Number(unit="m", above=0), least=2, text="increasing lengths"),
    forces=FORCES,
    damping=DAMPING,
    **CLASS,
)
def tabulated_spring(build, args):
    """A force between two points from a table over their distance, constant beyond its ends."""
    _add(build, args, args.lengths, args.forces)
    if not vars(args)["class"]:
        build.scene.classes[Strut, len(Strut.find(build.scene)) - 1] = "HA"  # as tables on joints


@statement(
    "struts",
    "gas spring",
    between=ENDS,
    force=Number(unit="N", above=0, text="force when it is fully extended"),
    length=Number(unit="m", above=0, text="length when it is fully extended"),
    stroke=Number(unit="m", above=0, text="travel from fully extended to fully compressed"),
    ratio=Number(unit="", above=1, text="ratio of the force when fully compressed to `force`"),
    exponent=Number(1.0, "exponent of the gas: 1 for slow motion, 1.4 for fast", unit="", least=1),
    damping=DAMPING,
    **CLASS,
)
def gas_spring(build, args):
    """A gas spring, which pushes two points apart; its force is constant beyond its stroke."""
    if not args.stroke < args.length:
        build.refuse("stroke", args.stroke, f"below the length, {args.length:g} m")
    table = gas_table(args.force, args.length, args.stroke, args.ratio, args.exponent)
    least, start = args.length - args.stroke, _length(args)
    if not least * (1 - 1e-9) <= start <= args.length * (1 + 1e-9):
        text = f"at least {start:.4g} m, the distance of its points at the start, and at most its "
        build.refuse("length", args.length, f"{text}stroke, {args.stroke:.4g} m, more")
    _add(build, args, *table)


@statement(
    "struts",
    "constant force",
    between=ENDS,
    force=Number(unit="N", text="force, positive if it pushes"),
    damping=DAMPING,
    **CLASS,
)
def constant_force(build, args):
    """The same force between two points at any distance."""
    _add(build, args, [_length(args)], [args.force])


@statement("struts", "damper", between=ENDS, damping=replace(DAMPING, default=NO_VALUE))
def damper(build, args):
    """A damper between two points, which resists changes of their distance."""
    _add(build, args, [_length(args)], [0.0])
