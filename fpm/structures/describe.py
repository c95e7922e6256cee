"""A structure in words: what may be set in it, what it is made of, and what a run costs."""

import math
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
from fpm.elements.kind import ElementType
from fpm.elements.openings.release import Release
from fpm.reading.bars import bars_of
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.scenes.timestep import SAFETY, find_stable_step, machine, run_seconds
from fpm.solver.start import consistent_scene
from fpm.structures import report
from fpm.structures.plausible import opening_text, warnings
from fpm.structures.statement import ON_SLIDES


def describe(structure: SceneType, duration: float = 1.0) -> str:
    """Return a text of several lines on a structure at its default values: parameters, points,
    joints, mass, mobility, stable step, and what a run of `duration` (s) costs."""
    scene = structure.build()
    rows = [["parameter", "default", "unit", "allowed", "description"]]
    for name, p in structure.parameters.items():
        default = "(from others)" if p.default is None else _number(p.default)
        unit = "" if p.unit == "1" else p.unit
        notes = p.text, "the mesh" * (name == structure.mesh), "no interval" * p.is_whole
        allowed = p.allowed.removesuffix(f" ({unit})")
        rows.append([name, default, unit, allowed, "; ".join(filter(None, notes))])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        f"{structure.name}: {structure.description}" if structure.description else structure.name,
        "",
        *("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows),
        "",
        *list_parts(scene),
        "",
        *(f"{title:14}{text}" for title, text in _facts(structure, scene, duration) if text),
        *(f"warning       {text}" for text in warnings(scene)),
    ]
    return "\n".join(lines)


def list_parts(scene: Scene) -> list[str]:
    """Return lines on the points, parts, joints and what acts on them in a scene."""
    points = [f"{name} {_vector(beam.end_in(scene))}" for name, beam in scene.points.items()]
    change = scene.assembly or scene.equilibrium
    start = change.openings if change else [h.opening for h in scene.hinges]
    joints = [f"{h.name} ({_opening(h, psi)})" for h, psi in zip(scene.hinges, start, strict=True)]
    joints += [f"{j.name} ({j.type})" for j in scene.kinds.get(Joint, []) if j.type != "held"]
    drags: Counter[str] = Counter()
    for drag in Drag.find(scene):
        drags[drag.name] += drag.factor
    lists: dict[str, Iterable[str]] = {
        "points": points or ["none"],
        "bars": bars_of(scene) if scene.beams else (),
        "bodies": scene.bodies,
        "supports": scene.supports or (() if scene.fixed.any() else ["none: it floats"]),
        "joints": joints or ["none"],
        "cables": [_cable(scene, cable) for cable in scene.cables],
        "struts": [_strut(scene, strut) for strut in Strut.find(scene)],
        "on joints": list_actions(scene),
        "drags": [f"{name} ({force:.4g} N at 1 m/s)" for name, force in drags.items()],
    }
    lines = []
    for title, names in lists.items():
        lines += [title, *(f"  {name}" for name in names)] if names else []
    return lines


def to_html(*lines: str) -> str:
    """Return lines as HTML for notebooks."""
    return f"<pre>{escape(chr(10).join(lines))}</pre>"


def _facts(structure: SceneType, scene: Scene, duration: float) -> Iterator[tuple[str, str]]:
    """Titles, and what is to be said on the whole, "" where there is nothing."""
    limit, mobility = find_stable_step(scene), report.mobility(scene)
    yield "mass", f"{report.mass(scene):.6g} kg"
    yield "its centre", _vector(report.centre(scene))
    freedom = _count_text(mobility.degrees, "way")
    parts = _count_text(mobility.parts, "moving part")
    conditions = f"{mobility.conditions} conditions, {mobility.redundant} of them redundant"
    yield "mobility", f"{freedom} to move: {parts}, {conditions}"
    yield "redundant", ", ".join(report.redundant(scene))
    if scene.assembly is not None:
        joint, gap, tilt = scene.assembly[1:4]
        parts = " and ".join([f"{gap:.4g} m"] * (gap > 0) + [f"{tilt:.4g} rad"] * (tilt > 0))
        text = f"joint {joint} was open by {parts}" if parts else "nothing was open"
        yield "assembled", f"{text}; {scene.assembly.energy:.4g} J of strain energy are left"
    if scene.equilibrium is not None:
        _, imbalance, largest, energy, motion = scene.equilibrium
        text = f"{motion:.4g} m away at most; {energy:.4g} J of strain energy in bars"
        text += f"; {imbalance:.2g} of forces up to {largest:.4g} (N, N m) is left"
        yield "equilibrium", text
    start = consistent_scene(scene)
    energy = report.kinetic_energy(start, start.velocity, start.spin)
    yield "at the start", f"kinetic energy {energy:.4g} J" if energy else ""
    steps = 1
    if limit.step == np.inf:
        text = "none, as nothing is elastic: a step is at most the time between two instants"
        yield "stable step", text
    else:
        steps = max(1, math.ceil(duration / (SAFETY * limit.step)))
        yield "stable step", f"{limit.step:.4g} s, set by {limit.element}"
        if any(beams.material.stiffness_damping for beams in scene.beams):
            yield "", f"{report.undamped_step(scene):.4g} s without `stiffness_damping`"
        changes = [
            f"{name} = {_number(value)} (x {ratio:.3g})"
            for name, value, ratio in report.longer_steps(structure, limit.step)
        ]
        if limit.element.startswith(ON_JOINTS) and scene.beams:
            changes.append("`masses` with the fittings' inertia at its joint, where bars are light")
        yield "", f"longer with {'; '.join(changes)}" if changes else ""
    count, seconds = len(scene.elements), machine() * run_seconds(scene, steps, 0)
    text = f"{count} elements, {steps} steps for {duration:g} s, {steps * count:.3g} steps of "
    yield "a run", f"{text}elements, about {seconds:.2g} s of a core (one of eight side by side)"


def _opening(hinge: Hinge, specified_opening: float) -> str:
    """The opening of a hinge at the start, and the stated one if parts were forced to another."""
    kind = {"revolute": "", "prismatic": "slide, "}
    text, specified_text = (opening_text(hinge, x) for x in (hinge.opening, specified_opening))
    suffix = f", stated as {specified_text}" if text != specified_text else ""
    return f"{kind.get(hinge.type, f'{hinge.type}, ')}opening {text}{suffix}"


def _count_text(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


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
    force = strut.force(length := strut.distance(scene))
    state = f"{'pushes' if force > 0 else 'pulls'} with {abs(force):.4g} N"
    damper = f", damping {strut.damping:.4g} N s/m" if strut.damping else ""
    return f"{strut.name} ({length:.4g} m, {state if force else 'no force'}{damper})"


def _vector(values: np.ndarray) -> str:
    """Metres, those that are rounding as zero."""
    return f"({', '.join(f'{x:.4g}' for x in np.round(values, 9) + 0.0)}) m"
