"""Scenes that can run side by side, as one batch: those that differ in numbers only; and lanes of a
run back to each sample's outcome."""

from collections.abc import Callable, Sequence

import numpy as np

from fpm.elements import energies_of, kinds_of
from fpm.elements.batch import Batch, join_particles, turns_of
from fpm.elements.cross import columns, cross
from fpm.elements.kind import Series
from fpm.elements.openings.opening import moving_at_start
from fpm.elements.particles.drive import Drive
from fpm.elements.reads import SceneList
from fpm.errors import InstabilityError, SceneError
from fpm.files.outcome import BALANCE, KINETIC, Motion, Outcome, columns_of, eventful
from fpm.files.trajectory import Energies
from fpm.kernels import layout
from fpm.reading import variables
from fpm.reading.recording import Recording
from fpm.scenes.scene import Scene
from fpm.scenes.timestep import StableStep, find_stable_step

MOST_EVENTS = 512
"""Number of events of a sample for which there is room; with more, the run is repeated."""

MOST_ROOM = 1 << 16
"""Number of events of a sample that are kept, at most; more are only counted."""


def topology(scene: Scene) -> tuple:
    """Return what must be equal in all scenes of a batch, as a hashable tuple: particles, what
    element types ask for, points, held axes, the number of curves."""
    of_kinds = {kind: kind.topology_of(scene) for kind in kinds_of([scene])}
    return (
        *_layout(scene),
        tuple((kind, value) for kind, value in of_kinds.items() if value is not None),
    )


def _layout(scene: Scene) -> tuple:
    """Return what else must be equal in scenes that run side by side."""
    return (
        len(scene.position),
        tuple((name, p.particle) for name, p in scene.points.items()),
        scene.fixed.tobytes(),
        len(scene.curves),
    )


def curve_bytes(scene: Scene) -> tuple:
    """Return the content of a scene's curves of time, as a hashable tuple: scenes of a batch whose
    curves differ run one after the other, as curves are one for all lanes."""
    return tuple((c.times.tobytes(), c.values.tobytes(), c.powers.tobytes()) for c in scene.curves)


def check_topology(scenes: Sequence[Scene]) -> None:
    """Check that scenes can run side by side (differ in numbers only); raises SceneError if not."""
    scenes = SceneList(scenes)
    functions: list[Callable] = [_layout]
    for kind in kinds_of(scenes):
        functions.append(lambda scene, k=kind: k.topology_of(scene) if k.find(scene) else None)
    mismatches = []
    for function in functions:
        first, *values = scenes.map(function)
        mismatches += [i for i, value in enumerate(values, start=1) if value != first]
    if mismatches:
        allowed = "the same particles, connections and supports as scene 0, and beams along "
        allowed += "their particles' axes where its are; scenes of a batch may differ in "
        key = f"topology of scene {min(mismatches)}"
        raise SceneError(key, scenes[min(mismatches)].name, f"{allowed}numbers only")


def pack(scenes: Sequence[Scene], instants: int, room: int = MOST_EVENTS) -> Batch:
    """Return a Batch of scenes that pass `check_topology`. instants: number of recorded ones; room:
    number of events of each scene that are kept."""
    return Batch(scenes, kinds_of(scenes), instants, room)


def outcomes_of(
    run, times: np.ndarray, division, limits: Sequence[StableStep | None], extra=()
) -> list[Outcome]:
    """Return the Outcomes of the samples of a run, in the order of lanes. run: (Batch, its parts,
    World, Record); times (t,) s; division: Division; limits: stable step of each, None: a step was
    given; extra: columns recorded on request."""
    batch, _, world, _ = run
    motions = _final(batch, world, division.output_steps * (len(times) - 1) * division.step)
    elements = batch.scenes.map(lambda scene: eventful(scene, batch.eventful.slices))
    of_lanes = zip(limits, motions, elements, strict=True)
    return [_outcome_of(run, lane, times, division, extra, *x) for lane, x in enumerate(of_lanes)]


def _outcome_of(run, lane: int, times, division, extra, limit, motion, elements) -> Outcome:
    batch, parts, world, record = run
    scene, instants = batch.scenes[lane], len(times)
    steps = division.output_steps * (instants - 1)
    tracks = record.points[:, :, lane].reshape(instants + 1, len(scene.points), 6)[:instants]
    points = {name: (tracks[:, n, :3], tracks[:, n, 3:]) for n, name in enumerate(scene.points)}
    # The mean of the half steps before and after the start is accurate to second order only.
    for name, beam in scene.points.items():
        if (p := beam.particle) not in Drive.moved_particles(scene):
            spin = cross(scene.spin[p] * ~scene.fixed[p, 3:], scene.frame[p] @ beam.arm)
            points[name][1][0] = scene.velocity[p] + spin
    kinds = (KINETIC, *energies_of(batch.kinds), BALANCE)
    records: dict[str, Series] = {}
    for kind, part in zip(batch.kinds, parts, strict=True):
        for name, series in kind.read_records(part, scene, lane).items():
            records[name] = series._replace(values=series.values[:instants])
    is_failed = record.failed_step[lane] >= 0
    failure: InstabilityError | SceneError | None = None
    if extra and not is_failed:
        recording = Recording(batch, parts, lane, times, division.step)
        try:
            records |= variables.read_records(recording, extra)
        except SceneError as error:  # this sample cannot do what is to be recorded of it
            failure = error
    watches = [watch for kind in batch.kinds for watch in kind.watches]
    values = record.failed_peaks[:, lane] if is_failed else world.peaks[0, :, lane]
    largest = {watch.name: float(x) for watch, x in zip(watches, values, strict=True)}
    if is_failed:
        limit = limit or find_stable_step(scene)
        failure = _failure(run, lane, largest, division.step, limit)
    event_count = int(batch.event_count[lane])
    return Outcome(
        scene=scene,
        time=times,
        points=points,
        energies=_energies(batch, record, lane, instants),
        energy_kinds=kinds,
        records=records,
        columns=columns_of(records),
        events=batch.events[: min(event_count, len(batch.events)), :, lane],
        eventful=elements,
        dropped_events=max(0, event_count - len(batch.events)),
        step=division.step,
        steps=steps,
        limit=limit,
        failure=failure,
        largest=largest,
        final=motion,
    )


def _energies(batch, record, lane: int, instants: int) -> Energies:
    """Energies (t,) J by name."""
    scene, table = batch.scenes[lane], record.energies[:instants, :, lane]
    energies = {energy.name: np.zeros(instants, table.dtype) for energy in energies_of(batch.kinds)}
    for k, energy in enumerate(batch.accounts):
        values = table[:, layout.ACCOUNTS + k]
        # The work of the weight starts at the height of the scene.
        energies[energy.name] = values - values[0] if k < batch.givers else values
    first = layout.ACCOUNTS + len(batch.accounts)
    for k, energy in enumerate(kind.stores for kind in batch.kinds if kind.stores):
        # Kinds may share a name, as cables and beams may store strain energy.
        energies[energy.name] = energies[energy.name] + table[:, first + k]
    kinetic, balance = table[:, layout.KINETIC].copy(), table[:, layout.BALANCE]
    motion = moving_at_start(scene)  # exactly: leapfrog's energy lacks that of half a kick
    spin = np.einsum("nji,nj->ni", scene.frame, motion.spin)
    kinetic[0] = 0.5 * float((scene.mass @ motion.velocity**2).sum())
    kinetic[0] += 0.5 * float((turns_of(scene).inertia * spin**2).sum())
    return Energies(kinetic=kinetic, **energies, balance=balance)


def _failure(run, lane, largest, step: float, limit: StableStep) -> InstabilityError:
    """The InstabilityError of a lane that failed: cause, element and remedy."""
    batch, _, _, record = run
    scene, balance = batch.scenes[lane], float(record.failed_balance[lane])
    names = [(name, kind) for kind in batch.rows.slices for name in kind.names(scene)]
    row, cause = record.failed_row[lane], record.failed_cause[lane]
    element, worst = names[row] if row >= 0 else ("none", None)
    turns = record.failed_turns[:, lane]
    if worst and worst.joins:
        joint = worst.find(scene)[row - batch.rows.slices[worst].start]
        turns = turns[list(joint.particles)]
    turn = float(turns.max())
    remedies = [w.remedy(element) for w in (worst.watches if worst else ()) if w.remedy]
    if step > limit.step and not np.isfinite(balance):
        element = limit.element  # all elements broke down since the last check; this began it
    watches = [watch for kind in batch.kinds for watch in kind.watches]
    watch = watches[cause] if cause >= 0 else None
    *final_words, is_sure = (
        watch.dead_end(scene, element, largest) if watch and watch.dead_end else (False,)
    )
    error = InstabilityError(
        time=record.failed_step[lane] * step,
        element=element,
        step=step,
        limit=limit.step,
        balance=balance,
        scale=float(record.failed_scale[lane]),
        cause=watch and watch.name,
        largest=largest,
        words=watch and watch.failure(largest | {"turn": turn, "step": step}),
        remedy="; ".join(remedies),
        final_words=final_words or None,
        turn=turn,
    )
    return error.as_final() if is_sure and error.time > 0 and step <= limit.step else error


def _final(batch, world, time: float) -> list[Motion]:
    """Motion of all particles of each sample at the last instant, `time` (s)."""
    scenes, whole = batch.scenes, join_particles(batch.scenes)
    state, start = (
        array[:, :, : len(scenes)].transpose(2, 0, 1).reshape(-1, layout.STATE)
        for array in (world.state, world.start_state)
    )
    second, third = start[:, layout.D2 : layout.D2 + 3], start[:, layout.D3 : layout.D3 + 3]
    frame = columns(cross(second, third), second, third)
    momentum = 0.5 * (start[:, layout.P : layout.P + 3] + state[:, layout.P : layout.P + 3])
    local = np.einsum("nji,nj->ni", frame, momentum) / turns_of(whole).inertia
    velocity = 0.5 * (start[:, layout.V : layout.V + 3] + state[:, layout.V : layout.V + 3])
    spin = np.einsum("nij,nj->ni", frame, local) * ~whole.fixed[:, 3:]
    fields = start[:, layout.X : layout.X + 3].copy(), frame, velocity, spin
    motions = list(map(Motion, *(np.split(field, len(scenes)) for field in fields)))
    for scene, motion in zip(scenes, motions, strict=True):
        Drive.prescribe(scene, time, motion)
    return motions
