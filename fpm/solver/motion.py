"""The whole motion of a run: every particle with its frame, every element's strain and stress.

A trajectory holds a few named points. Here the run is made again with a named point at every
particle and at two arms of one metre along its axes; points do not influence the motion, so that it
is the trajectory's bit for bit. Strains follow outside the time loop. As a dataset it has CF-like
names and units; its elements are those of bars, and rigid bodies: one particle at both ends,
without strain."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fpm.assembly.conditions import ParticlePoses
from fpm.assembly.elastic import elastic_of
from fpm.elements import Cable, Strut
from fpm.elements.bars.beam import elements_of
from fpm.elements.kind import VirtualBeam
from fpm.errors import SceneError
from fpm.files.outcome import Outcome
from fpm.files.trajectory import CONVENTIONS, Column
from fpm.reading.bars import element_stress
from fpm.scenes.scene import Scene
from fpm.solver.simulate import simulate

if TYPE_CHECKING:
    import xarray


BOX_CORNERS = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
"""Corners of a section along its width and height, as shares of them."""


class RecordedMotion(NamedTuple):
    """Motion of a scene's n particles and m beam elements in one run, at all t recorded instants or
    at k of them. scene: the scene; outcome: the run's, with its named points and events; rows (k,):
    indices of the k instants; position (t, n, 3): m; velocity (k, n, 3): m/s; frame (t, n, 3, 3):
    own axes as columns; axial (k, m): strains, above 0 in tension; bending (k, m): largest strains
    by bending at the surface, at least 0."""

    scene: Scene
    outcome: Outcome
    rows: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    frame: np.ndarray
    axial: np.ndarray
    bending: np.ndarray


class Shapes(NamedTuple):
    """The s shapes to draw of a scene: beam elements, then rigid bodies as boxes. names: of each;
    nodes (s, 2): indices of the particles at both ends, bodies' twice; length (s,): m; half (s, 2):
    half width and height (m); corners (s, 2, 4, 3), m: of ends, from the particle in its axes."""

    names: list[str]
    nodes: np.ndarray
    length: np.ndarray
    half: np.ndarray
    corners: np.ndarray


def shapes_of(scene: Scene, corners: np.ndarray) -> Shapes:
    """Return the shapes to draw of a scene. corners: of `section_corners`. A rigid body, a particle
    on no bar that is free to move in some way or named, is the box of its mass and inertias: edges
    a, b, c with b² + c² = 12 I/m etc."""
    nodes, length, half = elements_of(scene.beams)
    names = [f"{b.name}[{i}]" for b in scene.beams for i in range(len(b.length))]
    free = np.flatnonzero(~scene.fixed.all(axis=1))
    bodies = np.setdiff1d([*free, *scene.bodies.values()], nodes).astype(int)
    inertia = scene.inertia[bodies]
    squares = 6.0 * (inertia.sum(axis=1, keepdims=True) - 2.0 * inertia)
    edges = np.sqrt(np.maximum(squares / scene.mass[bodies, None], 0.0))
    ends = np.zeros((len(bodies), 2, 4, 3))
    ends[..., 0] = 0.5 * edges[:, None, None, 0] * np.array([-1.0, 1.0])[:, None]
    ends[..., 1:] = (edges[:, None, 1:] * BOX_CORNERS)[:, None]
    return Shapes(
        [*names, *(f"body {particle}" for particle in bodies)],
        np.concatenate([nodes, np.stack([bodies, bodies], axis=1)]),
        np.concatenate([length, edges[:, 0]]),
        np.concatenate([half, 0.5 * edges[:, 1:]]),
        np.concatenate([corners, ends]),
    )


def to_dataset(motion: RecordedMotion, corners: np.ndarray, attributes: dict) -> "xarray.Dataset":
    """Return a motion at its instants `rows` as an xarray.Dataset, rigid bodies among the elements.
    corners (m, 2, 4, 3): `section_corners` of its scene (m); attributes: further global ones."""
    import xarray

    scene, outcome, rows = motion.scene, motion.outcome, motion.rows
    shapes = shapes_of(scene, corners)
    zeros = np.zeros((len(rows), len(shapes.names) - motion.axial.shape[1]))
    motion = motion._replace(  # rigid bodies are not strained
        axial=np.hstack([motion.axial, zeros]), bending=np.hstack([motion.bending, zeros])
    )
    names = {
        "element": shapes.names,
        "point": list(scene.points),
        "hinge": [hinge.name for hinge in scene.hinges],
        "contact": [scene.hinges[contact.hinge].name for contact in scene.contacts],
    }
    time = {"units": "s", "long_name": "time", "standard_name": "time", "axis": "T"}
    variables = _changes(motion, len(shapes.names)) | _layout(scene, shapes) | _events(outcome)
    if lines := strands_of(scene):
        names["cable"] = [line.title(scene).removeprefix("cable ") for line in lines]
        variables |= _cables(motion, lines)
    return xarray.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": text})
            for name, (dims, values, unit, text) in variables.items()
        },
        coords={
            "time": ("time", outcome.time[rows], time),
            "axis": ("axis", list("xyz"), {"long_name": "axis, global or of the particle"}),
            **{n: (n, np.array(v, dtype=str), {"long_name": n}) for n, v in names.items()},
        },
        attrs={
            "Conventions": CONVENTIONS,
            "title": f"whole motion of scene {scene.name}",
            "source": "finite particle method",
            "history": f"fpm.solver.motion.whole_motion: steps of {outcome.step:.9g} s",
            "scene": scene.name,
            "time_step": outcome.step,
            **attributes,
        },
    )


def _changes(motion: RecordedMotion, elements: int) -> dict[str, tuple]:
    """What changes in time: name -> dimensions, values, units, long name."""
    rows = motion.rows
    stress = np.zeros((len(motion.position), elements))  # none in rigid bodies, which come last
    if beams := motion.scene.beams:
        poses = lambda p: motion.position[:, p], lambda p: motion.frame[:, p]
        stresses = element_stress(motion.scene, beams, *poses)
        stress[:, : stresses.shape[1]] = stresses
    vector, element = ("time", "particle", "axis"), ("time", "element")
    points = [motion.outcome.points[name][0][rows] for name in motion.scene.points]
    places = np.stack(points, axis=1) if points else np.zeros((len(rows), 0, 3))
    peak_time = motion.outcome.time[stress.argmax(axis=0)]
    return {
        "position": (vector, motion.position[rows], "m", "position of the particles"),
        "velocity": (vector, motion.velocity, "m s-1", "velocity of the particles"),
        "frame": ((*vector, "director"), motion.frame[rows], "1", "particle's axes, in columns"),
        "point_position": (("time", "point", "axis"), places, "m", "position of named points"),
        "axial_strain": (element, motion.axial, "1", "stretch over unstrained length"),
        "bending_strain": (element, motion.bending, "1", "largest bending strain at surface"),
        "stress": (element, stress[rows], "Pa", "largest equivalent stress (von Mises)"),
        "largest_stress": ("element", stress.max(axis=0), "Pa", "largest stress of all instants"),
        "largest_stress_time": ("element", peak_time, "s", "instant of the largest stress"),
    }


def _layout(scene: Scene, shapes: Shapes) -> dict[str, tuple]:
    """Connections and sizes; vectors in the frames of the particles."""
    points, hinges = list(scene.points.values()), scene.hinges

    def rows(values: list, *shape: int) -> np.ndarray:
        return np.array(values, float).reshape(-1, *shape)

    def whole(values: object) -> np.ndarray:
        return np.asarray(values).astype(np.int32)

    particles = whole(rows([hinge.particles for hinge in hinges], 2))
    arms, axes = [hinge.beams[0].arm for hinge in hinges], [hinge.axes[0] for hinge in hinges]
    corner, side = ("element", "end", "corner", "axis"), ("element", "side")
    return {
        "element_particle": (("element", "end"), whole(shapes.nodes), "1", "particles of the ends"),
        "element_length": ("element", shapes.length, "m", "unstrained length"),
        "section_size": (side, 2.0 * shapes.half, "m", "width and height of the section"),
        "section_corner": (corner, shapes.corners, "m", "corner of the section from the particle"),
        "point_particle": ("point", whole([p.particle for p in points]), "1", "point's particle"),
        "point_arm": (("point", "axis"), rows([p.arm for p in points], 3), "m", "arm of a point"),
        "hinge_particle": (("hinge", "end"), particles, "1", "particles of the hinge"),
        "hinge_arm": (("hinge", "axis"), rows(arms, 3), "m", "first particle to the hinge point"),
        "hinge_axis": (("hinge", "axis"), rows(axes, 3), "1", "axis in the first particle's frame"),
    }


def strands_of(scene) -> list[Cable | Strut]:
    """Return what is drawn as lines through points of a scene: its cables, then its struts."""
    return [*scene.cables, *Strut.find(scene)]


def _cables(motion: RecordedMotion, cables: list[Cable | Strut]) -> dict[str, tuple]:
    """Tensions (of struts the size of the force), and the points of all, one after the other."""
    beams = [beam for cable in cables for beam in cable.beams]
    owner = np.repeat(np.arange(len(cables)), [len(cable.beams) for cable in cables])
    ids = np.array([beam.particle for beam in beams])
    arms = np.array([beam.arm for beam in beams])
    records = motion.outcome.records
    columns = [records[k].values for k in ("cable_tension", "strut_force") if k in records]
    tension = np.abs(np.concatenate(columns, axis=1))[motion.rows]
    return {
        "cable_tension": (("time", "cable"), tension, "N", "tension of cables, force of struts"),
        "cable_point_cable": ("cable_point", owner.astype(np.int32), "1", "cable of the point"),
        "cable_point_particle": ("cable_point", ids.astype(np.int32), "1", "particle of the point"),
        "cable_point_arm": (("cable_point", "axis"), arms, "m", "particle to point, in its frame"),
    }


def _events(outcome: Outcome) -> dict[str, tuple]:
    time, contact, closing = outcome.impacts({"closes": "opens"}).events.T
    return {
        "contact_event_time": ("event", time, "s", "time at which a contact closes or opens"),
        "contact_event_contact": ("event", contact.astype(np.int32), "1", "index of the contact"),
        "contact_event_closing": ("event", closing.astype(np.int8), "1", "1: closes, 0: opens"),
    }


MAX_RECORDS = 1e8  # numbers of one pass; larger scenes are run in several passes

_ARMS = {"place": (0.0, 0.0, 0.0), "second axis": (0.0, 1.0, 0.0), "third axis": (0.0, 0.0, 1.0)}
_STEEPEST_MITRE = 0.3  # least cosine between a bar and the normal of the face that cuts it


def whole_motion(
    scenes: Sequence[Scene],
    *,
    duration: float,
    instants: int,
    step: float,
    frames: int = 401,
    times: Sequence[float] = (),
    energy_tolerance: float = 0.02,
    record: Iterable[Column] = (),
    halvings: int = 0,
    attributes: Sequence[dict] | None = None,
    extra_variables: Callable[[int, Outcome], Mapping] = lambda number, outcome: {},
) -> list:
    """Simulate scenes that differ in numbers only and return the whole motion of each as an
    xarray.Dataset: of all particles positions (m), own axes (columns) and velocities (m/s), of all
    elements strains and stresses (Pa). Raises the InstabilityError of the first run that fails,
    SceneError for wrong arguments.

    Parameters
    ----------
    scenes: scenes that differ in numbers only.
    duration, instants, step: of the run (s), number of recorded instants, time step (s).
    frames: number of recorded instants that are returned, evenly spread.
    times: further times (s), of which the nearest instants are returned as well.
    energy_tolerance: energy error at which a run fails, as a fraction of its largest energy so far.
    record: columns (variable, label) to record, as `simulate` takes them, for the Outcome that
        extra_variables takes; the datasets do not have them.
    halvings: how often a run that fails is repeated with half the step, as `simulate` takes it.
    attributes: further global attributes by name, one mapping for each scene's dataset, or None.
    extra_variables: called with the number of a scene (from 0) and its Outcome, returns further
        variables for its dataset, by name, as xarray.Dataset.assign takes them."""
    arguments: dict[str, Any] = {"duration": duration, "instants": instants, "step": step}
    arguments |= {"energy_tolerance": energy_tolerance, "record": tuple(record)}
    arguments["halvings"] = halvings
    count = len(scenes[0].position)
    points = len(_ARMS) * 6 * instants * 8  # numbers of one particle, with 8 runs side by side
    passes = max(1, round(np.ceil(count * points / MAX_RECORDS)))
    runs: list[list[tuple]] = [[] for _ in scenes]
    spread = np.linspace(0, instants - 1, min(frames, instants)).round().astype(int)
    nearest = np.round(np.asarray(times, float) / duration * (instants - 1)).astype(int)
    rows = np.unique(np.concatenate([spread, nearest.clip(0, instants - 1)]))
    for particles in np.array_split(np.arange(count), min(passes, count)):
        outcomes = simulate([_with_points(s, particles) for s in scenes], **arguments)
        for parts, outcome in zip(runs, outcomes, strict=True):
            if outcome.failure is not None:
                raise outcome.failure
            parts.append((_tracks(outcome, particles), outcome))
    datasets = []
    for i, (scene, parts) in enumerate(zip(scenes, runs, strict=True)):
        position, velocity, frame = (
            np.concatenate([tracks[k] for tracks, _ in parts], axis=1) for k in range(3)
        )
        strains = element_strains(scene, position[rows], frame[rows])
        motion = RecordedMotion(scene, parts[0][1], rows, position, velocity[rows], frame, *strains)
        extra = attributes[i] if attributes else {}
        data = to_dataset(motion, section_corners(scene), extra)
        datasets.append(data.assign(extra_variables(i, motion.outcome)))
    return datasets


def element_strains(
    scene: Scene, position: np.ndarray, frame: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the axial strains (t, m), > 0 in tension, and the largest bending strains (t, m), >=
    0, of m beam elements. position (t, n, 3) m, frame (t, n, 3, 3): of the particles. The moments
    at the ends are the gradient of the energy, 2 EI/l0 (2 th_a + th_b) and its mirror image; the
    larger is taken, at the corner of the rectangle of `elements_of`."""
    if not scene.beams:
        return np.zeros((len(position), 0)), np.zeros((len(position), 0))
    bars = elastic_of(scene)
    ends = (ParticlePoses(position[:, nodes], frame[:, nodes]) for nodes in bars.nodes.T)
    shape, rest = bars.shape(*ends), bars.stiffness[:, 0]
    angles = shape.turns.reshape(*shape.length.shape, 2, 2)  # of both ends, in both planes
    curvature = 2.0 * (2.0 * angles + angles[..., ::-1, :]) / rest[:, None, None]
    bending = (np.abs(curvature) * bars.half[:, None]).sum(axis=-1).max(axis=-1)
    return shape.length / rest - 1.0, bending


def section_corners(scene: Scene) -> np.ndarray:
    """Return the corners (m, 2, 4, 3), m, of the sections at both ends of m beam elements, from the
    particle in its axes: of the rectangle of `elements_of`, where a hinge has a contact cut along
    its face, as mitred bars are."""
    if not scene.beams:
        return np.zeros((0, 2, 4, 3))
    nodes, _, half = elements_of(scene.beams)
    triads = np.concatenate([beams.triad for beams in scene.beams])
    start = scene.frame if scene.unstrained is None else scene.unstrained
    faces = _contact_faces(scene)
    result = np.zeros((len(nodes), 2, 4, 3))
    for e, ends in enumerate(nodes):
        for k, particle in enumerate(ends):
            axes = start[particle].T @ triads[e]
            corners = (2.0 * half[e] * BOX_CORNERS) @ axes[:, 1:].T
            for point, normal in faces.get(int(particle), ()):
                slope = normal @ axes[:, 0]
                if abs(slope) > _STEEPEST_MITRE:
                    shift = (point - corners) @ normal / slope
                    corners = corners + shift[:, None] * axes[:, 0]
            result[e, k] = corners
    return result


def _contact_faces(scene: Scene) -> dict[int, list[tuple[np.ndarray, np.ndarray]]]:
    """Return by particle point and normal of each contact's face, in its frame."""
    faces: dict[int, list] = {}
    for contact in scene.contacts:
        hinge = scene.hinges[contact.hinge]
        for beam, axis, reference in zip(hinge.beams, hinge.axes, hinge.references, strict=True):
            faces.setdefault(beam.particle, []).append((beam.arm, np.cross(axis, reference)))
    return faces


def _with_points(scene: Scene, particles: np.ndarray) -> Scene:
    """Return the scene with named points at particles and at arms along their axes."""
    result = copy(scene)
    points = {
        f"{name} of particle {p}": VirtualBeam(int(p), np.array(arm))
        for p in particles
        for name, arm in _ARMS.items()
    }
    if clash := set(points) & set(scene.points):
        raise SceneError("point", sorted(clash)[0], "a name that is not one of a particle's axes")
    result.points = {**scene.points, **points}
    return result


def _tracks(outcome: Outcome, particles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions and velocities (t, n, 3) and frames (t, n, 3, 3) of particles."""
    names = {arm: [f"{arm} of particle {p}" for p in particles] for arm in _ARMS}
    tracks = {arm: [outcome.points[name] for name in names[arm]] for arm in _ARMS}
    place, second, third = (np.stack([x for x, _ in t], axis=1) for t in tracks.values())
    second -= place
    third -= place
    velocity = np.stack([velocity for _, velocity in tracks["place"]], axis=1)
    return place, velocity, np.stack([np.cross(second, third), second, third], axis=-1)
