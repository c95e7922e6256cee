"""A structure in words: what may be set in it, what it is made of, and what a run costs."""

from collections import Counter
from collections.abc import Iterable, Iterator
from html import escape

import numpy as np

from fpm.declare import specs
from fpm.elements import Drag, kinds_of
from fpm.elements.cables.cable import Cable, length_through
from fpm.elements.cables.strut import Strut
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.kind import ElementType, VirtualBeam
from fpm.elements.openings.release import Release
from fpm.reading.bars import bars_of
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.solver.start import consistent_scene
from fpm.structures import report
from fpm.structures.plausible import opening_text, warnings
from fpm.structures.statement import ON_SLIDES


def describe(structure: SceneType, duration: float = 1.0) -> str:
    """Return a text of several lines on a structure at its default values: parameters, points,
    joints, mass, mobility, stable step, and what a run of `duration` (s) costs."""
    scene = structure.build()
    rows = [[name, *_row(p, name == structure.mesh)] for name, p in structure.parameters.items()]
    lines = [
        f"{structure.name}: {structure.description}" if structure.description else structure.name,
        "",
        *_table([["parameter", "default", "unit", "allowed", "description"], *rows]),
        "",
        *list_parts(scene),
        "",
        *(f"{title:14}{text}" for title, text in _facts(structure, scene, duration) if text),
        *(f"warning       {text}" for text in warnings(scene)),
    ]
    return "\n".join(lines)


def list_parts(scene: Scene) -> list[str]:
    """Return lines on the points, parts, joints and what acts on them in a scene."""
    points = [f"{name} {_place(scene, beam)}" for name, beam in scene.points.items()]
    lists = [("points", points or ["none"]), *_lists(scene)]
    return [line for title, names in lists if names for line in (title, *(f"  {n}" for n in names))]


def to_html(*lines: str) -> str:
    """Return lines as HTML for notebooks."""
    return f"<pre>{escape(chr(10).join(lines))}</pre>"


def _lists(scene: Scene) -> Iterator[tuple[str, Iterable[str]]]:
    """Titles, and what there is of each in a scene."""
    change = scene.assembly or scene.equilibrium
    start = change.openings if change else [h.opening for h in scene.hinges]
    joints = [f"{h.name} ({_opening(h, psi)})" for h, psi in zip(scene.hinges, start, strict=True)]
    joints += [f"{j.name} ({j.type})" for j in scene.kinds.get(Joint, []) if j.type != "held"]
    yield "bars", bars_of(scene) if scene.beams else ()
    yield "bodies", scene.bodies
    yield "supports", scene.supports or (() if scene.fixed.any() else ["none: it floats"])
    yield "joints", joints or ["none"]
    yield "cables", [_cable(scene, cable) for cable in scene.cables]
    yield "struts", [_strut(scene, strut) for strut in Strut.find(scene)]
    yield "on joints", list_actions(scene)
    forces: Counter[str] = Counter()
    for drag in Drag.find(scene):
        forces[drag.name] += drag.factor
    yield "drags", [f"{name} ({force:.4g} N at 1 m/s)" for name, force in forces.items()]


def _facts(structure: SceneType, scene: Scene, duration: float) -> Iterator[tuple[str, str]]:
    """Titles, and what is to be said on the whole, "" where there is nothing."""
    cost, mobility = report.cost(scene, duration), report.mobility(scene)
    yield "mass", f"{report.mass(scene):.6g} kg"
    yield "its centre", _vector(report.centre(scene))
    freedom = _count_text(mobility.degrees, "way")
    parts = _count_text(mobility.parts, "moving part")
    conditions = f"{mobility.conditions} conditions, {mobility.redundant} of them redundant"
    yield "mobility", f"{freedom} to move: {parts}, {conditions}"
    yield "redundant", ", ".join(report.redundant(scene))
    yield "assembled", _describe_misfit(scene) if scene.assembly is not None else ""
    yield "equilibrium", _describe_balance(scene) if scene.equilibrium is not None else ""
    start = consistent_scene(scene)
    energy = report.kinetic_energy(start, start.velocity, start.spin)
    yield "at the start", f"kinetic energy {energy:.4g} J" if energy else ""
    yield "stable step", _step(cost)
    if any(beams.material.stiffness_damping for beams in scene.beams):
        yield "", f"{report.undamped_step(scene):.4g} s without `stiffness_damping`"
    yield "", _remedy(structure, scene, cost)
    steps = f"{cost.steps} steps for {duration:g} s, {cost.element_steps:.3g} steps of elements"
    seconds = f"about {cost.seconds:.2g} s of a core (one of eight side by side)"
    yield "a run", f"{len(scene.elements)} elements, {steps}, {seconds}"


def _opening(hinge: Hinge, specified_opening: float) -> str:
    """The opening of a hinge at the start, and the stated one if parts were forced to another."""
    kind = {"revolute": "", "prismatic": "slide, "}
    text, specified_text = (opening_text(hinge, x) for x in (hinge.opening, specified_opening))
    suffix = f", stated as {specified_text}" if text != specified_text else ""
    return f"{kind.get(hinge.type, f'{hinge.type}, ')}opening {text}{suffix}"


def _count_text(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _step(cost: report.RunCost) -> str:
    """The stable step, and what sets it."""
    if cost.step == np.inf:
        return "none, as nothing is elastic: a step is at most the time between two instants"
    return f"{cost.step:.4g} s, set by {cost.element}"


def _remedy(structure: SceneType, scene: Scene, cost: report.RunCost) -> str:
    """What would make the stable step longer."""
    if cost.step == np.inf:
        return ""
    changes = [
        f"{name} = {_number(value)} (x {ratio:.3g})"
        for name, value, ratio in report.longer_steps(structure, cost.step)
    ]
    if cost.element.startswith(ON_JOINTS) and scene.beams:
        changes.append("`masses` with the fittings' inertia at its joint, where bars are light")
    return f"longer with {'; '.join(changes)}" if changes else ""


ON_JOINTS = ("torsion spring ", "spring ", "latch ", "stop ", "friction ", "damper ", "release ")
"""With what the names of elements begin that may be stiff on light ends of bars."""


def list_actions(scene: Scene) -> list[str]:
    """Return texts on the elements that act on a scene's joints (springs, latches, ...), one each,
    in the order of their (first) joints: its name, joints and nonzero numbers with units."""
    texts = []
    for kind in kinds_of([scene]):
        pairs = zip(kind.names(scene), kind.find(scene), strict=True) if kind.acts_as else ()
        for name, element in pairs:
            if not (indices := element.acts_on()):
                continue
            hinges = [scene.hinges[hinge] for hinge in indices]
            joints = " and ".join(hinge.name for hinge in hinges)
            numbers = [*_numbers(element, scene)]
            if isinstance(element, Release) and element.watch >= 0:
                joint = scene.hinges[element.watch]
                numbers.append(f"until {joint.name} passes {opening_text(joint, element.level)}")
            if isinstance(element, Release) and element.latch:
                numbers.append(f"until latch {element.latch} catches")
            texts.append((indices[0], f"{name} ({', '.join([f'on {joints}', *numbers])})"))
    return [text for _, text in sorted(texts, key=lambda pair: pair[0])]


def _numbers(element: ElementType, scene: Scene) -> Iterator[str]:
    """The numbers of an element on joints, those that do nothing left out."""
    slides = scene.hinges[element.acts_on()[0]].slides
    for name, field in specs(type(element)).items():
        value = getattr(element, name)
        if not field.is_shown or value is None or not np.isfinite(value):
            continue
        if value == 0.0 and not field.zero:
            continue
        unit = element.unit_in(scene, field.unit)
        if name == "turn" and getattr(element, "by_rate", False):
            name, unit = "rate", f"{unit}/s"
        if unit.startswith("rad"):
            value, unit = np.degrees(value), unit.replace("rad", "deg")
        name = ON_SLIDES.get(name, name) if slides else name
        yield f"{name.replace('_', ' ')} {value:.4g} {unit}".rstrip()


def _describe_misfit(scene: Scene) -> str:
    """What forced the parts together."""
    joint, gap, tilt = scene.assembly[1:4]
    parts = [f"{gap:.4g} m"] * (gap > 0) + [f"{tilt:.4g} rad"] * (tilt > 0)
    text = f"joint {joint} was open by {' and '.join(parts)}" if parts else "nothing was open"
    return f"{text}; {scene.assembly.energy:.4g} J of strain energy are left"


def _describe_balance(scene: Scene) -> str:
    """What the equilibrium at the start took, and how exact it is."""
    _, imbalance, largest, energy, motion, _ = scene.equilibrium
    text = f"{motion:.4g} m away at most; {energy:.4g} J of strain energy in bars"
    return f"{text}; {imbalance:.2g} of forces up to {largest:.4g} (N, N m) is left"


def _row(parameter: Parameter, is_mesh: bool) -> list[str]:
    """Default, unit, what is allowed and description of a parameter."""
    default = "(from others)" if parameter.default is None else _number(parameter.default)
    unit = "" if parameter.unit == "1" else parameter.unit
    notes = [
        parameter.text,
        "the mesh" * is_mesh,
        "no interval" * parameter.is_whole,
    ]
    allowed = parameter.allowed.removesuffix(f" ({unit})")
    return [default, unit, allowed, "; ".join(filter(None, notes))]


def _number(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _cable(scene: Scene, cable: Cable) -> str:
    """Length and tension of a cable at the start."""
    length, rest = length_through(scene, cable.beams), cable.rest_at(scene, 0.0)
    tension = cable.stiffness * max(length / rest - 1, 0.0)
    state = f"tension {tension:.4g} N" if tension else f"slack by {rest - length:.4g} m"
    return f"{cable.name} ({length:.4g} m, {state})"


def _strut(scene: Scene, strut: Strut) -> str:
    """Length and force of a strut at the start."""
    length = strut.distance(scene)
    force = strut.force(length)
    verb = "pushes" if force > 0 else "pulls"
    state = f"{verb} with {abs(force):.4g} N" if force else "no force"
    damper = f", damping {strut.damping:.4g} N s/m" if strut.damping else ""
    return f"{strut.name} ({length:.4g} m, {state}{damper})"


def _place(scene: Scene, beam: VirtualBeam) -> str:
    """Where a named point is at the start."""
    particle = beam.particle
    return _vector(scene.position[particle] + scene.frame[particle] @ beam.arm)


def _vector(values: np.ndarray) -> str:
    """Metres, those that are rounding as zero."""
    return f"({', '.join(f'{x:.4g}' for x in np.round(values, 9) + 0.0)}) m"


def _table(rows: list[list[str]]) -> list[str]:
    """Rows in columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
