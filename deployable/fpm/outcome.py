"""What a run gives back: the curves of one sample, its events, and why it failed if it did."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from deployable.fpm.asked import VARIABLES, Column
from deployable.fpm.cross import columns, cross
from deployable.fpm.errors import InstabilityError
from deployable.fpm.kinds import kinds_of
from deployable.fpm.kinds.kind import Energy, Eventful, Kind, Recorded
from deployable.fpm.scene import Scene
from deployable.fpm.timestep import StableStep, stable_step

if TYPE_CHECKING:
    import xarray

KINETIC = Energy("kinetic", "kinetic_energy", "kinetic energy")
BALANCE = Energy("balance", "energy_balance", "energy that came from nowhere since the start")


class Motion(NamedTuple):
    """Where all particles are and how they move, in the form in which a Scene keeps its start.

    position (n, 3) m; frame (n, 3, 3) axes as columns; velocity (n, 3) m/s; spin (n, 3) rad/s.
    """

    position: np.ndarray
    frame: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


def eventful(scene: Scene, kinds: Iterable[type[Kind]] | None = None) -> tuple[Eventful, ...]:
    """The elements of a scene that have events, or those of these kinds of it."""
    kinds = kinds_of([scene]) if kinds is None else kinds

    def joint(element: object) -> str:
        on = getattr(element, "hinge", None)
        return "" if on is None else scene.hinges[on].name

    return tuple(
        Eventful(name, kind.events, joint(element))
        for kind in kinds
        if kind.events
        for name, element in zip_longest(kind.names(scene), kind.of(scene))
        if name is not None  # a group of elements has more names than objects
    )


@dataclass(frozen=True)
class Outcome:
    """What one sample did.

    time (t,) s; points: name -> (position (t, 3) m, velocity (t, 3) m/s); energies: name -> (t,) J;
    recorded: what else was recorded, by the names of the variables in a trajectory file; events
    (e, 3): time (s), index into `eventful`, number of the event (a contact's: 1 if it closes);
    events_dropped: how many more there were; largest: of everything that is watched (`bend`, the
    largest sine of the angle between an element's chord and its ends, or of its twist; `strain` at
    the surface of an element; ...); final: the motion of all particles at the end; failure: None or
    the InstabilityError of this sample, whose curves and final motion mean nothing then.
    """

    scene: Scene
    time: np.ndarray
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    energies: dict[str, np.ndarray]
    energy_kinds: tuple[Energy, ...]
    recorded: dict[str, Recorded]
    events: np.ndarray
    eventful: tuple[Eventful, ...]
    events_dropped: int
    step: float
    steps: int
    limit: StableStep | None
    failure: InstabilityError | None
    largest: dict[str, float]
    final: Motion = field(repr=False)

    @property
    def openings(self) -> dict[str, np.ndarray]:
        """Openings (t,) in rad, or of slides in m, by the names of the hinges."""
        return {**self._by_name("opening"), **self._by_name("slide_opening")}

    @property
    def tensions(self) -> dict[str, np.ndarray]:
        """Tensions (t,) in N by the names of the cables."""
        return self._by_name("cable_tension")

    @property
    def asked(self) -> dict[Column, np.ndarray]:
        """What was recorded because it was asked (fpm.asked): values (t,) by column."""
        return {
            (name, label): values
            for name in VARIABLES
            for label, values in self._by_name(name).items()
        }

    @property
    def latches(self) -> dict[Column, np.ndarray]:
        """What was recorded of latches (t,), by variable and latch."""
        from deployable.fpm.trajectory import LATCHES

        return {(n, label): x for n in LATCHES for label, x in self._by_name(n).items()}

    @property
    def gap(self) -> np.ndarray:
        """Largest gap (t,) in m of all hinges."""
        return self._recorded_or_zero("hinge_gap")

    @property
    def axis_gap(self) -> np.ndarray:
        """Largest angle (t,) in rad between the axes of a hinge."""
        return self._recorded_or_zero("hinge_axis_gap")

    def _by_name(self, name: str) -> dict[str, np.ndarray]:
        if name not in self.recorded:
            return {}
        found = self.recorded[name]
        return {label: found.values[:, i] for i, label in enumerate(found.labels)}

    def _recorded_or_zero(self, name: str) -> np.ndarray:
        return self.recorded[name].values if name in self.recorded else np.zeros(len(self.time))

    def dataset(self, responses=(), attributes=None, parameters=None) -> "xarray.Dataset":
        """The trajectory as an xarray Dataset; raises the failure if there is one.

        responses: sequence of fpm.responses.Response; the others as in fpm.trajectory.contents.
        """
        from deployable.fpm.trajectory import to_dataset

        return to_dataset(self, responses, attributes, parameters)


def outcome_of(
    run, lane: int, times: np.ndarray, division, limit: StableStep | None, asked=()
) -> Outcome:
    """The outcome of one lane of a run, (Batch, parts, World, Record); asked: further columns."""
    batch, parts, world, record = run
    scene, instants = batch.scenes[lane], len(times)
    steps = division.per_instant * (instants - 1)
    tracks = record.points[:, :, lane].reshape(instants + 1, len(scene.points), 6)[:instants]
    points = {name: (tracks[:, n, :3], tracks[:, n, 3:]) for n, name in enumerate(scene.points)}
    kinds = (KINETIC, *batch.energies, BALANCE)
    recorded = {}
    for kind, part in zip(batch.kinds, parts, strict=True):
        for name, found in kind.recorded(part, scene, lane).items():
            found = found._replace(values=found.values[:instants])
            recorded[name] = found.beside(recorded[name]) if name in recorded else found
    failed = record.failed_step[lane] >= 0
    if asked and not failed:
        from deployable.fpm.kept import Kept
        from deployable.fpm.recording import recorded as columns

        recorded |= columns(Kept(batch, parts, lane, times, division.step), asked)
    watches = [watch for kind in batch.kinds for watch in kind.watches]
    values = record.failed_watched[:, lane] if failed else world.watched[0, :, lane]
    largest = {watch.name: float(x) for watch, x in zip(watches, values, strict=True)}
    failure = None
    if failed:
        limit = limit or stable_step(scene)
        failure = _failure(run, lane, largest, division.step, limit)
    noted = int(batch.event_count[lane])
    return Outcome(
        scene=scene,
        time=times,
        points=points,
        energies=_energies(batch, record, lane, instants),
        energy_kinds=kinds,
        recorded=recorded,
        events=batch.events[: min(noted, len(batch.events)), :, lane],
        eventful=eventful(scene, batch.eventful.of),
        events_dropped=max(0, noted - len(batch.events)),
        step=division.step,
        steps=steps,
        limit=limit,
        failure=failure,
        largest=largest,
        final=_final(scene, batch.kinds, world, lane, steps * division.step),
    )


def _energies(batch, record, lane: int, instants: int) -> dict[str, np.ndarray]:
    """Energies (t,) by name; those that no kind in the scene has are zero."""
    from deployable.fpm.kernels import layout as at

    table = record.energies[:instants, :, lane]
    found = {energy.name: np.zeros(instants, table.dtype) for energy in batch.energies}
    for k, energy in enumerate(batch.accounts):
        values = table[:, at.ACCOUNTS + k]
        # The work of the weight starts at the height of the scene.
        found[energy.name] = values - values[0] if k < batch.givers else values
    first = at.ACCOUNTS + len(batch.accounts)
    for k, energy in enumerate(kind.stores for kind in batch.kinds if kind.stores):
        # Kinds may share a name, as cables and beams may store strain energy.
        found[energy.name] = found[energy.name] + table[:, first + k]
    return {"kinetic": table[:, at.KINETIC], **found, "balance": table[:, at.BALANCE]}


def _failure(run, lane, largest, step: float, limit: StableStep) -> InstabilityError:
    """Why a lane failed, and what to change."""
    batch, _, _, record = run
    scene, balance = batch.scenes[lane], float(record.failed_balance[lane])
    names = [name for kind in batch.rows.of for name in kind.names(scene)]
    row, cause = record.failed_row[lane], record.failed_cause[lane]
    element = names[row] if row >= 0 else "none"
    if step > limit.step and not np.isfinite(balance):
        element = limit.element  # all elements broke down since the last check; this began it
    watches = [watch for kind in batch.kinds for watch in kind.watches]
    watch = watches[cause] if cause >= 0 else None
    return InstabilityError(
        time=record.failed_step[lane] * step,
        element=element,
        step=step,
        limit=limit.step,
        balance=balance,
        scale=float(record.scale[lane]),
        cause=watch and watch.name,
        largest=largest,
        words=watch and watch.failure(largest),
    )


def _final(scene: Scene, kinds, world, lane: int, time: float) -> Motion:
    """The motion at the last instant; the momenta stand half a step before (kept) and after it.

    What kinds prescribe is that at `time` (s).
    """
    from deployable.fpm.kernels.layout import D2, D3, P, V, X

    state, kept = world.state[:, :, lane], world.kept[:, :, lane]
    second, third = kept[:, D2 : D2 + 3], kept[:, D3 : D3 + 3]
    frame = columns(cross(second, third), second, third)
    momentum = 0.5 * (kept[:, P : P + 3] + state[:, P : P + 3])
    local = np.einsum("nji,nj->ni", frame, momentum) / scene.inertia
    velocity = 0.5 * (kept[:, V : V + 3] + state[:, V : V + 3])
    spin = np.einsum("nij,nj->ni", frame, local) * ~scene.fixed[:, 3:]
    motion = Motion(kept[:, X : X + 3].copy(), frame, velocity, spin)
    for kind in kinds:
        kind.prescribe(scene, time, motion)
    return motion
