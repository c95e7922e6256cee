"""The whole motion of a run: every particle with its frame, every element's strain and stress.

A trajectory holds a few named points. Here the run is made again with a named point at every
particle and at two arms of one metre along its axes; points do not influence the motion, so that it
is the trajectory's bit for bit. Strains follow outside the time loop."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from typing import Any

import numpy as np

from fpm.elements.bars.beam import elements_of
from fpm.elements.bars.virtual_beam import VirtualBeam
from fpm.errors import SceneError
from fpm.files.outcome import Outcome
from fpm.files.trajectory import Column
from fpm.motions.motion_dataset import BOX_CORNERS, RecordedMotion, to_dataset
from fpm.reading.bars import bends_of
from fpm.scenes.scene import Scene
from fpm.solver.simulate import simulate

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
    rows = choose_instants(duration, instants, frames, times)
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


def choose_instants(duration: float, instants: int, frames: int, times=()) -> np.ndarray:
    """Return the indices (k,), increasing, of the recorded instants that `whole_motion` returns:
    `frames` evenly spread ones, and those nearest to `times` (s). duration: of the run (s);
    instants: number of recorded ones, evenly spread from 0 to `duration`."""
    spread = np.linspace(0, instants - 1, min(frames, instants)).round().astype(int)
    nearest = np.round(np.asarray(times, float) / duration * (instants - 1)).astype(int)
    return np.unique(np.concatenate([spread, nearest.clip(0, instants - 1)]))


def element_strains(
    scene: Scene, position: np.ndarray, frame: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return two strains of a scene's m beam elements at t instants: axial (t, m), > 0 in tension,
    and the largest by bending at the surface (t, m), >= 0. position (t, n, 3) m and frame (t, n, 3,
    3), axes as columns: of its n particles. The moments at an element's ends are the gradient of
    its energy (elements/bars/beam.py), 2 EI/l0 (2 th_a + th_b) and its mirror image; the larger is
    taken, at the corner of the rectangle with the section's radii of gyration (`elements_of`)."""
    if not scene.beams:
        return np.zeros((len(position), 0)), np.zeros((len(position), 0))
    _, length, half = elements_of(scene.beams)
    bends = [
        bends_of(scene, beams, lambda p: position[:, p], lambda p: frame[:, p])
        for beams in scene.beams
    ]
    lengths = np.concatenate([bend.length for bend in bends], axis=1)
    angles = np.concatenate([np.stack(bend.angles) for bend in bends], axis=2)
    curvature = 2.0 * (2.0 * angles + angles[::-1]) / length[:, None]  # both ends, both planes
    bending = np.einsum("etmk,mk->etm", np.abs(curvature), half).max(axis=0)
    return lengths / length - 1.0, bending


def section_corners(scene: Scene) -> np.ndarray:
    """Return the corners (m, 2, 4, 3), m, of the sections at both ends of a scene's m beam
    elements, from the end's particle in its own axes, to draw them: of the rectangle with the
    section's radii of gyration (`elements_of`). Ends of bars whose hinge has a contact are cut
    along the contact's face, as mitred bars are."""
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
    """Return by particle the point and the normal of each contact's face, in the particle's
    frame."""
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
