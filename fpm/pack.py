"""Scenes to kernel arrays: numbers of several scenes side by side in lanes.

All scenes of a batch must share their topology (particles, connections, held axes, curves, whether
beams lie along their particles' axes); only numbers may differ. The last scene fills the lanes that
are left over; their results are dropped.
"""

import math
from collections.abc import Sequence

import numpy as np

from fpm.errors import SceneError
from fpm.kernels import layout as at
from fpm.kernels.model import Model, Record
from fpm.scene import AXES, Scene

MOST_EVENTS = 512
"""Contact events kept per sample; more are counted but not kept."""


REST_STRAIN = 1e-10
"""Rounding strains a scene at rest by less; the energy of so much is the least energy scale."""


ALIGNED = np.array([0.0, 1, 0, 0, 0, 1] * 2)
"""Row of `_end_axes` of an element whose axes are those of its particles."""


def framed(scene: Scene) -> bool:
    """Whether some element's axes are not those of its particles (to rounding).

    The kernels take another path then. It must follow from the scene alone: a choice for a whole
    batch would let a sample's last digits depend on its neighbours.
    """
    axes = _end_axes(scene) if scene.beams else ALIGNED
    return bool(np.abs(axes - ALIGNED).max() >= 1e-12)


def topology(scene: Scene) -> tuple:
    """What must be equal in all scenes of a batch, as a hashable tuple."""
    curves = tuple((tuple(t), tuple(v)) for t, v in scene.curves)
    return (
        len(scene.position),
        tuple(tuple(b.nodes.ravel()) for b in scene.beams),
        tuple((h.name, h.particles, h.support) for h in scene.hinges),
        tuple(s.hinge for s in scene.springs),
        tuple(c.hinge for c in scene.contacts),
        tuple((load.beam.particle, load.curve) for load in scene.loads),
        tuple((d.particle, d.curve) for d in scene.drives),
        tuple((name, p.particle) for name, p in scene.points.items()),
        scene.fixed.tobytes(),
        curves,
        framed(scene),
    )


def check_topology(scenes: Sequence[Scene]) -> None:
    """SceneError unless all scenes can run side by side."""
    first = topology(scenes[0])
    for i, scene in enumerate(scenes[1:], start=1):
        if topology(scene) != first:
            raise SceneError(
                f"topology of scene {i}", scene.name, "the same particles, connections and "
                "supports as scene 0, and beams along their particles' axes where its are; "
                "scenes of a batch may differ in numbers only"
            )  # fmt: skip


def blank(*shape_and_dtype) -> np.ndarray:
    """Zeros of shape (..., width) and the given dtype (last argument), aligned to 64 bytes.

    A register of lanes that straddles two cache lines costs twice.
    """
    *shape, dtype = shape_and_dtype
    size = math.prod(shape) * np.dtype(dtype).itemsize
    buffer = np.zeros(size + 64, np.uint8)
    offset = -buffer.ctypes.data % 64
    return buffer[offset : offset + size].view(dtype).reshape(shape)


def _stack(scenes, rows, columns, function, width, dtype):
    """Array (rows, columns, width) from function(scene) -> (rows, columns), scene by scene."""
    out = blank(rows, columns, width, dtype)
    if rows:
        for s in range(width):
            if s < len(scenes):
                out[:, :, s] = function(scenes[s])
            else:
                out[:, :, s] = out[:, :, len(scenes) - 1]
    return out


def state_of(scene: Scene) -> np.ndarray:
    """State (n, STATE) of one scene at its start."""
    out = np.zeros((len(scene.position), at.STATE))
    out[:, at.X : at.X + 3] = scene.position
    out[:, at.D2 : at.D2 + 3] = scene.frame[:, :, 1]
    out[:, at.D3 : at.D3 + 3] = scene.frame[:, :, 2]
    free = ~scene.fixed
    out[:, at.V : at.V + 3] = scene.velocity * free[:, :3]
    local = np.einsum("nji,nj->ni", scene.frame, scene.spin * free[:, 3:])
    out[:, at.P : at.P + 3] = np.einsum("nij,nj->ni", scene.frame, scene.inertia * local)
    return out


def _particles(scene: Scene) -> np.ndarray:
    out = np.zeros((len(scene.position), at.PARTICLE))
    out[:, at.MASS] = scene.mass
    out[:, at.IM] = np.where(scene.fixed[:, :3].all(axis=1), 0.0, 1.0 / scene.mass)
    held = scene.fixed[:, 3:].all(axis=1)[:, None]
    out[:, at.IJ : at.IJ + 3] = np.where(held, 0.0, 1.0 / scene.inertia)
    return out


def _end_axes(scene: Scene) -> np.ndarray:
    """Axes 2 and 3 of every element in the frames of its ends (m, 12)."""
    frame = scene.frame if scene.unstrained is None else scene.unstrained
    rows = []
    for beams in scene.beams:
        for end in (0, 1):
            local = np.einsum("mji,mjk->mik", frame[beams.nodes[:, end]], beams.triad[:, :, 1:])
            rows.append(local.transpose(0, 2, 1).reshape(-1, 6))
    pairs = [np.hstack(rows[i : i + 2]) for i in range(0, len(rows), 2)]
    return np.concatenate(pairs)


def _bodies(scene: Scene) -> np.ndarray:
    out = np.zeros((2 * len(scene.hinges), at.BODY))
    for h, hinge in enumerate(scene.hinges):
        for k, beam in enumerate(hinge.beams):
            row, p = out[2 * h + k], beam.particle
            free = ~scene.fixed[p]
            row[at.ARM : at.ARM + 3] = beam.arm
            row[at.AXIS : at.AXIS + 3] = hinge.axes[k]
            row[at.REF : at.REF + 3] = hinge.references[k]
            row[at.HIM : at.HIM + 3] = free[:3] / scene.mass[p]
            row[at.HIJ : at.HIJ + 3] = free[3:].all() / scene.inertia[p]  # all or none
    return out


def _hinges(scene: Scene) -> np.ndarray:
    out = np.zeros((len(scene.hinges), at.HINGE))
    for row, hinge in zip(out, scene.hinges, strict=True):
        row[at.HELD : at.HELD + 3] = [axis in hinge.support for axis in AXES]
        first = hinge.beams[0]
        place = scene.position[first.particle] + scene.frame[first.particle] @ first.arm
        row[at.PLACE : at.PLACE + 3] = place
    return out


def _loads(scene: Scene) -> np.ndarray:
    return np.array([[*load.force, *load.moment, *load.beam.arm] for load in scene.loads])


def _integers(values, columns=None) -> np.ndarray:
    shape = (-1,) if columns is None else (-1, columns)
    return np.array(list(values), np.int64).reshape(shape)


def pack(scenes: Sequence[Scene], width: int, dtype=np.float64) -> tuple[np.ndarray, Model]:
    """State (n, STATE, width) and Model of up to `width` scenes of one topology."""
    one = scenes[0]
    n, m, h = len(one.position), sum(len(b.length) for b in one.beams), len(one.hinges)

    def stack(rows, columns, function):
        return _stack(scenes, rows, columns, function, width, dtype)

    heavy = any(np.any(s.gravity != 0) for s in scenes)
    damped = any(s.damping > 0 for s in scenes)
    partly = [
        p for p in range(n)
        if 0 < one.fixed[p, :3].sum() < 3 or 0 < one.fixed[p, 3:].sum() < 3
    ]  # fmt: skip
    curve_points = [len(t) for t, _ in one.curves]
    springs, contacts = one.springs, one.contacts
    moved = {p for hinge in one.hinges for p in hinge.particles}
    moved |= {d.particle for d in one.drives}
    model = Model(
        particles=stack(n, at.PARTICLE, _particles),
        free=_integers(p for p in range(n) if p not in moved),
        nodes=_integers(np.concatenate([b.nodes for b in one.beams]) if m else [], 2),
        beams=stack(m, at.BEAM, lambda s: np.concatenate([b.stiffness() for b in s.beams])),
        axes=stack(m if framed(one) else 0, at.AXES, _end_axes),
        gravity=stack(int(heavy), 3, lambda s: s.gravity[None]),
        damping=stack(int(damped), 1, lambda s: [[s.damping]]),
        chord=blank(m, at.CHORD, width, dtype),
        ends=_integers(p for hinge in one.hinges for p in hinge.particles),
        bodies=stack(2 * h, at.BODY, _bodies),
        hinges=stack(h, at.HINGE, _hinges),
        held=_integers(([axis in hinge.support for axis in AXES] for hinge in one.hinges), 3),
        body_scratch=blank(2 * h, at.BODY_SCRATCH, width, dtype),
        hinge_scratch=blank(h, at.HINGE_SCRATCH, width, dtype),
        open_hinge=np.zeros(h, bool),
        openings=stack(h, 2, lambda s: [[hinge.opening] * 2 for hinge in s.hinges]),
        spring_on=_integers(s.hinge for s in springs),
        springs=stack(len(springs), 2, lambda s: [[x.stiffness, x.rest] for x in s.springs]),
        contact_on=_integers(c.hinge for c in contacts),
        contacts=stack(len(contacts), 1, lambda s: [[x.stiffness] for x in s.contacts]),
        load_on=_integers(x.beam.particle for x in one.loads),
        load_curve=_integers(x.curve for x in one.loads),
        loads=stack(len(one.loads), 9, _loads),
        drive_on=_integers(d.particle for d in one.drives),
        drive_curve=_integers(d.curve for d in one.drives),
        drives=stack(len(one.drives), 6, lambda s: [[*d.velocity, *d.spin] for d in s.drives]),
        hold_on=_integers(partly),
        hold_free=stack(len(partly), 6, lambda s: ~s.fixed[partly]),
        curve_start=np.concatenate([[0], np.cumsum(curve_points)]).astype(np.int64),
        curve_time=np.concatenate([t for t, _ in one.curves] or [np.zeros(0)]),
        curve_value=np.concatenate([v for _, v in one.curves] or [np.zeros(0)]),
        point_on=_integers(p.particle for p in one.points.values()),
        point_arm=stack(len(one.points), 3, lambda s: np.array([p.arm for p in s.points.values()])),
        work=blank(2, 2, width, dtype),
        element_energy=blank(len(one.elements), 1, width, dtype),
    )
    return stack(n, at.STATE, state_of), model


def blank_record(model: Model, instants: int, samples: int) -> Record:
    """An empty Record for a model; `samples` is the number of lanes that hold a sample."""
    width, dtype = model.particles.shape[2], model.particles.dtype
    failed = np.full(width, -1, np.int64)
    failed[samples:] = 0  # the lanes that only fill up are never looked at
    return Record(
        points=blank(instants + 1, 6 * len(model.point_on), width, dtype),
        hinges=blank(instants + 1, len(model.hinges) + 2, width, dtype),
        energies=blank(instants + 1, len(at.ENERGIES), width, dtype),
        events=np.full((MOST_EVENTS, 3, width), np.nan, dtype),
        event_count=np.zeros(width, np.int64),
        failed_step=failed,
        failed_element=np.zeros(width, np.int64),
        failed_balance=np.zeros(width, dtype),
        failed_cause=np.zeros(width, np.int64),
        largest=blank(1, 4, width, dtype),
        failed_largest=np.zeros((4, width), dtype),
        scale=REST_STRAIN**2 * np.sum(model.beams[:, at.AXIAL] * model.beams[:, at.LENGTH] ** 2, 0),
    )
