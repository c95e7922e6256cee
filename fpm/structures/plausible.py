"""What is allowed in a structure, but hardly meant: each told with its number.

Limits are far from what deployable structures are made of, so that a slip of units (mm for m, g/cm³
for kg/m³, Pa for GPa) shows, and no structure that is meant does."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fpm.assembly.conditions import dependence
from fpm.elements import (
    Cable,
    Drag,
    Drive,
    Latch,
    Load,
    Stop,
    Strut,
    TableSpring,
    TorsionSpring,
    kinds_of,
)
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.joint import Joint
from fpm.elements.openings.friction import Friction
from fpm.elements.openings.latch import SIDES
from fpm.elements.openings.release import Release
from fpm.elements.particles.load import Gravity
from fpm.reading.bars import bars_of
from fpm.scenes.scene import Scene
from fpm.solver.start import consistent_scene
from fpm.structures import report

DENSEST = 30_000.0
"""Density (kg/m3) above any material's, of boxes."""

MAX_SLENDERNESS = 500.0
"""Ratio of edges above which a box stands for a line or a sheet without thickness, of any mass."""

MAX_AREAS = 300.0
"""Area on which air drags by the square of the structure's size, above which it is odd."""

FARTHEST = 200.0
"""Distance of a point from the others by their extent, above which it is odd."""


def find_doubts(group: str, args: Any, size: float) -> Iterator[str]:
    """Yield sentences on an entry that is hardly meant, of what its scene does not show: boxes too
    dense, drag on too much area. args: values of its keys; size: extent of the structure (m)."""
    box = getattr(args, "box", None)
    # A line or a sheet has no density.
    if box is not None and MAX_SLENDERNESS * np.min(box) > np.max(box):
        edges = " x ".join(f"{edge:.4g}" for edge in box)
        yield from find_dense(args.name, args.mass, float(np.prod(box)), f"a box of {edges} m")
    if group == "drags" and args.area > MAX_AREAS * size**2 > 0:
        yield (
            f"drag {args.name} has an area of {args.area:.4g} m2, on a structure of {size:.4g} m: "
            f"an area in mm2 has its unit, as {args.area:.6g} mm2"
        )


def find_dense(name: str, mass: float, volume: float, shape: str = "") -> Iterator[str]:
    """Yield a sentence on a body that is denser than any material, if it has a volume. name: of the
    body; mass (kg); volume (m3), 0: none; shape: what has that, in words; "": the volume."""
    if mass > DENSEST * volume > 0:
        yield (
            f"body {name} has {mass:.4g} kg in {shape or f'{volume:.4g} m3'}, "
            f"{mass / volume:.3g} kg/m3; usual: at most {DENSEST:g} kg/m3: masses are in kg, not "
            "in g"
        )


def find_far_point(points: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yield a sentence on a point (positions by name, m) far from all others, if any."""
    names, places = list(points), np.array(list(points.values()))
    if len(names) < 3:
        return
    distances = np.linalg.norm(places - np.median(places, axis=0), axis=1)
    index = int(np.argmax(distances))
    rest = float(np.ptp(np.delete(places, index, axis=0), axis=0).max())
    if distances[index] > FARTHEST * rest > 0:
        yield (
            f"point {names[index]} is {distances[index]:.4g} m from the others, which lie within "
            f"{rest:.4g} m: a length in mm has its unit, as 500 mm"
        )


MOST = 6
"""Number of warnings of one structure, at most; a repeat would have one for each unit."""

IMPACT_SHARE = 0.01
"""Share of the kinetic energy stated for the start above which what joints take out is told."""

THINNEST = 1e-3
"""Density (kg/m3) of the box that has a body's mass and inertia, below which its sizes are odd."""

MAX_REACH = 20.0
"""Size of that box by the structure's, above which it is odd."""

MAX_RATIO = 1000.0
"""Ratio of lengths of one bar, or of all, above which they are hardly in one unit."""

MAX_GRAVITY = 100.0
"""Acceleration of gravity (m/s2) above which it is hardly in this unit."""

USUAL = {"mass": (1e-6, 1e5, "kg"), "largest extent": (1e-4, 1e3, "m")}
USUAL |= {"density": (20, 25_000, "kg/m3"), "Young's modulus": (1e6, 2e12, "Pa")}
"""What is between these ends needs no warning."""


def warnings(scene: Scene, duration: float | None = None) -> list[str]:
    """Return sentences on what a scene has that is allowed but hardly meant, at most 6, and one on
    how many more there are. duration: of the run (s), to tell what comes after its end; None:
    unknown."""
    checks = _sizes, _boxes, _thin, _support, _start, _loose, _rigid, _stuck, _bearings, _tables
    sentences = scene.doubts + [sentence for check in checks for sentence in check(scene)]
    for latch in Latch.find(scene):
        sentences += _latch(scene, latch, duration)
    for release in Release.find(scene):
        sentences += _release(scene, release, duration)
    sentences = list(dict.fromkeys(sentences))
    rest = len(sentences) - MOST
    return sentences[:MOST] + [f"and {rest} more of this kind"] * (rest > 0)


def _start(scene: Scene) -> Iterator[str]:
    """Warn of stated start velocities that joints, motors and drives do not allow."""
    energy = report.kinetic_energy(scene, scene.velocity, scene.spin)
    if energy:
        start = consistent_scene(scene)
        change = start.velocity - scene.velocity, start.spin - scene.spin
        if report.kinetic_energy(scene, *change) > IMPACT_SHARE * energy:
            rest = report.kinetic_energy(scene, start.velocity, start.spin)
            rest *= rest > 1e-9 * energy  # rounding
            yield (
                f"velocities at the start have {energy:.4g} J; joints, motors, drives and what is "
                f"held then leave {rest:.4g} J: check axes and signs, and that every part that "
                "moves along has its velocity"
            )


def _sizes(scene: Scene) -> Iterator[str]:
    size = float(np.ptp(scene.position, axis=0).max()) if len(scene.position) else 0.0
    yield from _usual("mass", report.mass(scene), "all of it")
    if (gravity := float(np.linalg.norm(scene.gravity))) > MAX_GRAVITY:
        yield f"gravity is {gravity:.4g} m/s2, usual: 9.81; in mm/s2 it has its unit, as 9810 mm/s2"
    yield from _usual("largest extent", size, "all of it") if size else ()
    bars = bars_of(scene)
    for bar in bars.values():
        group, length = bar.groups[0], float(bar.ends[-1])
        yield from _usual("density", group.material.rho, f"bar {bar.name}")
        yield from _usual("Young's modulus", group.material.E, f"bar {bar.name}")
        wide = max(group.section.width, group.section.height)
        thin = min(group.section.width, group.section.height)
        if group.section.outline == "round":  # the wall's thickness, computed from the area
            thin = wide / 2 - np.sqrt(max(wide**2 / 4 - group.section.A / np.pi, 0.0))
        if wide > 3 * length:
            yield f"bar {bar.name} is {length:.4g} m long and {wide:.4g} m wide: both in metres?"
        elif length > MAX_RATIO * wide > 0:
            yield f"bar {bar.name} is {length:.4g} m long and only {wide:.4g} m wide"
        if wide > MAX_RATIO * thin > 0:
            yield f"bar {bar.name} is {wide:.4g} m wide and only {thin:.3g} m thick"
    lengths = {float(bar.ends[-1]): name for name, bar in bars.items()}
    if lengths and max(lengths) > MAX_RATIO * min(lengths):
        (least, bar1), (most, bar2) = min(lengths.items()), max(lengths.items())
        yield f"bar {bar1} is {least:.4g} m long, bar {bar2} {most:.4g} m: are both in one unit?"


def _boxes(scene: Scene) -> Iterator[str]:
    """Bodies whose mass and inertia are those of a box that is far too large."""
    size = extent(scene)
    for name, particle in scene.bodies.items():
        mass, inertia = float(scene.mass[particle]), scene.inertia[particle]
        edges = np.sqrt(np.maximum(6 * (inertia.sum() - 2 * inertia) / mass, 0.0))
        text = f"body {name} has the inertia of a box of {' x '.join(f'{x:.4g}' for x in edges)} m"
        if (volume := float(edges.prod())) and mass / volume < THINNEST:
            yield f"{text}, {mass / volume:.2g} kg/m3: a length in mm has its unit, as 1200 mm"
        elif edges.max() > MAX_REACH * size > 0:
            yield f"{text}, where all points lie within {size:.4g} m: is it in these units?"


def _thin(scene: Scene) -> Iterator[str]:
    """Bodies without width that something on a joint turns about themselves."""
    for number in sorted(_active_hinges(scene)):
        hinge = scene.hinges[number]
        if hinge.slides:
            continue
        axis, point = _line(scene, hinge)
        for name, particle in scene.bodies.items():
            if particle not in hinge.particles:
                continue
            distance = np.linalg.norm(np.cross(axis, scene.position[particle] - point))
            shares = (axis @ scene.frame[particle]) ** 2
            inertia = shares @ scene.inertia[particle] + scene.mass[particle] * distance**2
            if inertia < 1e-5 * scene.inertia[particle].max():
                yield (
                    f"body {name} has no width, and what acts on joint {hinge.name} turns it about "
                    "its own axis: give it a `diameter`, or an inertia about that"
                )


def _line(scene: Scene, hinge: Hinge) -> tuple[np.ndarray, np.ndarray]:
    """Axis (3,) of a hinge at the start, in global axes, and a point (3,), m, on it."""
    first = hinge.beams[0]
    return scene.frame[first.particle] @ hinge.axes[0], first.end_in(scene)


def _actions(scene: Scene) -> list[Any]:
    """Elements that act on openings of hinges."""
    return [e for kind in kinds_of([scene]) if kind.acts_as for e in kind.find(scene)]


def _active_hinges(scene: Scene) -> set[int]:
    """Indices of the hinges on whose openings something acts."""
    return {hinge for element in _actions(scene) for hinge in element.acts_on()}


def extent(scene: Scene) -> float:
    """Return the largest extent (m) along a global axis of a scene's particles, hinges, slides and
    named points; 0 without a hinge and a named point. Other joints do not count."""
    beams = [beam for hinge in scene.hinges for beam in hinge.beams]
    points = [beam.end_in(scene) for beam in (*beams, *scene.points.values())]
    return float(np.ptp(np.array([*scene.position, *points]), axis=0).max()) if points else 0.0


def _loose(scene: Scene) -> Iterator[str]:
    """Parts at the end of a joint on which nothing acts, where nothing else moves them."""
    if _is_moved(scene):
        return
    hinges = _active_hinges(scene) | scene.bearings.keys()
    active_joints = {scene.hinges[hinge].joint for hinge in hinges}
    rows, names = report.jacobian(scene)
    for part in range(rows.shape[1] // 6):
        is_its: Any = rows[:, 6 * part : 6 * part + 6].any(axis=1)
        owners = [name for name, condition in zip(names, is_its, strict=True) if condition]
        joint = owners[0].removeprefix("joint ") if owners else ""
        is_last = len(set(owners)) == 1 and len(owners) < 6 and owners[0].startswith("joint ")
        if is_last and joint not in active_joints:
            yield (
                f"a part hangs at joint {joint} alone, on which nothing acts; mobility "
                f"{report.mobility(scene).degrees}: is another joint missing, or a spring here?"
            )


def _is_moved(scene: Scene) -> bool:
    """Return whether a scene moves at the start, or something but what acts on joints moves it."""
    is_moved = np.any(scene.gravity) or scene.velocity.any() or scene.spin.any()
    forces = (kind for k in (Load, Drag, Drive, Cable, Strut) for kind in k.find(scene))
    return bool(is_moved or any(forces) or scene.opening_rates)


def _rigid(scene: Scene) -> Iterator[str]:
    """Warn if nothing can move, where nothing is elastic or joints are to open, and name what holds
    it."""
    if scene.drives or not (scene.hinges or scene.kinds.get(Joint)):
        return
    if scene.beams and (scene.assembly is not None or not _active_hinges(scene)):
        return
    rows, names = report.jacobian(scene)
    if len(rows) < rows.shape[1] or report.mobility(scene).degrees:
        return
    ends = scene.supports.items()
    support_names = [f"support {name}" for name, arm in ends if scene.fixed[arm.particle].all()]
    keys = sorted(dict.fromkeys(names), key=lambda key: key.startswith("joint"))
    labels = np.array(names)
    blockers = [key for key in keys if dependence(rows[labels != key])[0] < rows.shape[1]]
    owners = [*support_names, *blockers] or keys
    text = ", ".join(owners[:MOST]) + ", ..." * (len(owners) > MOST)
    yield (
        f"nothing can move{' but by bending' if scene.beams else ': no part is elastic'}, and "
        f"it is held by {text}: check axes, take one of these away, or let a support hold less "
        "(`translations`, `rotations`)"
    )


def _stuck(scene: Scene) -> Iterator[str]:
    """Friction that bears all that springs give at the start, where nothing else moves parts."""
    is_driven = not {"motor", "contact"}.isdisjoint(e.acts_as for e in _actions(scene))
    is_strained = scene.assembly is not None or scene.unstrained is not None
    if is_driven or scene.curves or is_strained or _is_moved(scene):
        return
    pushes: dict[int, float] = defaultdict(float)
    bounds: dict[int, float] = defaultdict(float)
    for spring in (*TorsionSpring.find(scene), *TableSpring.find(scene)):
        pushes[spring.hinge] += _moment(spring, scene.hinges[spring.hinge].opening)
    for friction in Friction.find(scene):
        if friction.load is None:
            share, opening = 1.0, scene.hinges[friction.hinge].opening
            if friction.angles:
                share = float(np.interp(opening, friction.angles, friction.shares))
            bounds[friction.hinge] += share * friction.moment
    active = {hinge: abs(push) for hinge, push in pushes.items() if push}
    if active and all(bounds[hinge] > push for hinge, push in active.items()):
        h, push = next(iter(active.items()))
        unit = "N" if scene.hinges[h].slides else "N m"
        yield (
            "nothing moves at the start: friction bears what the springs give, on "
            f"{scene.hinges[h].name} {bounds[h]:.4g} {unit} against {push:.4g}: take less "
            "friction, or stronger springs"
        )


def _usual(noun: str, value: float, owner: str) -> Iterator[str]:
    least, most, unit = USUAL[noun]
    if not least <= value <= most:
        yield f"{noun} of {owner}: {value:.4g} {unit}; usual: {least:g} to {most:g} {unit}"


def _support(scene: Scene) -> Iterator[str]:
    is_loaded = np.any(scene.gravity) or Load.find(scene)
    if is_loaded and not (scene.fixed.any() or scene.supports):
        yield "nothing holds it, neither a support nor a joint with the ground: it falls, or drifts"


def _bearings(scene: Scene) -> Iterator[str]:
    moving = {friction.hinge for friction in Friction.find(scene) if friction.load is not None}
    for hinge in sorted(scene.bearings.keys() - moving):
        yield f"bearing of {scene.hinges[hinge].name}: without a `load` it counts in margins only"


def _tables(scene: Scene) -> Iterator[str]:
    """Struts that are not within their table at the start, where a force of its end acts."""
    for strut in Strut.find(scene):
        lengths, start = strut.lengths, strut.distance(scene)
        end = 0 if start < lengths[0] else -1
        is_inside = lengths[0] * (1 - 1e-9) <= start <= lengths[-1] * (1 + 1e-9)
        if len(lengths) > 1 and not is_inside and strut.forces[end]:
            yield (
                f"{strut.title(scene)} is {start:.4g} m long at the start, and its table from "
                f"{lengths[0]:g} to {lengths[-1]:g} m, so that a constant {strut.forces[end]:.4g} "
                "N acts until it gets there: state `lengths` that hold its start"
            )


def _latch(scene: Scene, latch: Latch, duration: float | None) -> Iterator[str]:
    """Describe what keeps a latch from catching: a stop, its side, springs, time."""
    hinge = scene.hinges[latch.hinge]
    start, travel = hinge.opening, latch.angle - hinge.opening
    head = f"latch {latch.label(scene)} at {opening_text(hinge, latch.angle)}"
    for stop in Stop.find(scene):
        side = {"above": 1, "below": -1}[stop.side]
        if stop.hinge == latch.hinge and 0 < side * (stop.angle - start) < side * travel:
            yield f"{head} is beyond the stop at {opening_text(hinge, stop.angle)}: it cannot catch"
    if SIDES[latch.side] * travel < 0 and abs(travel) > max(latch.capture_range, 1e-9):
        start_side = "above" if latch.side == "below" else "below"
        yield (
            f"{head} catches from {latch.side}, but its joint starts {start_side} it, at "
            f"{opening_text(hinge, start)}, and can be caught on the way back only: take `side: "
            f"{start_side}`"
        )
    yield from _springs(scene, latch.hinge, travel, head, duration)


def _release(scene: Scene, release: Release, duration: float | None) -> Iterator[str]:
    """Warn of what keeps a release from letting go."""
    head, hinge = f"release on {scene.hinges[release.hinge].name}", scene.hinges[release.watch]
    is_timed = release.time < np.inf
    if is_timed and (release.watch < 0 if duration is None else release.time <= duration):
        return
    end = f"; only its time, {release.time:g} s, lets go" if is_timed else ""
    if release.latch:
        hinges = [latch.hinge for latch in Latch.find(scene) if latch.label(scene) == release.latch]
        if release.hinge in hinges:
            end = end or ", or state a `time`"
            text = f"{head} watches latch {release.latch} on the joint that it holds"
            yield f"{text}: watch a latch of another joint{end}"
        return
    if release.watch < 0:
        yield f"{head} lets go at {release.time:g} s: the run ends at {duration:g} s"
        return
    if release.watch == release.hinge:
        end = end or ", or state a `time`"
        yield f"{head} watches the joint that it holds: watch another one{end}"
        return
    level = opening_text(hinge, release.level)
    if reason := find_barrier(scene, release.watch, release.level):
        head += f" waits until {hinge.name} passes {level}, {reason}"
        yield f"{head}: take a level before that{end}"
        return
    travel = release.level - hinge.opening
    texts = _springs(scene, release.watch, travel, f"the {level} that {head} waits for", duration)
    yield from (f"{text}{end}" for text in texts)


GIVES = 0.9
"""Part of the way to an opening by which a latch or stop surely keeps a joint from it."""


def find_barrier(scene: Scene, number: int, level: float, part: float = 1.0) -> str:
    """Return which latch or stop keeps a joint from an opening, as "beyond 90 deg, where latch a
    catches", or "beyond the stop at 90 deg"; "" if none does. number: index of the hinge; level:
    the opening (rad, on a slide m); part: of the way there from the start that is looked at."""
    hinge = scene.hinges[number]
    travel = part * (level - hinge.opening)
    sign = float(np.sign(travel))
    for latch in Latch.find(scene):
        place = sign * (latch.angle - hinge.opening)
        is_met = latch.hinge == number and place > 0 and SIDES[latch.side] * sign >= 0
        is_met &= not latch.is_ratchet
        if is_met and place - latch.capture_range < abs(travel) - 1e-9:
            edge = opening_text(hinge, latch.angle - sign * latch.capture_range)
            return f"beyond {edge}, where latch {latch.label(scene)} catches"
    for stop in Stop.find(scene):
        side = {"above": 1, "below": -1}[stop.side]
        place = side * (stop.angle - hinge.opening)
        if stop.hinge == number and side == sign and 0 < place < abs(travel):
            return f"beyond the stop at {opening_text(hinge, stop.angle)}"
    return ""


def _springs(scene: Scene, number: int, travel: float, head: str, duration) -> Iterator[str]:
    """Describe what keeps the springs on a hinge, where nothing else leads it, from moving it by
    `travel` (rad, m) to a latch or level, `head`. number: index of the hinge."""
    actions = [e for e in _actions(scene) if number in e.acts_on()]
    springs = [e for e in actions if e.acts_as == "spring"]
    is_led = not {"motor", "loop", "release"}.isdisjoint(e.acts_as for e in actions)
    if not springs or abs(travel) < 1e-9 or is_led:
        return
    hinge = scene.hinges[number]
    start, end = hinge.opening, hinge.opening + travel
    push, end_push = (sum(_moment(spring, x) for spring in springs) for x in (start, end))
    unit = "N" if hinge.slides else "N m"
    if push * travel < 0:
        remedy = "give them a `rest` beyond it, or a `preload` of the other sign"
        if all(isinstance(spring, TableSpring) for spring in springs):
            remedy = f"give their `{'forces' if hinge.slides else 'moments'}` the other sign"
        text = f"the springs on {hinge.name} push away from {head}, with {abs(push):.4g} {unit}"
        yield f"{text}: {remedy}"
        return
    if end_push * travel < 0 and all(isinstance(spring, TorsionSpring) for spring in springs):
        text = "only momentum gets there, or a `rest` beyond it"
        yield f"{head} is beyond where the springs on {hinge.name} rest: {text}"
    fastest = _acceleration(scene, hinge, abs(push))
    least = np.sqrt(2 * abs(travel) / fastest) if fastest else np.inf
    is_moved = scene.opening_rates or Load.find(scene) or scene.cables or Strut.find(scene)
    is_moved = is_moved or Gravity.curve_of(scene) >= 0
    is_alone = not (scene.velocity.any() or scene.spin.any() or is_moved)
    if duration is not None and is_alone and duration < least / 2 < np.inf:
        weight = " and the weight" if np.any(scene.gravity) else ""
        yield (
            f"{duration:g} s are too short for {head}: from {opening_text(hinge, start)}, the "
            f"{abs(push):.4g} {unit} of the springs{weight} take {least:.2g} s or more; take a "
            "longer duration"
        )


SLOWER = 6.0
"""Time in which structures open by the least that their springs need, by which the library's do."""


def run_duration(scene: Scene) -> float:
    """Return a time (s) in which what moves a scene has acted: SLOWER times the least that springs
    need to latches or rest; a swing by weight; the end of curves; 1 without these."""
    times = [float(curve.times[-1]) for curve in scene.curves]
    gravity = np.linalg.norm(scene.gravity)
    if gravity and scene.hinges:
        times.append(float(2 * np.pi * np.sqrt(extent(scene) / gravity)))
    springs = [e for kind in (TorsionSpring, TableSpring) for e in kind.find(scene)]
    for number in {spring.hinge for spring in springs}:
        hinge, hinge_springs = scene.hinges[number], [s for s in springs if s.hinge == number]
        rests = [s.rest if isinstance(s, TorsionSpring) else s.angles[-1] for s in hinge_springs]
        ends = [latch.angle for latch in Latch.find(scene) if latch.hinge == number] or rests
        travel = max(abs(end - hinge.opening) for end in ends)
        push = abs(sum(_moment(spring, hinge.opening) for spring in hinge_springs))
        fastest = _acceleration(scene, hinge, push) if push else np.inf
        times.append(SLOWER * float(np.sqrt(2 * travel / fastest)))
    return max(times, default=0.0) or 1.0


def _moment(spring: TorsionSpring | TableSpring, opening: float) -> float:
    """Return the moment (N m), or force (N), of a spring at an opening."""
    if isinstance(spring, TableSpring):
        return float(np.interp(opening, spring.angles, spring.moments))
    return spring.stiffness * (spring.rest - opening)


def _acceleration(scene: Scene, hinge: Hinge, moment: float) -> float:
    """Largest acceleration (rad/s2, m/s2) of an opening by a moment (N m; N) and weight."""
    numbers, (axis, point) = report.bodies(scene), _line(scene, hinge)
    gravity, result = float(np.linalg.norm(scene.gravity)), 0.0
    for beam in hinge.beams:
        body = numbers == numbers[beam.particle]
        if scene.fixed[body].all(axis=1).any():
            continue
        arms = np.linalg.norm(np.cross(axis, scene.position[body] - point), axis=1)
        axes = np.einsum("nij,i->nj", scene.frame[body], axis) ** 2
        inertia, lever = float(scene.mass[body].sum()), float(scene.mass[body].sum())
        if not hinge.slides:
            inertia = float(scene.mass[body] @ arms**2 + (axes * scene.inertia[body]).sum())
            lever = float(scene.mass[body] @ (arms + abs(hinge.lead)))
        result += (moment + lever * gravity) / inertia
    return result


def opening_text(hinge: Hinge, opening: float) -> str:
    """Return a joint coordinate as text for messages, to 4 digits: "90 deg" or, on a slide, "0.1
    m". hinge: its joint; opening: its value, rad, on a slide m; below 5e-10 it counts as 0."""
    opening = round(opening, 9) + 0.0
    return f"{opening:.4g} m" if hinge.slides else f"{np.degrees(opening):.4g} deg"
