"""The runs of a campaign: planned ones, of `samples.nc`, and those that answers added, of
`refinement.nc`. Nothing else that shows or tells results knows these files."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import EVENT_VARIABLES, FAILURE_VARIABLES, ROLES, open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import FailedRun, PlannedRun


class RunTable(NamedTuple):
    """R runs: `points` (R, k), -1 to 1; `values` (R, k), in the parameters' units; `numbers` (R,
    q), NaN for one that does not occur; `margins` (R, q) of events, NaN where not known."""

    points: np.ndarray
    values: np.ndarray
    numbers: np.ndarray
    margins: np.ndarray

    @classmethod
    def read(cls, file: Any) -> "RunTable":
        """Read the runs of an open file (`netCDF4.Dataset`)."""
        variables, points = file.variables, file["normalized"][:]
        numbers = np.zeros((len(points), 0))
        numbers = variables["quantities"][:] if "quantities" in variables else numbers
        margins = variables["margin"][:] if "margin" in variables else np.nan * numbers
        return cls(points, file["value"][:], numbers, margins)

    @classmethod
    def join(cls, tables: "Sequence[RunTable]") -> "RunTable":
        """Put tables of the same parameters and quantities below each other."""
        return cls(*map(np.concatenate, zip(*tables, strict=True)))


def read_failures(file: Any) -> list[FailedRun]:
    """Read the runs that failed from an open `samples.nc` or `refinement.nc`."""
    if FAILURE_VARIABLES[0] not in file.variables:
        return []
    columns = (file[name][:].tolist() for name in FAILURE_VARIABLES)
    return [
        FailedRun(PlannedRun(id_, ROLES[-1], tuple(point), tuple(values)), time, reason)
        for id_, point, values, time, reason in zip(*columns, strict=True)
    ]


def describe_failures(failures: Iterable[FailedRun], names: Iterable[str]) -> list[dict]:
    """Describe runs that failed as plain data: parameter values by name (`at`), `time` (s), None if
    it is not known, and `reason`. names: of the interval parameters."""
    names = list(names)
    return [
        {"at": dict(zip(names, run.values, strict=True)),
         "time": None if np.isnan(time) else time, "reason": reason}
        for run, time, reason in failures
    ]  # fmt: skip


def read_refinement(folder: Folder) -> tuple[RunTable, list[str], list[FailedRun]]:
    """Read the runs that answers added, their ids, and those that failed: of `refinement.nc`."""
    with open_netcdf(folder.refinement) as file:
        return RunTable.read(file), file["run_id"][:].tolist(), read_failures(file)


@contextmanager
def open_samples(folder: Folder) -> "Iterator[RunSamples]":
    """Context manager that gives the runs of a campaign, with any `jobs.keep`. folder: of the
    results. Raises `DamagedError` where `samples.nc` is not as written."""
    with open_netcdf(folder.samples) as file:
        samples = RunSamples(file)
        scene = samples.experiment.scene
        # Its path is as seen from the folder where the campaign was run, above the results.
        paths = (place / scene.file for place in (Path(), *folder.path.absolute().parents))
        if scene.file and (path := next((p for p in paths if p.is_file()), None)):
            scene = replace(scene, file=str(path))
            samples.experiment = replace(samples.experiment, scene=scene)
        yield samples


class RunSamples:
    """Runs of a campaign, of its open `samples.nc`; what may be large is read when it is first
    asked for. `finest_step` (s): of runs that failed with `time_step` and were repeated;
    `mechanics`: digest of structure and program; `contacts`: names of contacts, stops and latches;
    `overlap`: largest one of the faces of a contact (rad); `assembly_energy` (J): at the start."""

    def __init__(self, file: Any):
        self._file, self.experiment = file, Experiment.read(file.config)
        self.time_step, self.mechanics = float(file.time_step), file.mechanics
        self.finest_step = float(getattr(file, "finest_step", self.time_step))
        self.contacts = file["contact"][:].tolist()
        self.overlap = float(file["overlap"][:].max())
        self.assembly_energy = float(getattr(file, "assembly_energy", 0.0))

    @cached_property
    def failures(self) -> list[FailedRun]:
        """The planned runs that failed, which are not among the others."""
        return read_failures(self._file)

    def __len__(self) -> int:
        return len(self._file.dimensions["run"])

    @cached_property
    def table(self) -> RunTable:
        """Parameters, quantities and event margins of all runs."""
        return RunTable.read(self._file)

    @cached_property
    def roles(self) -> list[str]:
        """Role of each run: `nominal`, `node` (fitted), `held_out` (a test)."""
        return self._file["role"][:].tolist()

    @property
    def nominal(self) -> int | None:
        """Index of the run with nominal parameters; None if there is none."""
        return self.roles.index(ROLES[0]) if ROLES[0] in self.roles else None

    def ids(self, rows: Sequence[int] | slice = slice(None)) -> list[str]:
        """Names (16 hex digits) of runs; rows: indices, or a slice."""
        rows = rows if isinstance(rows, slice) else list(rows)
        return self._file["run_id"][:][rows].tolist()

    def count(self) -> dict[str, Any]:
        """Count different runs: all `runs`; `nodes`, that were fitted; `held_out`, as tests."""
        ids: dict[str, set] = {role: set() for role in ROLES}
        for role, run in zip(self.roles, self.ids(), strict=True):
            ids[role].add(run)
        nominal, nodes, held_out, _ = ids.values()
        counts = len(nodes), len(held_out - nodes), len(nodes | held_out | nominal)
        return dict(zip(("nodes", "held_out", "runs"), counts, strict=True))

    def events(self, rows: Sequence[int]) -> list[np.ndarray]:
        """Events (e, 3) of each of some runs (indices): time (s), index into `contacts`, 1 where
        that closes and 0 where it opens."""
        columns = [self._file[name][:][list(rows)] for name in EVENT_VARIABLES]
        return [table[np.isfinite(table[:, 0])] for table in np.stack(columns, axis=-1)]

    def curves(self, runs: int | slice, responses: list[int] | slice = slice(None)) -> np.ndarray:
        """Responses (n, T) of a run, or (R, n, T) of several. runs, responses: indices."""
        return self._file["values"][runs, responses]

    def extreme_runs(self, response: int, instant: int) -> tuple[int, int]:
        """Indices of the runs with the least and the largest value of a response at an instant."""
        values = self._file["values"][:, response, instant]
        return int(values.argmin()), int(values.argmax())


def check_mechanics(experiment: Experiment, mechanics: str, folder: Folder) -> None:
    """Raise `CampaignError` if structure or program are no longer those by which runs were made.
    mechanics: digest of these; folder: of the results."""
    if experiment.mechanics != mechanics:
        raise CampaignError(
            f"the structure or the mechanics have changed since {folder.path} was made, so that "
            "its runs cannot be made again; run the campaign first"
        )


def describe_events(events: np.ndarray, contacts: Sequence[str]) -> list[dict[str, Any]]:
    """Describe events (e, 3), as of `RunSamples.events`, in the order of time: dicts of `time` (s),
    `contact` (name) and `closing`, whether it closes. contacts: names by index."""
    return [
        {"time": time, "contact": contacts[int(contact)], "closing": closing == 1}
        for time, contact, closing in sorted(events.tolist())
    ]
