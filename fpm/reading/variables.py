"""What a run records on request: one table of variables, and what becomes of a request.

Each variable has columns along a dimension of its own in a trajectory file; a column's label says
of what it is: a name, and the part of it (an axis, a component, who acts) where there are several.
A request names columns, as (variable, label)."""

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from fpm.declare import SLIDE_UNITS
from fpm.elements.joints.hinge import Hinge
from fpm.elements.joints.hinge_arrays import SUMS
from fpm.elements.joints.joint import Joint
from fpm.elements.kind import AXES, Series
from fpm.elements.openings.opening import PARTS
from fpm.elements.particles.probe import Probe
from fpm.errors import SceneError, did_you_mean
from fpm.files.trajectory import LED_OVER, Column
from fpm.reading import bars, margins
from fpm.reading.bars import Bar, element_stress, ends_of, half_sizes
from fpm.reading.constraint_forces import couple_on_two, joints_of, reaction, reactions_of
from fpm.reading.recording import Recording, Sides
from fpm.scenes.scene import Scene

MOST_PAIRS = 1 << 20
"""Number of pairs of elements at instants that are looked at together, at most."""


def find_clearance(scene: Scene, first: Bar, second: Bar, place, axes) -> np.ndarray:
    """Return a lower bound (t,) m of the distance between the surfaces of two bars, equal to it
    where sides or edges face each other; one that is not above 0 does not show that they overlap.
    place(i), axes(i): positions (t, 3) m and frames (t, 3, 3) of particle i."""
    lines1, lines2 = (_lines(scene, bar, place, axes) for bar in (first, second))
    count, pairs = len(lines1[0]), lines1[0].shape[1] * lines2[0].shape[1]
    size = max(1, MOST_PAIRS // pairs)
    distances = []
    for k in range(0, count, size):
        pair = ([array[k : k + size] for array in lines] for lines in (lines1, lines2))
        distances.append(_shortest(*pair))
    return np.concatenate(distances)


def _lines(scene: Scene, bar: Bar, place, axes) -> tuple[np.ndarray, ...]:
    """Elements of a bar: start and end (t, m, 3) m, half sizes of their sections along axes y and z
    as vectors (t, m, 2, 3) m, and radii (t, m) m of round ones."""
    lines = []
    for beams in bar.groups:
        (start, section_axes), (end, _) = ends_of(scene, beams, place, axes)
        y, z = half_sizes(beams.section)
        is_round = beams.section.outline == "round"
        sides = section_axes.swapaxes(2, 3) * (0.0 if is_round else np.array([[y], [z]]))
        lines.append((start, end, sides, np.full(start.shape[:2], y if is_round else 0.0)))
    return tuple(np.concatenate(arrays, axis=1) for arrays in zip(*lines, strict=True))


def _shortest(lines1: Sequence[np.ndarray], lines2: Sequence[np.ndarray]) -> np.ndarray:
    """Return the shortest distance (t,) m of the elements of one bar, m, from those of another, n,
    each as of `_lines`."""
    (start1, end1, sides1, radius1), (start2, end2, sides2, radius2) = lines1, lines2
    line = nearest(start1[:, :, None], end1[:, :, None], start2[:, None], end2[:, None])
    distance = np.linalg.norm(line, axis=-1)  # (t, m, n)
    direction = line / np.maximum(distance, 1e-300)[..., None]
    widths = radius1[:, :, None] + radius2[:, None]
    widths = widths + np.abs(np.einsum("tmki,tmni->tmnk", sides1, direction)).sum(axis=-1)
    widths = widths + np.abs(np.einsum("tnki,tmni->tmnk", sides2, direction)).sum(axis=-1)
    return (distance - widths).min(axis=(1, 2))


def nearest(a, b, c, d) -> np.ndarray:
    """Return the shortest vector (..., 3), m, from segment a b to segment c d. a, b, c, d: ends of
    the segments (..., 3), m."""
    u, v, w = b - a, d - c, c - a

    def to_segment(point, start, chord):
        fraction = np.sum((point - start) * chord, axis=-1) / np.sum(chord * chord, axis=-1)
        return start + np.clip(fraction, 0.0, 1.0)[..., None] * chord - point

    uu, vv, uv = (np.sum(p * q, axis=-1) for p, q in ((u, u), (v, v), (u, v)))
    uw, vw = np.sum(u * w, axis=-1), np.sum(v * w, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        det = uu * vv - uv * uv
        s, t = (uw * vv - vw * uv) / det, (uw * uv - vw * uu) / det
    is_inside = (det > 1e-12 * uu * vv) & (s > 0) & (s < 1) & (t > 0) & (t < 1)
    s, t = np.where(is_inside, s, 0.0)[..., None], np.where(is_inside, t, 0.0)[..., None]
    line = w + t * v - s * u  # where not inside: from a to c, which is not shorter
    lines = [line, to_segment(a, c, v), to_segment(b, c, v)]
    lines += [-to_segment(c, a, u), -to_segment(d, a, u)]
    shape = np.broadcast_shapes(*(vector.shape for vector in lines))
    vectors = np.stack([np.broadcast_to(vector, shape) for vector in lines])
    best = np.sum(vectors**2, axis=-1).argmin(axis=0)
    return np.take_along_axis(vectors, best[None, ..., None], axis=0)[0]


PLACE = " at "  # between a bar and the share of its length


LED_FROM = " led "  # between an opening and its travel


class Variable(NamedTuple):
    """A variable that runs record on request. unit (UDUNITS), long_name: of its values;
    names(scene): returns names of items that it may be recorded of; probe(scene, name): returns
    what the time loop has to record for an item; values(recording, name): returns (t,), or (t,
    parts); parts: components of each item, as "x". response_form: how a definition of a response
    names a column (key of `fpm.reading.responses.FORMS`), "": there is no response of that name;
    shock: whether an impact makes it jump (`fpm.reading.shocks`); positive: whether it is never
    below 0; dim_suffix: the labels' dimension in files is <name>_<dim_suffix>; separator: text in a
    label before which the item's name ends, "": none; time_dim: dimension of its values."""

    unit: str
    long_name: str
    names: Callable[[Scene], Iterable[str]]
    probe: Callable[[Scene, str], Probe]
    values: Callable[[Recording, str], np.ndarray]
    parts: Sequence[str] = ()
    response_form: str = ""
    shock: bool = False
    positive: bool = False
    dim_suffix: str = "of"
    separator: str = ""
    time_dim: str = "time"

    def labels(self, scene: Scene) -> list[str]:
        """Return the labels of the columns that a scene has of this variable, as "tip x"; of
        sections of bars only those in the middle, of travels none, as there is one at any place."""
        if self.separator == LED_FROM:
            return []
        place = f"{PLACE}0.5" if self.response_form == "section" else ""
        names = [f"{name}{place}" for name in self.names(scene)]
        return [f"{name} {part}" for name in names for part in self.parts] if self.parts else names

    def split(self, label: str) -> tuple[str, str]:
        """Split the label of a recorded column, such as "hinge1 spring", at its last space into the
        item's name and its component, one of `parts`; the latter is "" if the variable has none."""
        return label.rpartition(" ")[::2] if self.parts else (label, "")

    def unit_of(self, scene: Scene, labels: Iterable[str]) -> str:
        """Return the unit of recorded columns of one scene: `unit`; of quasi-static travels of
        slides that of slides, "" if only some are of slides. labels: the columns'."""
        if self.separator != LED_FROM:
            return self.unit
        slides = {hinge.name for hinge in scene.hinges if hinge.slides}
        paths = [margins.read_label(label)[0] for label in labels]
        units = {SLIDE_UNITS[self.unit] if p.openings[0] in slides else self.unit for p in paths}
        return units.pop() if len(units) == 1 else ""

    def column(self, recording: Recording, label: str) -> np.ndarray:
        """Return the values (t,), in `unit`, of a column of a run. recording: what the time loop
        recorded of it; label: name of item and component, as "tip x"."""
        name, part = self.split(label)
        values = self.values(recording, name)
        return values[:, self.parts.index(part)] if self.parts else values


# -- points, bodies, openings ---------------------------------------------------------------------


def _rotations(scene: Scene) -> dict[str, int]:
    """Names with an angular velocity, bodies and named points, and their particles."""
    return {**{name: beam.particle for name, beam in scene.points.items()}, **scene.bodies}


def _acceleration(recording: Recording, name: str) -> np.ndarray:
    beam = recording.scene.points[name]
    change, angular = recording.acceleration(beam.particle)
    spin, arm = recording.spin(beam.particle), recording.arm(beam)
    return change + np.cross(angular, arm) + np.cross(spin, np.cross(spin, arm))


def _hinge(scene: Scene, name: str) -> int:
    return [hinge.name for hinge in scene.hinges].index(name)


def _opening_rate(recording: Recording, name: str) -> np.ndarray:
    hinge = recording.scene.hinges[_hinge(recording.scene, name)]
    first, second = hinge.particles
    axis = recording.axes(first) @ hinge.axes[0]
    if not hinge.slides:
        return np.sum(axis * (recording.spin(second) - recording.spin(first)), axis=1)
    point = recording.place(second) + recording.arm(hinge.beams[1])
    first, second = (
        recording.velocity(p) + np.cross(recording.spin(p), point - recording.place(p))
        for p in (first, second)
    )
    return np.sum(axis * (second - first), axis=1)


def _openings(scene: Scene, slides: bool) -> list[str]:
    """Names of the hinges whose openings are lengths, or not."""
    return [hinge.name for hinge in scene.hinges if hinge.slides == slides]


def _moments(recording: Recording, name: str) -> np.ndarray:
    return recording.moments(_hinge(recording.scene, name))[0]


# -- joints and supports --------------------------------------------------------------------------


def _keep_joint(scene: Scene, name: str) -> Probe:
    return Probe(frames=joints_of(scene)[name].particles, impulses=True)


def _joint(recording: Recording, name: str) -> tuple[Hinge | Joint, Sides]:
    return next(pair for pair in recording.joints if pair[0].name == name)


def _keep_reaction(scene: Scene, name: str) -> Probe:
    support = reactions_of(scene)[name]
    particle = support.beam.particle
    joints = [*Hinge.find(scene), *Joint.find(scene)]
    particles = {p for joint in joints if particle in joint.particles for p in joint.particles}
    frames = tuple(sorted(particles | {particle}))
    return Probe(frames, (particle,) if support.particle else (), impulses=bool(joints))


# -- bars -----------------------------------------------------------------------------------------


def _keep_bars(scene: Scene, names: Iterable[str]) -> Probe:
    by_name = bars.bars_of(scene)
    return Probe(frames=tuple({p for name in names for p in by_name[name].particles}))


def _in_section(index: int, recording: Recording, name: str) -> np.ndarray:
    bar, _, fraction = name.partition(PLACE)
    return bars.at_fraction(*recording.sections(bar), float(fraction))[index]


def _chosen_bars(scene: Scene, name: str) -> list[str]:
    return list(bars.bars_of(scene)) if name == "all" else [name]


def _stress(recording: Recording, name: str) -> np.ndarray:
    table = bars.bars_of(recording.scene)
    largest = np.zeros(len(recording.time))
    for bar in _chosen_bars(recording.scene, name):
        stress = element_stress(recording.scene, table[bar].groups, recording.place, recording.axes)
        largest = np.maximum(largest, stress.max(axis=1))
    return largest


def _clearance(recording: Recording, name: str) -> np.ndarray:
    first, second = (bars.bars_of(recording.scene)[bar] for bar in name.split(" to "))
    return find_clearance(recording.scene, first, second, recording.place, recording.axes)


def _travel(recording: Recording, name: str, variable: str) -> np.ndarray:
    joint, part = margins.read_label(name)
    travel = recording.memoize(joint, lambda: margins.travel_of(recording.scene, joint))
    return margins.column_of(travel, variable, part)


_vector = partial(Variable, parts=AXES, response_form="vector")
_of_opening = partial(
    Variable,
    probe=lambda scene, name: Probe(forces=scene.hinges[_hinge(scene, name)].particles),
    values=_opening_rate,
)
_by_who_acts = partial(
    Variable, probe=lambda scene, name: Probe(moments=True), parts=PARTS, dim_suffix="by"
)
_in_bar = partial(
    Variable,
    names=bars.bars_of,
    probe=lambda scene, name: _keep_bars(scene, [name.partition(PLACE)[0]]),
    response_form="section",
    shock=True,
    separator=PLACE,
)
_travel_variable = partial(
    Variable,
    names=lambda scene: [hinge.name for hinge in scene.hinges],
    probe=lambda scene, name: Probe(),
    dim_suffix="along",
    separator=LED_FROM,
    time_dim=LED_OVER,
)

VARIABLES = {
    "acceleration": _vector(
        "m s-2", "acceleration of points along global axes",
        lambda scene: scene.points,
        lambda scene, name: Probe(forces=(scene.points[name].particle,)),
        _acceleration, shock=True,
    ),
    "angular_velocity": _vector(
        "rad s-1", "angular velocity of points and bodies about global axes",
        _rotations,
        lambda scene, name: Probe(forces=(_rotations(scene)[name],)),
        lambda recording, name: recording.spin(_rotations(recording.scene)[name]),
    ),
    "opening_rate": _of_opening(
        "rad s-1", "rate of the opening of hinges", partial(_openings, slides=False)
    ),
    "slide_rate": _of_opening(
        "m s-1", "rate of the opening of slides", partial(_openings, slides=True)
    ),
    "joint_moment": _by_who_acts(
        "N m", "moment on the second part of a hinge about its axis, by who acts",
        partial(_openings, slides=False), values=_moments,
    ),
    "joint_force": _by_who_acts(
        "N", "force on the second part of a slide along its axis, by who acts",
        partial(_openings, slides=True), values=_moments,
    ),
    "joint_work": _by_who_acts(
        "J", "work of moments and forces on joints so far, by who acts",
        lambda scene: [hinge.name for hinge in scene.hinges],
        values=lambda recording, name: recording.moments(_hinge(recording.scene, name))[1],
    ),
    "constraint_force": _vector(
        "N", "force by which a joint keeps its second part, along global axes",
        joints_of, _keep_joint, lambda recording, name: _joint(recording, name)[1].force2,
        shock=True,
    ),
    "constraint_moment": _vector(
        "N m", "moment by which a joint keeps its second part, about its point and global axes",
        joints_of, _keep_joint,
        lambda recording, name: couple_on_two(recording, *_joint(recording, name)), shock=True,
    ),
    "reaction_force": _vector(
        "N", "force of a support or drive on the structure, along global axes",
        reactions_of, _keep_reaction, lambda recording, name: reaction(recording, name)[0],
        shock=True,
    ),
    "reaction_moment": _vector(
        "N m", "moment of a support or drive about its point and global axes",
        lambda scene: [name for name, reaction in reactions_of(scene).items() if reaction.particle],
        _keep_reaction, lambda recording, name: reaction(recording, name)[1], shock=True,
    ),
    "section_force": _in_bar(
        "N", "force in a section of a bar along its own axes",
        values=partial(_in_section, 0), parts=bars.FORCES,
    ),
    "section_moment": _in_bar(
        "N m", "moment in a section of a bar about its own axes",
        values=partial(_in_section, 1), parts=bars.MOMENTS,
    ),
    "stress": Variable(
        "Pa", "largest equivalent stress (von Mises) in bars",
        lambda scene: ["all", *bars.bars_of(scene)] if scene.beams else [],
        lambda scene, name: _keep_bars(scene, _chosen_bars(scene, name)),
        _stress, response_form="bar", shock=True, positive=True,
    ),
    "clearance": Variable(
        "m", "shortest distance of the surfaces of two bars",
        lambda scene: [" to ".join(pair) for pair in combinations(bars.bars_of(scene), 2)],
        lambda scene, name: _keep_bars(scene, name.split(" to ")),
        _clearance, response_form="bars",
    ),
    margins.OPENING: _travel_variable(
        "rad", "opening (rad; of slides m) that is moved quasi-statically, at each position; the "
        "last one again where others have more", values=partial(_travel, variable=margins.OPENING),
    ),
    margins.WORK: _travel_variable(
        "N m", "virtual work of a part per rad (on slides N, per m) of an opening that is moved "
        "quasi-statically", values=partial(_travel, variable=margins.WORK),
    ),
    margins.INERTIA: _travel_variable(
        "kg m2", "inertia (kg m2; on slides mass, kg) that an opening moves",
        values=partial(_travel, variable=margins.INERTIA),
    ),
}  # fmt: skip


def add_probe(scene: Scene, columns: Iterable[Column]) -> Scene:
    """Return a copy of a scene with the probe that records `columns`, (variable, label); the scene
    itself if there are none. SceneError for a label that it does not have."""
    columns = list(columns)
    if not columns:
        return scene
    probes = []
    for name, label in columns:
        variable = VARIABLES[name]
        subject, part = variable.split(label)
        place = subject.partition(variable.separator)[0] if variable.separator else subject
        if place not in variable.names(scene) or part not in (variable.parts or [""]):
            labels = variable.labels(scene)
            allowed = f"one of {', '.join(labels) or '(this scene has none)'}"
            raise SceneError(name, label, allowed + did_you_mean(label, labels))
        probes.append(variable.probe(scene, subject))
    forces = sorted({p for probe in probes for p in probe.forces})
    frames = sorted({p for probe in probes for p in probe.frames} | set(forces))
    probe = Probe(
        tuple(frames),
        tuple(forces),
        any(probe.moments for probe in probes),
        any(probe.impulses for probe in probes),
    )
    result = copy(scene)
    result.kinds = {**scene.kinds, Probe: [probe]}
    return result


def count_values(scene: Scene, columns: Iterable[Column]) -> int:
    """Return how many numbers a run stores at each instant to record `columns`."""
    from fpm.elements.particles import probe_kernels

    probe = Probe.of_scene(add_probe(scene, columns))
    count = probe_kernels.FRAME * len(probe.frames) + probe_kernels.FORCES * len(probe.forces)
    joints = len(Hinge.find(scene)) + len(Joint.find(scene))
    moments = 2 * len(PARTS) * len(scene.hinges)
    return count + SUMS * joints * probe.impulses + moments * probe.moments


def read_records(recording: Recording, columns: Iterable[Column]) -> dict[str, Series]:
    """Return what was recorded of a run in the form of trajectory files: a Series by variable,
    values (t, labels). recording: what the time loop recorded; columns: pairs (variable, label)."""
    series = {}
    for name, labels in _by_variable(columns).items():
        variable = VARIABLES[name]
        curves = [variable.column(recording, label) for label in labels]
        rows = max(map(len, curves))  # travels have positions of their own
        curves = [np.pad(column, (0, rows - len(column)), mode="edge") for column in curves]
        dimension, axis = f"{name}_{variable.dim_suffix}", variable.time_dim
        values = np.stack(curves, axis=1)
        unit, text = variable.unit_of(recording.scene, labels), variable.long_name
        series[name] = Series(values, unit, text, dimension, labels, axis)
    return series


def words(columns: Iterable[Column]) -> str:
    """Return `columns`, pairs (variable, label), in words for messages: "velocity of a, b; ..."."""
    return "; ".join(
        f"{name.replace('_', ' ')} of {', '.join(labels)}"
        for name, labels in _by_variable(columns).items()
    )


def _by_variable(columns: Iterable[Column]) -> dict[str, tuple[str, ...]]:
    """Labels by variable, each once."""
    by_name: dict[str, dict[str, None]] = {}
    for variable, label in columns:
        by_name.setdefault(variable, {})[label] = None
    return {variable: tuple(labels) for variable, labels in by_name.items()}
