"""Runs of a case at one mesh, timed, as the samples that the interval side takes."""

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

import fpm
from deployable import intervals
from deployable.campaign.config.sections import scene_type
from evidence.tradeoff.measure.cases import RESPONSES, Case, Choice

LANES = 8
"""Runs that cost what one costs: double-precision lanes of the widest vector unit."""
_CHUNK = 8 * LANES


def box_of(case: Case) -> intervals.Box:
    """The box of a case."""
    table = scene_type("bennett").parameters
    middle = np.array([table[name].default for name in case.intervals])
    half = middle * list(case.intervals.values())
    return intervals.Box(list(case.intervals), middle - half, middle + half)


def design_of(case: Case, choice: Choice) -> intervals.Design:
    """The design of a choice; a plain scan is the one that a campaign would run."""
    options = {} if choice.samples is None else {"samples": choice.samples}
    return intervals.make_design(choice.method, box_of(case), choice.order, **options)


def held_out_of(case: Case, choice: Choice, design: intervals.Design) -> np.ndarray:
    """Points (H, k) of the runs that test the surrogate; none for a plain scan."""
    count = 0 if choice.order is None else case.held_out
    return intervals.held_out_points(box_of(case).free, count, design.points)


def scan_of(case: Case, samples: int) -> np.ndarray:
    """Points of the dense scan: evenly spaced on a line, else a Sobol sequence with the corners."""
    if len(case.intervals) == 1:
        return np.linspace(-1.0, 1.0, samples)[:, None]
    return intervals.make_design("sobol", box_of(case), samples=samples).points


def points_of(case: Case, choices: Iterable[Choice], scan: int) -> np.ndarray:
    """All points (R, k) that the choices and the dense scan need, each once."""
    points = [scan_of(case, scan)]
    for choice in choices:
        design = design_of(case, choice)
        points += [design.points, held_out_of(case, choice, design)]
    points = np.concatenate(points)
    _, first = np.unique(np.round(points, 12) + 0.0, axis=0, return_index=True)
    return points[np.sort(first)]


@dataclass(frozen=True)
class Runs:
    """Runs at unit points (R, k): responses values (R, n, T) over time (T,) s.

    cpu (s) of a full batch of LANES runs."""

    case: Case
    points: np.ndarray
    time: np.ndarray
    values: np.ndarray
    cpu: float

    def cost(self, runs: int) -> float:
        """Cpu time (s) of so many runs, in whole batches."""
        return math.ceil(runs / LANES) * self.cpu

    def with_runs(self, runs: "Runs") -> "Runs":
        """These runs and more of the same level; the cost of a batch stays that of these."""
        return replace(
            self,
            points=np.concatenate([self.points, runs.points]),
            values=np.concatenate([self.values, runs.values]),
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
        coords = {"response": list(RESPONSES), "time": self.time}
        return xr.Dataset(data, {**coords, "parameter": list(self.case.intervals)})


def simulate(case: Case, elements: int, points: np.ndarray) -> Runs:
    """Run the case at unit points (R, k), each once; the step serves the whole box.

    RuntimeError if a run breaks down."""
    kind = scene_type("bennett")
    responses = [fpm.responses.parse(n, d, kind.sample) for n, d in RESPONSES.items()]
    box = box_of(case)

    def scene(point):
        values_by_name = dict(zip(box.names, map(float, box.from_unit(point)), strict=True))
        return kind.build(elements=elements, **values_by_name)

    ends = np.vstack([np.zeros(box.dimension), box.corners()])
    step = 0.9 * min(fpm.find_stable_step(scene(point)).step for point in ends)
    fpm.warm_up(scene(ends[0]))
    values, cpu = [], 0.0
    for first in range(0, len(points), _CHUNK):
        scenes = [scene(point) for point in points[first : first + _CHUNK]]
        start = time.process_time()
        outcomes = fpm.simulate(scenes, duration=case.duration, instants=case.instants, step=step)
        cpu += time.process_time() - start
        for outcome in outcomes:
            if outcome.failure is not None:
                raise RuntimeError(str(outcome.failure))
            values.append([response.evaluate(outcome) for response in responses])
    batches = math.ceil(len(points) / LANES)
    return Runs(case, points, outcomes[-1].time, np.array(values), cpu / batches)
