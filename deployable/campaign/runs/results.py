"""Base of the stores of runs: results that are written, records that are read, files and their
names."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, digest
from deployable.campaign.errors import CampaignError
from deployable.campaign.files.outside import refuse_outside
from deployable.campaign.plan.runs import PlannedRun, Runs
from fpm.files.sealed import DamagedError, check
from fpm.files.trajectory import Column
from fpm.kernels import sources

# Contact events as the interval side gets them, in the order of the columns of `RunRecord.events`.
EVENT_VARIABLES = ("event_time", "event_contact", "event_closing")


@dataclass(frozen=True)
class Result:
    """A run that succeeded: its `fpm.Outcome`, parameter values by name, and attributes that the
    files of all runs of the plan have in common."""

    run: PlannedRun
    outcome: Any
    parameters: Mapping[str, Any]
    common: Mapping[str, Any]

    @property
    def id(self) -> str:
        """Name of the run."""
        return self.run.id

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the run's file by name."""
        own = {f"parameter_{name}": v for name, v in self.parameters.items() if v is not None}
        return {"run_id": self.id, **self.common, **own}


@dataclass(frozen=True)
class RunRecord:
    """A run as `samples.nc` needs it.

    time (t,): s; values (n, t): responses; events (e, 3): time (s), contact index, 1 if it closes;
    contacts: their names; numbers (q,): quantities, NaN for one that does not occur; overlap:
    largest overlap of the faces of a contact at the instants, rad.
    """

    time: np.ndarray
    values: np.ndarray
    events: np.ndarray
    contacts: Sequence[str]
    numbers: np.ndarray
    overlap: float


class Store:
    """A folder of results of runs under names that follow from their content; responses and
    quantities are those of `experiment`.

    A finished run is found again by a campaign that was killed. A file that is damaged or another
    run's counts as absent, and is noted in `damage` until written again; `lacking` has, by run, the
    columns that its file lacks. A store knows which runs of a group are `missing`, and can `write`
    the results of a group and `read` its records.
    """

    def __init__(self, folder: Path, experiment: Experiment):
        self.folder, self.experiment = folder, experiment
        self.responses, self.quantities = experiment.curves, experiment.numbers
        self.damage: dict[Path, DamagedError] = {}
        self.lacking: dict[str, set[Column]] = {}

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """Divide runs into groups that are written together, of `size` runs each but the last."""
        return groups_of(runs, size)

    def previous_columns(self, runs: Runs) -> set[Column]:
        """Columns (variables of `fpm.reading.variables`) to be recorded again of runs besides what
        responses need, since their files had them."""
        return set()

    def file_of(self, group: Runs) -> str:
        """Name without suffix of a group's file: a digest of its runs and of the definitions of its
        contents."""
        values = hashlib.sha256(group.values.tobytes()).hexdigest()
        return digest([self._contents, list(self.experiment.intervals), group[0].id, values])

    @cached_property
    def _contents(self) -> list:
        """What files depend on that hold responses and quantities and not what they are made of:
        their definitions, and the code that reads them off a run."""
        definitions = (asdict(definition) for definition in (*self.responses, *self.quantities))
        return [type(self).__name__, sources.reading(), *definitions]

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """A function that returns how many runs of the groups are stored, by file names alone."""
        sizes = {f"{self.file_of(group)}.nc": len(group) for group in groups}
        return lambda: sum(sizes.get(path.name, 0) for path in self.folder.glob("*.nc"))

    def checked(self, record: RunRecord) -> RunRecord:
        """Check that shapes and values of a record are those of the campaign, and return it; raises
        ValueError where not."""
        shapes = [np.shape(array) for array in (record.time, record.values, record.numbers)]
        count, instants = len(self.responses), self.experiment.solver.instants
        if shapes != [(instants,), (count, instants), (len(self.quantities),)]:
            raise ValueError("it has other instants, responses or quantities than the campaign")
        indices = record.events[:, 1]
        if not (np.isfinite(record.values).all() and np.isfinite(record.overlap)):
            raise ValueError("it has values that are no numbers")
        if not ((indices >= 0) & (indices < len(record.contacts))).all():
            raise ValueError("it has events of no contact")
        return record

    def is_whole(self, path: Path) -> bool:
        """Whether the file at `path` is there undamaged; a damaged one is noted in `damage`."""
        try:
            check(path, title(path))
            refuse_outside(path)
        except DamagedError as error:
            self.damage[path] = error
        except FileNotFoundError:
            pass
        else:
            return True
        return False


def title(path: Path) -> str:
    """Name of a group's file in its seal."""
    return f"runs {path.stem}"


def groups_of(runs: Runs, size: int) -> list[Runs]:
    """Divide runs, in order, into groups of `size`; only the last group may be smaller."""
    return [runs[first : first + size] for first in range(0, len(runs), size)]


def values_of(responses: Sequence[Any], outcomes: Sequence[Any]) -> np.ndarray:
    """Values (r, n, t) of n responses of r runs at t instants; outcomes: `fpm.Outcome` of each run.
    Raises ValueError if one is not finite."""
    values = np.array([[r.evaluate(outcome) for r in responses] for outcome in outcomes])
    for i, response in enumerate(responses):
        if not np.isfinite(values[:, i]).all():
            raise ValueError(f"{response.name} has values that are not finite")
    return values


def numbers_of(quantities: Sequence[Any], curves: Any) -> np.ndarray:
    """Quantities (q,) of one run, NaN for one that does not occur. quantities: their definitions;
    curves: of the run, or its `fpm.Outcome`. Raises `CampaignError` where one cannot be
    evaluated."""
    try:
        return np.array([quantity.evaluate(curves) for quantity in quantities], dtype=float)
    except ValueError as error:
        raise CampaignError(str(error)) from None


def padded(events: Sequence[np.ndarray], least: int = 0) -> np.ndarray:
    """Events of r runs, tables (e, 3), as one array (r, most, 3) filled with NaN; `most` is at
    least `least`."""
    most = max(least, *map(len, events))
    tables = np.full((len(events), most, len(EVENT_VARIABLES)), np.nan)
    for row, table in zip(tables, events, strict=True):
        row[: len(table)] = table
    return tables


def largest_overlap(openings: Mapping[str, np.ndarray], contacts: Sequence[str]) -> float:
    """Largest overlap (rad) of the faces of the contacts on hinges, from their openings (t,)."""
    return max((float(-openings[name].min()) for name in contacts if name in openings), default=0.0)


def write_dimension(file: Any, dimension: str, names: Iterable[str], long_name: str) -> None:
    """Define a dimension in an open netCDF file, with names as its coordinate, which gets the
    attribute `long_name`."""
    names = np.array([str(name) for name in names], dtype=object)
    file.createDimension(dimension, len(names))
    variable = file.createVariable(dimension, str, (dimension,))
    variable.long_name = long_name
    if len(names):
        variable[:] = names


def write_netcdf(path: Path, names: Mapping[str, Sequence[str]], variables: Mapping) -> None:
    """Write a netCDF file of dimensions with names, and variables.

    names: of each dimension; variables: by name the type, dimensions, values and options of
    netCDF4's `createVariable`.
    """
    import netCDF4

    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        for dimension, own in names.items():
            write_dimension(file, dimension, own, f"name of the {dimension}")
        for name, (kind, dims, values, options) in variables.items():
            for dim, size in zip(dims, np.shape(values), strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size)
            file.createVariable(name, kind, dims, **options)[:] = values


def names_of(holder: Any) -> dict[str, list[str]]:
    """Names of responses and quantities of a store or of a chunk, by dimension."""
    return {
        "response": [response.name for response in holder.responses],
        "quantity": [quantity.name for quantity in holder.quantities],
    }
