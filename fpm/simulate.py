"""Run scenes side by side in lanes, and hand each sample's outcome back on its own."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fpm.errors import InstabilityError, SceneError
from fpm.scene import Scene
from fpm.timestep import StableStep, stable_step

if TYPE_CHECKING:
    import xarray

CHECK_EVERY = 50
"""The energy balance is checked at least every this many steps."""


class Motion(NamedTuple):
    """Where all particles are and how they move, in the form in which a Scene keeps its start.

    position (n, 3) m; frame (n, 3, 3) axes as columns; velocity (n, 3) m/s; spin (n, 3) rad/s.
    """

    position: np.ndarray
    frame: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


@dataclass(frozen=True)
class Outcome:
    """What one sample did.

    time (t,) s; points: name -> (position (t, 3) m, velocity (t, 3) m/s); openings: hinge ->
    (t,) rad; gap (t,) m and axis_gap (t,) rad: largest over the hinges; energies: kind -> (t,) J;
    events (e, 3): time (s), contact index, 1 if it closes; events_dropped: how many more there
    were; largest_bend: largest sine of the angle between an element's chord and its ends, or of its
    twist; largest_strain: that at the surface of an element; final: the motion of all particles at
    the end; failure: None or the InstabilityError of this sample, whose curves and final motion
    mean nothing then.
    """

    scene: Scene
    time: np.ndarray
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    openings: dict[str, np.ndarray]
    gap: np.ndarray
    axis_gap: np.ndarray
    energies: dict[str, np.ndarray]
    events: np.ndarray
    events_dropped: int
    step: float
    steps: int
    limit: StableStep
    failure: InstabilityError | None
    largest_bend: float
    largest_strain: float
    final: Motion

    def dataset(self, responses=(), attributes=None) -> "xarray.Dataset":
        """The trajectory as an xarray Dataset (trajectory.py); raises the failure if there is one.

        responses: sequence of fpm.responses.Response; attributes: extra global attributes.
        """
        from fpm.trajectory import to_dataset

        if self.failure is not None:
            raise self.failure
        return to_dataset(self, responses, attributes or {})


class Division(NamedTuple):
    """How the time between two instants is divided: step (s), steps per instant and per check."""

    step: float
    per_instant: int
    per_check: int


def divide_time(duration: float, instants: int, wanted: float) -> Division:
    """The step that `simulate` takes: at most `wanted` (s), whole steps between two instants."""
    interval = duration / (instants - 1)
    # The tiny allowance keeps a step that was given as an exact share of the interval.
    steps = max(1, math.ceil(interval / wanted * (1 - 1e-12)))
    checks = math.ceil(steps / CHECK_EVERY)
    per_check = math.ceil(steps / checks)
    return Division(interval / (per_check * checks), per_check * checks, per_check)


def simulate(
    scenes: Scene | Sequence[Scene],
    *,
    duration: float,
    instants: int,
    step: float | None = None,
    safety: float = 0.9,
    energy_tolerance: float = 0.02,
    dtype=np.float64,
) -> list[Outcome]:
    """Integrate scenes of one topology over `duration` s; one Outcome per scene, in order.

    instants: number of recorded instants, evenly spaced from 0 to duration, both included.
    step (s): the time step, shortened if need be so that whole steps make up the time between two
    instants; None: `safety` times the smallest stable step of the scenes given. A sample's
    numbers depend on its scene and the step only, bit for bit, not on the scenes beside it.
    energy_tolerance: a sample fails when its energy balance is off by more than this share of the
    largest energy it held. SceneError for bad arguments or topologies that differ.
    """
    from fpm.kernels.compiled import run
    from fpm.kernels.lanes import width as lanes_of
    from fpm.pack import blank, blank_record, check_topology, pack

    scenes = [scenes] if isinstance(scenes, Scene) else list(scenes)
    if not scenes:
        return []
    if not (np.isfinite(duration) and duration > 0):
        raise SceneError("duration", duration, "a positive number (s)")
    if instants < 2:
        raise SceneError("instants", instants, "at least 2")
    if step is not None and not (np.isfinite(step) and step > 0):
        raise SceneError("step", step, "a positive number (s), or None")
    check_topology(scenes)
    interval = duration / (instants - 1)
    limits = [stable_step(scene) for scene in scenes] if step is None else None
    wanted = safety * min(limit.step for limit in limits) if step is None else step
    step, per_instant, per_check = divide_time(duration, instants, wanted)
    steps = per_instant * (instants - 1)

    outcomes = []
    width = lanes_of(dtype)
    for first in range(0, len(scenes), width):
        batch = scenes[first : first + width]
        state, model = pack(batch, width, dtype)
        record = blank_record(model, instants, len(batch))
        kept = blank(*state.shape, dtype)
        # A whole number would be another type, for which the loop would be compiled again.
        tolerance = float(energy_tolerance)
        run(state, kept, model, record, step, steps, per_instant, per_check, tolerance)
        for lane, scene in enumerate(batch):
            limit = None if limits is None else limits[first + lane]
            outcomes.append(
                _outcome(scene, lane, state, kept, record, interval, step, steps, limit)
            )
    return outcomes


def _outcome(scene, lane, state, kept, record, interval, step, steps, limit) -> Outcome:
    from fpm.kernels.layout import ENERGIES
    from fpm.kernels.record import GAPING, TOO_COARSE, TOO_STRAINED

    instants = len(record.energies) - 1
    points = {}
    for n, name in enumerate(scene.points):
        track = record.points[:instants, 6 * n : 6 * n + 6, lane]
        points[name] = (track[:, :3], track[:, 3:])
    hinges = record.hinges[:instants, :, lane]
    failure = None
    failed = record.failed_step[lane] >= 0
    largest = record.failed_largest if failed else record.largest[0]
    bend, strain, gap, tilt = map(float, largest[:, lane])
    bend = math.sqrt(bend)
    if failed:
        limit = limit or stable_step(scene)
        balance = float(record.failed_balance[lane])
        gaping = record.failed_cause[lane] == GAPING
        if gaping:
            element = f"hinge {scene.hinges[record.failed_element[lane]].name}"
        else:
            element = scene.elements[record.failed_element[lane]] if scene.elements else "none"
        if step > limit.step and not math.isfinite(balance):
            element = limit.element  # all elements broke down since the last check; this began it
        failure = InstabilityError(
            time=record.failed_step[lane] * step,
            element=element,
            step=step,
            limit=limit.step,
            balance=balance,
            scale=float(record.scale[lane]),
            bend=bend if record.failed_cause[lane] == TOO_COARSE else None,
            strain=strain if record.failed_cause[lane] == TOO_STRAINED else None,
            gap=(gap, tilt) if gaping else None,
        )
    noted = int(record.event_count[lane])
    energies = {name: record.energies[:instants, k, lane] for k, name in enumerate(ENERGIES)}
    energies["load_work"] = energies["load_work"] - energies["load_work"][0]  # weight starts at 0
    return Outcome(
        scene=scene,
        time=interval * np.arange(instants),
        points=points,
        openings={h.name: hinges[:, i] for i, h in enumerate(scene.hinges)},
        gap=hinges[:, -2],
        axis_gap=hinges[:, -1],
        energies=energies,
        events=record.events[: min(noted, len(record.events)), :, lane],
        events_dropped=max(0, noted - len(record.events)),
        step=step,
        steps=steps,
        limit=limit,
        failure=failure,
        largest_bend=bend,
        largest_strain=strain,
        final=_final(scene, state[:, :, lane], kept[:, :, lane], steps * step),
    )


def _final(scene: Scene, state: np.ndarray, kept: np.ndarray, time: float) -> Motion:
    """The motion at the last instant; the momenta stand half a step before (kept) and after it.

    That of driven particles is the one prescribed at `time` (s).
    """
    from fpm.kernels.layout import D2, D3, P, V, X

    second, third = kept[:, D2 : D2 + 3], kept[:, D3 : D3 + 3]
    frame = np.stack([np.cross(second, third), second, third], axis=-1)
    momentum = 0.5 * (kept[:, P : P + 3] + state[:, P : P + 3])
    local = np.einsum("nji,nj->ni", frame, momentum) / scene.inertia
    velocity = 0.5 * (kept[:, V : V + 3] + state[:, V : V + 3])
    spin = np.einsum("nij,nj->ni", frame, local) * ~scene.fixed[:, 3:]
    particles, velocity[particles], spin[particles] = scene.driven(time)
    return Motion(kept[:, X : X + 3].copy(), frame, velocity, spin)
