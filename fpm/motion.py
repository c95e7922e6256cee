"""The whole motion of a run: every particle with its frame, every element's strain and stress.

A trajectory holds a few named points. Here the run is made again with a named point at every
particle and at two arms of one metre along its axes; points do not influence the motion, so that it
is the trajectory's bit for bit. Strains follow outside the time loop.
"""

from collections.abc import Sequence
from copy import copy

import numpy as np

from fpm.elements.virtual_beam import VirtualBeam
from fpm.errors import SceneError
from fpm.scene import Scene
from fpm.simulate import Outcome, simulate

MOST_RECORDED = 1e8  # numbers of one pass; larger scenes are run in several passes

_ARMS = {"place": (0.0, 0.0, 0.0), "second axis": (0.0, 1.0, 0.0), "third axis": (0.0, 0.0, 1.0)}
_CORNERS = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])  # of a section, along y and z
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
    attributes: Sequence[dict] | None = None,
) -> list:
    """The whole motion of scenes of one topology, an xarray.Dataset each.

    duration (s), instants, step (s), energy_tolerance as in `simulate`: those of the trajectory
    that is to be had again. Kept are `frames` of its instants, evenly spread, and those nearest to
    `times` (s). attributes: further global ones of each. Raises the failure of a run that fails.
    """
    arguments = {"duration": duration, "instants": instants, "step": step}
    arguments["energy_tolerance"] = energy_tolerance
    count = len(scenes[0].position)
    points = len(_ARMS) * 6 * instants * 8  # numbers of one particle, with 8 runs side by side
    passes = max(1, round(np.ceil(count * points / MOST_RECORDED)))
    recorded: list[list[tuple]] = [[] for _ in scenes]
    for particles in np.array_split(np.arange(count), min(passes, count)):
        outcomes = simulate([_with_points(s, particles) for s in scenes], **arguments)
        for parts, outcome in zip(recorded, outcomes, strict=True):
            if outcome.failure is not None:
                raise outcome.failure
            parts.append((_tracks(outcome, particles), outcome))
    kept = kept_instants(duration, instants, frames, times)
    datasets = []
    for i, (scene, parts) in enumerate(zip(scenes, recorded, strict=True)):
        position, velocity, frame = (
            np.concatenate([tracks[k] for tracks, _ in parts], axis=1) for k in range(3)
        )
        extra = attributes[i] if attributes else {}
        outcome = parts[0][1]
        datasets.append(_dataset(scene, outcome, position, velocity, frame, kept, extra))
    return datasets


def kept_instants(duration: float, instants: int, frames: int, times=()) -> np.ndarray:
    """Indices of `frames` of `instants` evenly spaced instants, and of those nearest to times."""
    even = np.linspace(0, instants - 1, min(frames, instants)).round().astype(int)
    nearest = np.round(np.asarray(times, float) / duration * (instants - 1)).astype(int)
    return np.unique(np.concatenate([even, nearest.clip(0, instants - 1)]))


def element_strains(
    scene: Scene, position: np.ndarray, frame: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Axial strain (t, m) and the largest bending strain at the surface (t, m) of all elements.

    position (t, n, 3) m and frame (t, n, 3, 3) of the particles. The moments at an element's ends
    are the gradient of its energy (elements/beam.py), 2 EI/l0 (2 th_a + th_b) and its mirror image;
    the larger end counts, at the corner of a rectangle with the section's area and second moments.
    """
    if not scene.beams:
        return np.zeros((len(position), 0)), np.zeros((len(position), 0))
    nodes, length, half = _elements(scene)
    chord = position[:, nodes[:, 1]] - position[:, nodes[:, 0]]
    stretched = np.linalg.norm(chord, axis=2)
    chord /= stretched[:, :, None]
    start = scene.frame if scene.unstrained is None else scene.unstrained
    triads = np.concatenate([beams.triad for beams in scene.beams])
    curvature = np.zeros((2, *stretched.shape, 2))  # at both ends, in both planes
    turns = []
    for end in (0, 1):
        local = np.einsum("mji,mjk->mik", start[nodes[:, end]], triads[:, :, 1:])
        # The sine between the chord and the axis is the chord's component in the end's own frame.
        seen = np.einsum("tmji,tmj->tmi", frame[:, nodes[:, end]], chord)
        sine = np.einsum("tmi,mik->tmk", seen, local)
        turns.append(sine * (1.0 + sine**2 / 6.0))
    for end in (0, 1):
        curvature[end] = 2.0 * (2.0 * turns[end] + turns[1 - end]) / length[:, None]
    bending = np.einsum("etmk,mk->etm", np.abs(curvature), half).max(axis=0)
    return stretched / length - 1.0, bending


def section_corners(scene: Scene) -> np.ndarray:
    """Corners (m, 2, 4, 3) of each element's section at both ends, in the frames of its particles.

    Metres. The section is drawn as the rectangle with its area and second moments. Ends of bars
    whose hinge has a contact are cut along the contact's face, as mitred bars are.
    """
    if not scene.beams:
        return np.zeros((0, 2, 4, 3))
    nodes, _, half = _elements(scene)
    triads = np.concatenate([beams.triad for beams in scene.beams])
    faces = _contact_faces(scene)
    out = np.zeros((len(nodes), 2, 4, 3))
    for e, ends in enumerate(nodes):
        for k, particle in enumerate(ends):
            axes = scene.frame[particle].T @ triads[e]
            corners = (2.0 * half[e] * _CORNERS) @ axes[:, 1:].T
            for point, normal in faces.get(int(particle), ()):
                slope = normal @ axes[:, 0]
                if abs(slope) > _STEEPEST_MITRE:
                    shift = (point - corners) @ normal / slope
                    corners = corners + shift[:, None] * axes[:, 0]
            out[e, k] = corners
    return out


def _elements(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All elements' nodes (m, 2), lengths (m,) m, and half widths and heights (m, 2) m."""
    half = [
        np.tile(np.sqrt(3.0 * np.array([b.section.Iz, b.section.Iy]) / b.section.A), (m, 1))
        for b in scene.beams
        if (m := len(b.length))
    ]
    return (
        np.concatenate([b.nodes for b in scene.beams]),
        np.concatenate([b.length for b in scene.beams]),
        np.concatenate(half),
    )


def _contact_faces(scene: Scene) -> dict[int, list[tuple[np.ndarray, np.ndarray]]]:
    """By particle: a point and the normal of each contact's face, in the particle's frame."""
    faces: dict[int, list] = {}
    for contact in scene.contacts:
        hinge = scene.hinges[contact.hinge]
        for beam, axis, reference in zip(hinge.beams, hinge.axes, hinge.references, strict=True):
            faces.setdefault(beam.particle, []).append((beam.arm, np.cross(axis, reference)))
    return faces


def _with_points(scene: Scene, particles: np.ndarray) -> Scene:
    """The scene with named points at particles and at arms along their axes."""
    out = copy(scene)
    named = {
        f"{name} of particle {p}": VirtualBeam(int(p), np.array(arm))
        for p in particles
        for name, arm in _ARMS.items()
    }
    if taken := set(named) & set(scene.points):
        raise SceneError("point", sorted(taken)[0], "a name that is not one of a particle's axes")
    out.points = {**scene.points, **named}
    return out


def _tracks(outcome: Outcome, particles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions and velocities (t, n, 3) and frames (t, n, 3, 3) of particles."""
    place, second, third = (
        np.stack([outcome.points[f"{name} of particle {p}"] for p in particles], axis=2)
        for name in _ARMS
    )
    axes = [second[0] - place[0], third[0] - place[0]]
    return place[0], place[1], np.stack([np.cross(*axes), *axes], axis=-1)


def _dataset(scene, outcome, position, velocity, frame, kept, attributes):
    """The motion at the instants `kept` as an xarray.Dataset with CF-like names and units."""
    import xarray

    import fpm

    axial, bending = element_strains(scene, position, frame)
    modulus = np.concatenate([np.full(len(b.length), b.material.E) for b in scene.beams] or [[]])
    stress = modulus * (np.abs(axial) + bending)
    worst = stress.argmax(axis=0)
    nodes, length, half = _elements(scene) if scene.beams else (np.zeros((0, 2), int), [], 0)
    vector, end = ("time", "particle", "axis"), ("element", "end")
    points, hinges = list(scene.points.values()), scene.hinges
    named = [outcome.points[name][0][kept] for name in scene.points]

    def rows(values, *shape) -> np.ndarray:
        return np.array(values, float).reshape(-1, *shape)

    variables = {
        "position": (vector, position[kept], "m", "position of the particles"),
        "velocity": (vector, velocity[kept], "m s-1", "velocity of the particles"),
        "frame": ((*vector, "director"), frame[kept], "1", "particle's own axes, as columns"),
        "axial_strain": (("time", "element"), axial[kept], "1", "stretch over unstrained length"),
        "bending_strain": (("time", "element"), bending[kept], "1", "largest at the surface"),
        "stress": (("time", "element"), stress[kept], "Pa", "largest normal stress of the element"),
        "largest_stress": ("element", stress.max(axis=0), "Pa", "over all instants of the run"),
        "largest_stress_time": ("element", outcome.time[worst], "s", "when it is largest"),
        "element_particle": (end, nodes.astype(np.int32), "1", "particles at its ends"),
        "element_length": ("element", rows(length), "m", "unstrained length"),
        "section_size": (("element", "side"), rows(2.0 * half, 2), "m", "width and height"),
        "section_corner": (
            (*end, "corner", "axis"), section_corners(scene), "m", "in the particle's frame",
        ),
        "point_particle": ("point", rows([p.particle for p in points]).astype(np.int32), "1", ""),
        "point_arm": (("point", "axis"), rows([p.arm for p in points], 3), "m", "in its frame"),
        "point_position": (
            ("time", "point", "axis"),
            np.stack(named, axis=1) if named else np.zeros((len(kept), 0, 3)),
            "m", "position of the named points",
        ),
        "hinge_particle": (
            ("hinge", "end"), rows([h.particles for h in hinges], 2).astype(np.int32), "1", "",
        ),
        "hinge_arm": (("hinge", "axis"), rows([h.beams[0].arm for h in hinges], 3), "m", ""),
        "hinge_axis": (("hinge", "axis"), rows([h.axes[0] for h in hinges], 3), "1", ""),
        "contact_event_time": ("event", outcome.events[:, 0], "s", "when a contact shuts or opens"),
        "contact_event_contact": ("event", outcome.events[:, 1].astype(np.int32), "1", "index"),
        "contact_event_closing": ("event", outcome.events[:, 2].astype(np.int8), "1", "1: shuts"),
    }  # fmt: skip
    time = {"units": "s", "long_name": "time", "standard_name": "time", "axis": "T"}
    contacts = [scene.hinges[c.hinge].name for c in scene.contacts]
    names = {
        "element": [f"{b.name}[{i}]" for b in scene.beams for i in range(len(b.length))],
        "point": list(scene.points),
        "hinge": [h.name for h in hinges],
        "contact": contacts,
    }
    return xarray.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": text or name.replace("_", " of ")})
            for name, (dims, values, unit, text) in variables.items()
        },
        coords={
            "time": ("time", outcome.time[kept], time),
            "axis": ("axis", list("xyz"), {"long_name": "axis, global or of the particle"}),
            **{n: (n, np.array(v, dtype=str), {"long_name": n}) for n, v in names.items()},
        },
        attrs={
            "Conventions": "CF-1.11",
            "title": f"whole motion of scene {scene.name}",
            "source": f"finite particle method, data version {fpm.DATA_VERSION}",
            "scene": scene.name,
            "time_step": outcome.step,
            **attributes,
        },
    )
