"""Runs of a case at one discretisation, timed, as the samples that the interval side takes."""

import math
import time
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

import fpm
from deployable import intervals
from deployable.campaign.config.sections import scene_type
from evidence.tradeoff.measure.cases import Case
from evidence.tradeoff.measure.points import box_of, unique_points

LANES = 8
"""Runs that cost what one costs: double-precision lanes of the widest vector unit."""
_CHUNK = 8 * LANES
_GAP = 0.02  # share of the duration


@dataclass(frozen=True)
class Runs:
    """Runs at unit points (R, k): responses values (R, n, T), and the events (e, 3) of each.

    time (T,) s; step (s) and steps of the integration; cpu (s) of a full batch of LANES runs."""

    case: Case
    points: np.ndarray
    time: np.ndarray
    values: np.ndarray
    events: list[np.ndarray]
    step: float
    steps: int
    cpu: float

    @cached_property
    def closures(self) -> list[np.ndarray]:
        """Times of the impacts (closures after a time without contact) of each run."""
        return [_impacts(events, _GAP * float(self.time[-1])) for events in self.events]

    def cost(self, runs: int) -> float:
        """Cpu time (s) of so many runs, in whole batches."""
        return math.ceil(runs / LANES) * self.cpu

    def with_runs(self, runs: "Runs") -> "Runs":
        """These runs and more of the same level; the cost of a batch stays that of these."""
        return replace(
            self,
            points=np.concatenate([self.points, runs.points]),
            values=np.concatenate([self.values, runs.values]),
            events=[*self.events, *runs.events],
        )

    def samples(self, points: np.ndarray):
        """Samples dataset of the runs at `points` (N, k), the first ones nodes or not."""
        import xarray as xr

        rows = intervals.match_points(points, self.points)
        normalized = self.points[rows]
        data = {
            "normalized": (("run", "parameter"), normalized),
            "value": (("run", "parameter"), box_of(self.case).from_unit(normalized)),
            "values": (("run", "response", "time"), self.values[rows]),
        }
        coords = {"response": list(self.case.responses), "time": self.time}
        return xr.Dataset(data, {**coords, "parameter": list(self.case.intervals)})


def _impacts(events: np.ndarray, gap: float) -> np.ndarray:
    """Times of the events (e, 3) at which a contact closes after all have been open for longer
    than `gap` (s): contacts that close together, and chatter, count once."""
    in_contact: set[float] = set()
    last, times = -np.inf, []
    for instant, contact, closes in events[np.argsort(events[:, 0], kind="stable")]:
        if closes:
            if not in_contact and instant - last > gap:
                times.append(instant)
            in_contact.add(contact)
        else:
            in_contact.discard(contact)
        last = instant
    return np.array(times)


def simulate(case: Case, elements: int, safety: float, points: np.ndarray) -> "Runs":
    """Run the case at unit points (R, k), each once; the step serves the whole box.

    RuntimeError if a run breaks down."""
    kind = scene_type(case.scene)
    responses = [fpm.responses.parse(n, d, kind.sample) for n, d in case.responses.items()]
    box = box_of(case)

    def scene(point):
        values_by_name = dict(zip(box.names, map(float, box.from_unit(point)), strict=True))
        return kind.build(**{case.mesh: elements}, **case.fixed, **values_by_name)

    ends = np.vstack([np.zeros(box.dimension), box.corners()])
    step = safety * min(fpm.find_stable_step(scene(point)).step for point in ends)
    points = unique_points(points)
    fpm.warm_up(scene(ends[0]))
    values, events, cpu = [], [], 0.0
    for first in range(0, len(points), _CHUNK):
        scenes = [scene(point) for point in points[first : first + _CHUNK]]
        start = time.process_time()
        outcomes = fpm.simulate(scenes, duration=case.duration, instants=case.instants, step=step)
        cpu += time.process_time() - start
        for outcome in outcomes:
            if outcome.failure is not None:
                raise RuntimeError(str(outcome.failure))
            values.append([response.evaluate(outcome) for response in responses])
            events.append(outcome.events)
    batches = math.ceil(len(points) / LANES)
    last = outcomes[-1]
    run = last.time, np.array(values), events, last.step, last.steps
    return Runs(case, points, *run, cpu / batches)
