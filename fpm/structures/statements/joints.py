"""Joints: what parts share where they meet; and supports, which hold points of them."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from fpm.declare import Number, specs
from fpm.elements.cross import length
from fpm.elements.joints.hinge import unit
from fpm.elements.joints.joint_types import TYPES
from fpm.elements.openings.journal import PIN, Journal
from fpm.structures.builder import POINT_TOL
from fpm.structures.keys import DirectionKey, LettersKey, ListKey, MapKey, ReferenceKey
from fpm.structures.statement import element, key_of, statement

PART = ReferenceKey(group="parts", ground=True)
PARTS = ListKey(kind=PART, least=2, text="parts that it joins")
PAIR = ListKey(kind=PART, least=2, most=2, text="parts that it joins")
POINT = MapKey(
    text="point that all parts share; or one point of each part, which must coincide",
    kind=ReferenceKey(group="points"),
    single=True,
)


def _per_part(build, args, key: str, noun: str) -> list:
    """Return the values of a key for each of a joint's parts, stated for each or one for all."""
    value, names = getattr(args, key), [part.name for part in args.parts]
    if not isinstance(value, dict):
        return [value] * len(names)
    if value.keys() != set(names):
        build.refuse(key, list(value), f"{noun} for each of {', '.join(names)}")
    return [value[name] for name in names]


def _meet(build, args) -> tuple[list[int], np.ndarray]:
    """Return the particles of a joint's parts, and their points there (k, 3); for every joint."""
    points = _per_part(build, args, "at", "a point")
    particles = [part.particle(p.name) for part, p in zip(args.parts, points, strict=True)]
    for (part1, p), (part2, q) in pairwise(zip(args.parts, points, strict=True)):
        gap = length(p.position - q.position)
        if not gap <= POINT_TOL * build.size and build.hold is None:
            pair = f"{p.name} of {part1.name} and {q.name} of {part2.name}"
            allowed = f"{pair} up to {POINT_TOL * build.size:.2g} m apart, or `assemble: true`"
            build.refuse("at", f"{gap:.6g} m apart", allowed)
    for particle in particles:
        build.joints_of.setdefault(particle, []).append(args.name)
    if build.hold is None:  # what is apart by rounding meets at the first part's point
        points = points[:1] * len(points)
    return particles, np.array([point.position for point in points])


def _extra_pairs(args, particles) -> Iterator[tuple[str, tuple[int, int], list[int]]]:
    """Name and particles of joints of the first part with those after the second; their places."""
    for k in range(2, len(particles)):
        label = args.parts[k].name.rpartition(".")[2]  # without that of its unit
        yield f"{args.name}_{label}", (particles[0], particles[k]), [0, k]


@statement(
    "joints",
    "revolute",
    parts=PARTS,
    at=POINT,
    axis=MapKey(
        text="axis of rotation; or one axis for each part, which must agree",
        kind=DirectionKey(),
        single=True,
    ),
    opening=Number(
        0.0,
        "angle at the start; it grows as the second part turns relative to the first about the "
        "axis (right-hand rule)",
        unit="rad",
    ),
    held=LettersKey("", "global axes along which the point is held, as by a slider"),
)
def revolute(build, args):
    """A hinge: parts share a point and an axis, and turn freely about it."""
    particles, points = _meet(build, args)
    axes, scene = np.array(_per_part(build, args, "axis", "one")), build.scene
    if build.hold is None:
        if float(np.abs(axes - axes[0]).max()) > POINT_TOL:
            build.refuse("axis", axes.tolist(), "axes that agree, or `assemble: true`")
        axes = np.array([axes[0]] * len(axes))
    values = args.name, particles[:2], points[:2], axes[:2], args.opening, args.held
    hinge = scene.add_hinge(*values)
    for name, pair, ends in _extra_pairs(args, particles):
        scene.add_hinge(name, pair, points[ends], axes[ends])
    return hinge


def _join(build, args, type: str) -> None:
    """Join all parts to the first."""
    particles, points = _meet(build, args)
    build.scene.add_joint(args.name, type, particles[:2], points[:2])
    for name, pair, ends in _extra_pairs(args, particles):
        build.scene.add_joint(name, type, pair, points[ends])


for _type, _text in {
    "spherical": "A ball and socket: parts share a point.",
    "fixed": "A rigid connection: the parts neither move nor turn relative to each other.",
}.items():
    statement("joints", _type, _text, parts=PARTS, at=POINT)(partial(_join, type=_type))


@statement(
    "joints",
    "universal",
    parts=PAIR,
    at=POINT,
    axis=DirectionKey(text="axis of the cross on the first part"),
    other=DirectionKey(text="axis of the cross on the second part, normal to `axis`"),
    openings=ListKey(
        None,
        "angles at the start: of the cross relative to the first part about `axis`, and of the "
        "second part relative to the cross about `other`; default: 0",
        kind=Number(unit="rad"), least=2, most=2,
    ),
)  # fmt: skip
def universal(build, args):
    """A Cardan joint: parts share a point and turn about the two perpendicular axes of a cross."""
    if abs(args.axis @ args.other) > 1e-6:
        build.refuse("other", args.other.tolist(), f"a direction normal to {args.axis.tolist()}")
    axis2 = unit(args.other - (args.axis @ args.other) * args.axis, "other")
    particles, points = _meet(build, args)
    openings = args.openings or (0.0, 0.0)
    return build.scene.add_universal(args.name, particles, points, args.axis, axis2, openings)


def _openings(type: str) -> dict[str, Number]:
    """Keys of the openings at the start of a joint with several, or of a screw."""
    texts = {
        "": "angle at the start; it grows as the second part turns relative to the first about "
        "the axis (right-hand rule)",
        "axis": "position along the axis at the start",
        "x": "position along `x` at the start",
        "y": "position along y = `axis` × `x` at the start",
    }
    return {
        f"opening{suffix}": Number(0.0, texts[direction], unit="m" if direction else "rad")
        for suffix, direction in TYPES[type].openings
    }


def _add_slider(build, args, type: str, lead: float = 0.0) -> int:
    """Add a joint whose second part slides and turns, with all its openings."""
    particles, points = _meet(build, args)
    x = getattr(args, "x", None)
    if x is not None:
        if abs(args.axis @ x) > 1e-6:
            build.refuse("x", x.tolist(), f"a direction normal to {args.axis.tolist()}")
        x = unit(x - (args.axis @ x) * args.axis, "x")
    openings = [getattr(args, key) for key in _openings(type)]
    values = args.name, type, particles, points, args.axis, openings, x, lead
    return build.scene.add_sliding_joint(*values)


PITCH = Number(
    text="travel of the second part along the axis in one turn, other than 0; negative for a "
    "left-handed thread",
    unit="m",
)
AXIS = DirectionKey(text="axis, fixed to both parts, about which the second part turns")


def _slider(type: str, text: str, axis: str, x_text: str = "`x`", **keys) -> Callable:
    """Register a statement of a joint with `_openings`. text: what it is; axis: text on that;
    x_text: for x."""
    openings = {
        n: replace(k, text=k.text.replace("`x`", x_text)) for n, k in _openings(type).items()
    }
    keys = {"axis": replace(AXIS, text=axis), **keys, **openings}
    return statement("joints", type, text, parts=PAIR, at=POINT, **keys)


_slider(
    "prismatic",
    "A slider: the second part moves along an axis of the first and does not turn.",
    "axis along which the second part slides on the first",
)(partial(_add_slider, type="prismatic"))
_slider(
    "cylindrical",
    "A sleeve on a round shaft: the second part slides and turns on an axis of the first.",
    f"{AXIS.text} and along which it slides",
)(partial(_add_slider, type="cylindrical"))
_slider(
    "planar",
    "A plate on a table: the second part slides and turns in a plane of the first.",
    "normal of the plane, fixed to both parts, about which the second part turns",
    x=DirectionKey(text="first direction in the plane, normal to `axis`; fixed to the first part"),
)(partial(_add_slider, type="planar"))
_slider(
    "pin in slot", "A pin of the second part slides and turns in a straight slot of the first.",
    "axis of the pin, fixed to both parts, about which the second part turns", "the slot",
    x=DirectionKey(text="direction of the slot, normal to `axis`; fixed to the first part"),
)(partial(_add_slider, type="pin in slot"))  # fmt: skip


@_slider(
    "screw",
    "A nut on a thread: the second part turns about an axis of the first and so moves along it.",
    f"{AXIS.text} and along which it moves",
    pitch=PITCH,
)
def screw(build, args):
    if not args.pitch:
        build.refuse("pitch", args.pitch, "a length that is not 0; without a thread: cylindrical")
    return _add_slider(build, args, "screw", args.pitch / (2 * math.pi))


_JOURNAL: dict[str, Any] = {name: key_of(Journal, name) for name in specs(Journal)}
del _JOURNAL["hinge"]


@_slider(
    PIN,
    "A pin of the second part turns, with clearance and friction, in a bearing of the first.",
    AXIS.text,
    **_JOURNAL,
    x=DirectionKey(
        None, "direction normal to `axis`, fixed to the first part; default: any such direction"
    ),
)
def pin_with_play(build, args):
    hinge = _add_slider(build, args, PIN)
    build.scene.add(element(Journal, args, hinge=hinge))
    return hinge


@statement(
    "supports",
    part=ReferenceKey(group="parts", text="part that is held"),
    at=ReferenceKey(group="points", text="point of the part"),
    translations=LettersKey("xyz", "axes along which the point is held"),
    rotations=LettersKey("xyz", "axes about which the point is held"),
)
def support(build, args):
    """Holds a point of a part along and about global axes."""
    scene, particle = build.scene, args.part.particle(args.at.name)
    scene.supports[args.name] = scene.arm_to(particle, args.at.position)
    distance = np.linalg.norm(args.at.position - scene.position[particle])
    whole = len(args.translations) == len(args.rotations) == len("xyz")
    if whole or distance <= POINT_TOL * build.size or not args.translations:
        scene.fix(particle, args.translations, args.rotations)
    else:
        scene.hold_point(args.name, particle, args.at.position, args.translations)
        build.joints_of.setdefault(particle, []).append(args.name)
        scene.fix(particle, "", args.rotations)
