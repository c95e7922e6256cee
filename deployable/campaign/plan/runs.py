"""The runs of a plan as arrays: a million of them take some tens of megabytes, and no time."""

import hashlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.config.sections import Experiment, digest
from deployable.campaign.files.contents import FAILURE_VARIABLES, ROLES

_MAX_NAMES = 1 << 17  # names


@dataclass(frozen=True)
class PlannedRun:
    """One run to be made: its point in the box (`normalized` (k), -1 to 1) and `values` (k) of the
    interval parameters, in their units. id: digest that names its file; role: one of `ROLES`."""

    id: str
    role: str
    normalized: tuple[float, ...]
    values: tuple[float, ...]


class FailedRun(NamedTuple):
    """A run whose numbers mean nothing: the planned `run`, the `time` (s) at which that showed, NaN
    if not known, and the `reason`, a text."""

    run: PlannedRun
    time: float
    reason: str


def failure_columns(failures: Sequence[FailedRun]) -> dict[str, list]:
    """Return the columns of a result that tells which runs failed, by name; none where none did."""
    if not failures:
        return {}
    runs, times, reasons = zip(*failures, strict=True)
    keys = ("id", "normalized", "values")
    places = {key: [getattr(run, key) for run in runs] for key in keys}
    columns = zip(FAILURE_VARIABLES, (*places.values(), times, reasons), strict=True)
    return {name: list(column) for name, column in columns}


class Runs(Sequence[PlannedRun]):
    """Sequence of N runs, held as arrays: an index gives a `PlannedRun`, a slice or a list of
    indices another sequence. role (N): indices into `ROLES` (nominal, node, held_out, ...); points
    (N, k): parameters from -1 (lower end) to 1 (upper), kept as `normalized`; values (N, k): the
    same in their units; id_of: function that returns a run's id from its k values, a tuple."""

    def __init__(
        self,
        role: np.ndarray,
        points: np.ndarray,
        values: np.ndarray,
        id_of: Callable[[tuple[float, ...]], str],
    ):
        self.role, self.normalized, self.values, self.id_of = role, points, values, id_of

    @classmethod
    def from_runs(cls, runs: Sequence[PlannedRun]) -> "Runs":
        """Make the sequence from `PlannedRun` objects, which keep their ids."""
        role = np.array([ROLES.index(run.role) for run in runs], np.int8)
        names = {run.values: run.id for run in runs}
        normalized, values = (
            np.array([getattr(r, key) for r in runs], float) for key in ("normalized", "values")
        )
        return cls(role, normalized, values, names.__getitem__)

    @classmethod
    def from_points(
        cls, experiment: Experiment, role: np.ndarray, points: np.ndarray, step: float,
        mechanics: str,
    ) -> "Runs":  # fmt: skip
        """Make the sequence of an experiment's runs at normalized points (N, k); nominal runs get
        the config's exact values. role (N): as of the class; step, mechanics: as of `namer`."""
        values = experiment.box.from_unit(points)
        values[role == ROLES.index("nominal")] = experiment.nominal
        return cls(role, points, values, namer(experiment, step, mechanics))

    def __len__(self) -> int:
        return len(self.role)

    def __getitem__(self, index: Any) -> Any:
        """A `PlannedRun` for a number; for a slice, or a list of numbers, the `Runs` there."""
        if isinstance(index, list):
            index = np.array(index, int)
        role, points, values = self.role[index], self.normalized[index], self.values[index]
        if np.ndim(role):
            return Runs(role, points, values, self.id_of)
        physical = tuple(values.tolist())
        return PlannedRun(self.id_of(physical), ROLES[role], tuple(points.tolist()), physical)

    def __eq__(self, runs: object) -> bool:
        return isinstance(runs, Runs) and self.digest == runs.digest

    __hash__ = None  # type: ignore[assignment]  # as Python asks for of what cannot be hashed

    @property
    def digest(self) -> str:
        """Digest (16 hex digits) of roles, normalized points and values, to the last bit."""
        sha = hashlib.sha256(self.role.tobytes())
        sha.update(self.normalized.tobytes())
        sha.update(self.values.tobytes())
        return sha.hexdigest()[:16]

    def unique(self) -> "Runs":
        """Return the runs in order, without those that repeat an earlier one's parameter values."""
        if not self.values.shape[1]:
            return self[:1]
        words = np.ascontiguousarray(self.values).view(np.uint64)
        key: Any = np.uint64(0)
        for column in words.T:  # equal values have equal keys
            key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
            key ^= key >> np.uint64(29)
        key.sort()
        if (key[1:] != key[:-1]).all():
            return self
        rows = words.view(np.dtype((np.void, words.shape[1] * 8)))[:, 0]
        return self[np.sort(np.unique(rows, return_index=True)[1])]


class RunAccount:
    """Account of the runs of a campaign beside those that are planned, so that a limit holds for
    all that make some. limit: most runs that it may count, infinite for none; known_ids: of runs
    that are counted elsewhere. Attributes: `limit`, `ids`: names of all runs so far; `count`: runs
    that were counted here."""

    def __init__(self, limit: float = math.inf, known_ids: Iterable[str] = ()) -> None:
        self.limit, self.count, self.ids = limit, 0, set(known_ids)

    @property
    def allowance(self) -> float:
        """How many more runs the limit allows."""
        return self.limit - self.count

    def count_runs(self, ids: Sequence[str]) -> list[bool]:
        """Count the runs with these ids, as long as the limit allows, each once, and return for
        each whether it may be made (or is counted already)."""
        for run_id in ids:
            if run_id not in self.ids and self.count < self.limit:
                self.ids.add(run_id)
                self.count += 1
        return [run_id in self.ids for run_id in ids]


def namer(
    experiment: Experiment, step: float, mechanics: str
) -> Callable[[tuple[float, ...]], str]:
    """Make a function that computes a run's id from its values (k) of the interval parameters.
    step: time step (s); mechanics: digest of the structure and of the code that computes runs."""

    @lru_cache(_MAX_NAMES)
    def name(values: tuple[float, ...]) -> str:
        values_by_name = dict(zip(experiment.intervals, values, strict=True))
        return run_id(experiment, experiment.parameters(values_by_name), step, mechanics)

    return name


def run_id(experiment: Experiment, parameters: Mapping, step: float, mechanics: str) -> str:
    """Compute the id of a run (16 hex digits) from all that its motion depends on. parameters: all
    of the structure's, by name, in their units; step (s), mechanics: as of `namer`."""
    return digest(
        {
            "scene": experiment.scene.name,
            "parameters": {
                name: float(value) if type(value) is int else value
                for name, value in parameters.items()
            },
            "duration": experiment.solver.duration,
            "instants": experiment.solver.instants,
            "step": step,
            "energy_tolerance": experiment.solver.energy_tolerance,
            "mechanics": mechanics,
        }
    )
