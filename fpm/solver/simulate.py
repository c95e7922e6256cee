"""Run scenes side by side in lanes, and hand each sample's outcome back on its own."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from numbers import Real
from typing import Any, NamedTuple

import numpy as np

from fpm.elements.cross import columns as stack_columns
from fpm.elements.kind import Series
from fpm.errors import InstabilityError, SceneError
from fpm.files.outcome import Outcome, columns_of
from fpm.files.trajectory import PEAK, READING, Column, Energies
from fpm.kernels.layout import WIDTH
from fpm.reading.quantities import Quantity
from fpm.reading.variables import add_probe
from fpm.scenes.scene import Scene
from fpm.scenes.timestep import SAFETY, find_curve_step, find_stable_step
from fpm.solver import pack
from fpm.solver.pack import outcomes_of
from fpm.solver.start import consistent_scene, consistent_scenes

CHECK_EVERY = 50
"""Number of steps from one check of the energy balance to the next, at most."""


HALVINGS, AT_START, IN_STEPS, CHEAP_STEPS = 3, 9, 50, 20_000
"""How often a run that a shorter step may mend is repeated with half of it, at most, where the step
was not stated; how often one that fails so soon, in steps, or is of few steps in all."""

_KINK = -2
"""Number of a kink of a curve of time among events, which no element has."""


class Division(NamedTuple):
    """Division of a run into equal steps. step: length (s); output_steps: number of steps from one
    recorded instant to the next; check_steps: from one check of the energy balance to the next."""

    step: float
    output_steps: int
    check_steps: int


def divide_time(duration: float, instants: int, max_step: float) -> Division:
    """Divide the time between two recorded instants into equal steps; returns the Division.

    Parameters
    ----------
    duration: of the run (s), above 0.
    instants: number of recorded instants, with both ends; at least 2.
    max_step: largest allowed step (s), above 0."""
    interval = duration / (instants - 1)
    # The tiny allowance keeps a step that was given as an exact share of the interval.
    steps = max(1, math.ceil(interval / max_step * (1 - 1e-12)))
    checks = math.ceil(steps / CHECK_EVERY)
    check_steps = math.ceil(steps / checks)
    return Division(interval / (check_steps * checks), check_steps * checks, check_steps)


def simulate(
    scenes: Scene | Sequence[Scene],
    *,
    duration: float,
    instants: int,
    step: float | None = None,
    safety: float = SAFETY,
    energy_tolerance: float = 0.02,
    record: Iterable[Column] = (),
    halvings: int | None = None,
    readings: int = 0,
    peaks: Sequence[Quantity] = (),
) -> list[Outcome]:
    """Integrate scenes that differ in numbers only, side by side; returns an Outcome for each, in
    order, with `failure` set where the run failed. A sample's numbers depend on its scene and the
    step only, bit for bit, not on the scenes beside it. SceneError for arguments that are not
    allowed, and scenes that differ in more than numbers.

    Parameters
    ----------
    scenes: one scene, or several that differ in numbers only.
    duration: simulated time (s), above 0.
    instants: number of recorded instants, evenly spaced from 0 to `duration`; at least 2.
    step: time step (s), shortened so that whole steps make up the time between two instants; None:
        `safety` times the smallest stable step of the scenes, at most a quarter of the finest
        feature of their curves of time.
    safety: factor on the stable step, where no step is given.
    energy_tolerance: a sample fails where the error of its energy balance exceeds this fraction of
        the largest energy that it has had so far.
    record: columns, (variable, label), that are recorded as well (`fpm.reading.variables`). The
        motion, and what is always recorded, do not depend on them.
    halvings: how often a run whose energy balance breaks, whose numbers are not finite, or whose
        joints open is repeated with half the step before it fails (`Outcome.step` is that of the
        last time), AT_START times if it fails at once or has few steps; None: HALVINGS if no step
        is given, else 0.
    readings: into how many parts the time between two instants is divided to read `peaks`; 0: none
        are read.
    peaks: quantities with a `peak_column`, which outcomes get."""
    scenes = (
        list(scenes) if isinstance(scenes, Sequence) and not isinstance(scenes, str) else [scenes]
    )
    for scene in scenes:
        if not isinstance(scene, Scene):
            raise SceneError(
                "scenes",
                type(scene).__name__,
                "a scene, as structures.load(path).build() makes one",
            )
    if not scenes:
        return []
    record = tuple(dict.fromkeys(record))
    if record:
        scenes = [add_probe(scene, record) for scene in scenes]
    set_step = 1.0 if step is None else step
    for key, value, is_allowed, allowed in (
        ("duration", duration, lambda x: 0 < x < np.inf, "a positive number (s)"),
        ("instants", instants, lambda x: x >= 2, "at least 2"),
        ("step", set_step, lambda x: 0 < x < np.inf, "a positive number (s), or None"),
        ("safety", safety, lambda x: 0 < x < np.inf, "a positive number"),
        ("energy_tolerance", energy_tolerance, lambda x: x >= 0, "a number of at least 0"),
    ):
        if not (isinstance(value, Real) and is_allowed(value)):
            raise SceneError(key, value, allowed)
    pack.check_topology(scenes)
    scenes = consistent_scenes(scenes)
    limits: list[Any] = [None] * len(scenes)
    if halvings is None:
        halvings = HALVINGS if step is None else 0
    if step is None:
        limits = [find_stable_step(scene) for scene in scenes]
        step = min(find_curve_step(scene, duration) for scene in scenes)
        step = min(step, *(safety * limit.step for limit in limits))
    times = duration / (instants - 1) * np.arange(instants)
    instants = max(1, readings) * (instants - 1) + 1
    close_times = duration / (instants - 1) * np.arange(instants)
    division = divide_time(duration, instants, step)

    outcomes: dict[int, Outcome] = {}
    rows = list(range(len(scenes)))
    previous_failures: dict[int, Any] = {}
    for count in range(1 + max(halvings, AT_START)):
        for lanes in _batches(scenes, rows):
            group = [scenes[i] for i in lanes]
            run = _integrate(group, instants, division, energy_tolerance)
            lane_limits = [limits[i] for i in lanes]
            lane_outcomes = outcomes_of(run, close_times, division, lane_limits, record)
            if readings:
                lane_outcomes = [_read_peaks(o, peaks, times) for o in lane_outcomes]
            outcomes.update(zip(lanes, lane_outcomes, strict=True))
        failures = {i: outcomes[i].failure for i in rows}
        rows = [i for i in rows if _is_repeated(outcomes[i], halvings, count)]
        for i in previous_failures.keys() - rows:
            _note_dead_end(previous_failures[i], failures[i], division)
        previous_failures = {i: failures[i] for i in rows}
        division = divide_time(duration, instants, division.step / 2)
    return [outcomes[i] for i in range(len(scenes))]


def _read_peaks(outcome: Outcome, peaks: Sequence[Quantity], times: np.ndarray) -> Outcome:
    """Return an outcome at the instants `times` (s) alone, with the columns of `peaks` by those
    between, too. Where a curve of time has a kink, motions may jump, as at events."""
    stride = (len(outcome.time) - 1) // (len(times) - 1)

    def thin(values: np.ndarray) -> np.ndarray:
        return values[::stride].copy()

    records = {
        name: series._replace(values=thin(series.values)) if series.time_dim == "time" else series
        for name, series in outcome.records.items()
    }
    if outcome.failure is None:
        kinks = np.unique([k for c in outcome.scene.curves for k in c.kinks if np.isfinite(k)])
        events = np.concatenate([outcome.events, stack_columns(kinks, 0, _KINK)])
        whole, text = replace(outcome, events=events), "quantities, read between instants, too"
        rows = {k: x for peak in peaks for k, x in peak.readings(whole).items()}
        values = np.array([[*rows.values()]])
        records[PEAK] = Series(values, "", text, "peak_of", tuple(rows), READING)
    return replace(
        outcome,
        time=times,
        points={name: (thin(x), thin(v)) for name, (x, v) in outcome.points.items()},
        energies=Energies((name, thin(values)) for name, values in outcome.energies.items()),
        records=records,
        columns=columns_of(records),
    )


def _batches(scenes: Sequence[Scene], rows: Iterable[int]) -> list[list[int]]:
    """Indices, among `rows`, of scenes that are integrated side by side: of the same curves."""
    groups: dict[tuple, list[int]] = {}
    for i in rows:
        groups.setdefault(pack.curve_bytes(scenes[i]), []).append(i)
    return [g[first : first + WIDTH] for g in groups.values() for first in range(0, len(g), WIDTH)]


def _is_repeated(outcome: Outcome, halvings: int, count: int) -> bool:
    """Whether a run is repeated with half the step, after `count` times, halvings being allowed, as
    that may mend it: the balance broke, or the remedy names the step."""
    failure = outcome.failure
    if not isinstance(failure, InstabilityError):
        return False
    if failure.words is not None and "solver.step" not in failure.words[1]:
        return False
    is_cheap = outcome.steps <= CHEAP_STEPS or failure.time <= IN_STEPS * failure.step
    return count < (max(AT_START, halvings) if halvings and is_cheap else halvings)


def _note_dead_end(previous_failure, failure, division: Division) -> None:
    """Say that a shorter step does not help where joints open, and a run fails with the longer step
    before at the same time, to that between checks; not where it does so from the start on."""
    if isinstance(failure, InstabilityError):
        failure.final_words = failure.final_words or previous_failure.final_words
        reach = 3 * division.check_steps * division.step
        if failure.final_words and abs(failure.time - previous_failure.time) < reach < failure.time:
            failure.as_final()


def _integrate(scenes, instants, division, tolerance, room=0):
    """Integrate a batch of scenes; returns Batch, arrays of its element types, World and Record. It
    is repeated where there are more events than there is room for."""
    from fpm.kernels.compiled_loop import prepare_call

    room = room or pack.MOST_EVENTS
    batch = pack.pack(scenes, instants, room)
    step, output_steps, check_steps = division
    steps = output_steps * (instants - 1)
    parts, world, record = batch.parts(), batch.world(), batch.record(step, steps)
    counts = steps, output_steps, check_steps
    prepare_call("run", parts, world, record, float(step), *counts, float(tolerance))()
    event_count = min(int(batch.event_count[: len(scenes)].max()), pack.MOST_ROOM)
    if event_count > room:
        return _integrate(scenes, instants, division, tolerance, event_count)
    return batch, parts, world, record


def list_kinds_to_compile(scene: Scene, record: Sequence[Column] = ()) -> list[type | None]:
    """Return what a run of a scene needs and is not on disk, compiled: element types, and None for
    the time loop. record: columns of the run."""
    from fpm.kernels import compiled_loop

    scene = consistent_scene(add_probe(scene, record))
    batch = pack.pack([scene], 2)
    world, parts = batch.world(), zip(batch.kinds, batch.parts(), strict=True)
    kinds: list[type | None]
    kinds = [kind for kind, part in parts if not compiled_loop.is_compiled(part, world)]
    return kinds if compiled_loop.is_loop_compiled() else [None, *kinds]


def warm_up(scene: Scene, record=()) -> None:
    """Compile the time loop and the element types of a scene, or load them from the cache on disk,
    so that a later run starts at once. record: columns (variable, label) of that run."""
    # One step; a stable one takes a while.
    simulate(scene, duration=1e-9, instants=2, step=1e-9, record=record)
