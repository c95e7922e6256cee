"""Base of the stores of runs: results to be written, records to be read, files and their names."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, digest
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import EVENT_VARIABLES, write_result
from deployable.campaign.plan.plan import FailedRun, PlannedRun, Runs
from fpm.files.seals import DamagedError, check, unseal
from fpm.files.trajectory import Column

NOTE_SUFFIX = ".failed.json"
"""Ending of the notes of runs that failed, which are named by their ids."""


@dataclass(frozen=True)
class Result:
    """A run that succeeded: the planned `run`, its `outcome` (`fpm.Outcome`), `parameters`, values
    of all structure parameters by name, and `common`, file attributes of all runs."""

    run: PlannedRun
    outcome: Any
    parameters: Mapping[str, Any]
    common: Mapping[str, Any]

    @property
    def id(self) -> str:
        """Id of the run, 16 hex digits, after which its file is named."""
        return self.run.id


@dataclass(frozen=True)
class RunRecord:
    """What `samples.nc` holds of one run. time (T): s; values (n, T): responses; events (e, 3):
    time (s), index into `contacts`, 1 if it closes; numbers (q): quantities, NaN if absent; margins
    (q), event_margins (c; of the first event at each contact): NaN if not known; overlap: largest
    of faces (rad), 0 without; step (s): finer than the plan's where the run failed with that."""

    time: np.ndarray
    values: np.ndarray
    events: np.ndarray
    contacts: Sequence[str]
    numbers: np.ndarray
    margins: np.ndarray
    event_margins: np.ndarray
    overlap: float
    step: float


class Store:
    """Base of the stores of runs, in files named by a digest of their content, so that a restarted
    campaign finds them. `quantities`: those of the experiment but for expressions of others. A
    damaged file counts as absent (`damage`: errors by path); `absences`: columns that a run's file
    lacks, by id. A run that failed has a note, `<run id>.failed.json`, and is never missing."""

    def __init__(self, folder: Path, experiment: Experiment):
        self.folder, self.experiment = folder, experiment
        self.responses = experiment.response_list
        self.quantities = [q for q in experiment.quantity_list if q.kind != "expression"]
        self.damage: dict[Path, DamagedError] = {}
        self.absences: dict[str, set[Column]] = {}

    @cached_property
    def _notes(self) -> dict[str, tuple[float, str]]:
        """Time (s) and reason of the runs that are known to fail, by id."""
        notes = {}
        for path in self.folder.glob(f"*{NOTE_SUFFIX}"):
            try:
                note = json.loads(unseal(path))
            except DamagedError as error:
                self.damage[path] = error
                continue
            notes[path.name.removesuffix(NOTE_SUFFIX)] = note["time"], note["reason"]
        return notes

    def note_failures(self, failures: Iterable[FailedRun]) -> None:
        """Write down runs that failed, so that they are not simulated again."""
        for failure in failures:
            if failure.run.id not in self._notes:
                text = json.dumps({"time": failure.time, "reason": failure.reason}, indent=1)
                write_result(self.folder / f"{failure.run.id}{NOTE_SUFFIX}", text)
                self._notes[failure.run.id] = failure.time, failure.reason

    def list_failures(self, runs: Runs) -> list[FailedRun]:
        """List those of some runs that are known to fail."""
        notes = self._notes
        return [FailedRun(run, *notes[run.id]) for run in runs if run.id in notes] if notes else []

    def sound(self, runs: Runs) -> Runs:
        """Return those of some runs that are not known to fail."""
        if not self._notes:
            return runs
        return runs[[i for i, run in enumerate(runs) if run.id not in self._notes]]

    def file_of(self, group: Runs) -> str:
        """Return the name, without suffix, of a group's file: a digest of its runs, and of the
        responses and quantities it holds."""
        values = hashlib.sha256(group.values.tobytes()).hexdigest()
        return digest([self._contents, list(self.experiment.intervals), group[0].id, values])

    @cached_property
    def _contents(self) -> list:
        """Definitions of responses and quantities that files depend on."""
        definitions = (asdict(definition) for definition in (*self.responses, *self.quantities))
        return [type(self).__name__, *definitions]

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """Return a function that counts the stored runs of these groups, by file names alone."""
        sizes = {f"{self.file_of(group)}.nc": len(group) for group in groups}
        return lambda: sum(sizes.get(path.name, 0) for path in self.folder.glob("*.nc"))

    def is_whole(self, path: Path) -> bool:
        """Return whether the file `path` exists undamaged; damage is noted in `damage`."""
        try:
            check(path, title(path))
        except DamagedError as error:
            self.damage[path] = error
        except FileNotFoundError:
            pass
        else:
            return True
        return False


def title(path: Path) -> str:
    """Return the name in the seal (checksum) of a group's file `path`, such as `runs 3f2a`."""
    return f"runs {path.stem}"


def groups_of(runs: Runs, size: int) -> list[Runs]:
    """Divide runs, in order, into groups of `size` runs; only the last may be smaller."""
    return [runs[first : first + size] for first in range(0, len(runs), size)]


def values_of(responses: Sequence[Any], outcomes: Sequence[Any]) -> np.ndarray:
    """Evaluate n responses (`Response`) of r runs at T instants as an array (r, n, T); outcomes:
    `fpm.Outcome` of each run. Raises ValueError if a value is not finite."""
    values = np.array([[r.evaluate(outcome) for r in responses] for outcome in outcomes])
    for i, response in enumerate(responses):
        if not np.isfinite(values[:, i]).all():
            raise ValueError(f"{response.name} has values that are not finite")
    return values


def numbers_of(quantities: Sequence[Any], curves: Any) -> np.ndarray:
    """Evaluate q quantities of one run as an array (2, q): their values, NaN for one that does not
    occur, and their event margins, NaN where not known. curves: the run's `Curves` or
    `fpm.Outcome`. Raises `CampaignError` if one cannot be evaluated."""
    try:
        pairs = [(quantity.evaluate(curves), quantity.margin(curves)) for quantity in quantities]
        return np.array(pairs, dtype=float).reshape(-1, 2).T
    except ValueError as error:
        raise CampaignError(str(error)) from None


def complete_numbers(experiment: Experiment, numbers: np.ndarray) -> np.ndarray:
    """Return all q quantities and event margins of an experiment (..., 2, q) from those that stores
    keep (..., 2, s), by evaluating the expressions of these."""
    quantities = experiment.quantity_list
    names = [quantity.name for quantity in quantities if quantity.kind != "expression"]
    if len(names) == len(quantities):
        return numbers
    table = []
    for rows in np.reshape(numbers, (-1, 2, len(names))):
        values, margins = (dict(zip(names, row, strict=True)) for row in rows)
        table.append([
            [quantity.read(lambda leaf, row=values: row[leaf.name]) for quantity in quantities],
            [q.read_margin(lambda leaf, row=margins: row[leaf.name]) for q in quantities],
        ])  # fmt: skip
    return np.reshape(table, (*np.shape(numbers)[:-1], len(quantities)))


def pad_events(events: Sequence[np.ndarray], least: int = 0) -> np.ndarray:
    """Stack the event tables (e, 3) of r runs into one array (r, most, 3), filled up with NaN;
    most: of a run's events, or `least`."""
    most = max(least, *map(len, events))
    tables = np.full((len(events), most, len(EVENT_VARIABLES)), np.nan)
    for row, table in zip(tables, events, strict=True):
        row[: len(table)] = table
    return tables


def largest_overlap(openings: Mapping[str, np.ndarray], contacts: Sequence[str]) -> float:
    """Largest overlap (rad) of the faces of hinge contacts, below 0 where all stay apart, 0 without
    contacts. openings: gap (T, rad) by contact; contacts without one are skipped."""
    return max((float(-openings[name].min()) for name in contacts if name in openings), default=0.0)
