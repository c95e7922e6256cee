"""Where the results of runs are kept, under names that follow from their content.

A finished run is found again by a campaign that was killed, and by any later design that asks for
it if its trajectory was kept. A file that is not as it was written, or is another run's, counts as
absent, and is noted in `damaged` until it is written again. Three ways to keep a run, with the same
methods:

`Trajectories`  one netCDF file per run, `<run id>.nc`, with everything recorded. What is recorded
                on request (`fpm.reading.variables`) may be lacking: then the run is noted in
                `lacking` and counts as absent, and what it had is recorded again as well;
`Responses`     one netCDF file per group, `<digest of the group's runs>.nc`, with the
                responses, contact events and quantities only. Other groups have other files:
                another design, size of group or response simulates its runs again;
`Extremes`      one netCDF file per share of a scan, with the least and largest values over time
                (`campaign.runs.extremes`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.files import whole_file
from deployable.campaign.plan.runs import Run, Runs
from deployable.campaign.runs.extremes import Extremes
from deployable.campaign.runs.results import (
    EVENT_VARIABLES,
    Record,
    Result,
    asked_of,
    group_digest,
    groups_of,
    largest_overlap,
    listed,
    numbers_of,
    padded,
    write_dimension,
)
from fpm.files.sealed import DamagedError, check
from fpm.files.trajectory import Column


def open_store(keep: str, folder: str | Path, experiment: Experiment) -> Any:
    """The store for a config's `jobs.keep` in `folder`; the experiment says which responses
    and quantities."""
    return STORES[keep](Path(folder), experiment)


class Trajectories:
    """One netCDF file per run. It depends on the responses only by what they ask to be recorded."""

    def __init__(self, folder: Path, experiment: Experiment):
        self.folder = folder
        self.responses, self.quantities = experiment.curves, experiment.numbers
        self.damaged: dict[Path, DamagedError] = {}
        self.lacking: dict[str, set[Column]] = {}
        self._had: dict[str, set[Column]] = {}
        self._needs = {need for response in self.responses for need in response.needs}

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """Runs that are written together."""
        return groups_of(runs, size)

    def path(self, run: Run) -> Path:
        return self.folder / f"{run.id}.nc"

    def missing(self, group: Runs) -> Runs:
        """The runs of the group that are still to be simulated."""
        return group[[i for i, run in enumerate(group) if self._curves(run) is None]]

    def had(self, runs: Runs) -> set[Column]:
        """Columns that some of these runs have in files that lack others."""
        return set().union(*(self._had.get(run.id, ()) for run in runs))

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """A function that tells how many runs of groups are there, by the names of files alone."""
        names = {f"{run.id}.nc" for group in groups for run in group}
        return lambda: sum(name in names for name in listed(self.folder))

    def write(self, group: Runs, results: Iterable[Result]) -> None:
        """Write the results of runs of a group as they come; ValueError if a number is not
        finite."""
        from fpm.files import trajectory

        for result in results:
            contents = trajectory.contents(result.outcome, attributes=result.attributes)
            trajectory.write(contents, self.folder / f"{result.id}.nc")

    def read(self, group: Runs) -> dict[str, Record]:
        """Those runs of a group that are there, by id."""
        found = {}
        for run in group:
            if (curves := self._curves(run)) is not None:
                values = np.stack([r.evaluate(curves) for r in self.responses])
                numbers = numbers_of(self.quantities, curves)
                events, contacts = curves.impacts()
                overlap = largest_overlap(curves.openings, contacts)
                found[run.id] = Record(curves.time, values, events, contacts, numbers, overlap)
        return found

    def _curves(self, run: Run) -> Any:
        """The run's `fpm.trajectory.Curves`; None if its file is not there, not whole, or lacks
        what responses need."""
        from fpm.files import trajectory
        from fpm.reading.variables import VARIABLES

        try:
            curves = trajectory.read_curves(self.path(run), run.id)
            lacks = self._needs - set(curves.columns)
            if not lacks:
                return curves
            had = {column for column in curves.columns if column[0] in VARIABLES}
            self.lacking[run.id], self._had[run.id] = lacks, had
        except DamagedError as error:
            self.damaged[error.path] = error
        except FileNotFoundError:
            pass
        return None


class Responses:
    """One netCDF file per group, with the responses only, in single precision."""

    def __init__(self, folder: Path, experiment: Experiment):
        self.folder = folder
        self.responses, self.quantities = experiment.curves, experiment.numbers
        self.damaged: dict[Path, DamagedError] = {}
        self.lacking: dict[str, set[Column]] = {}
        self._named = partial(group_digest, asked_of(self.responses, self.quantities), experiment)

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """Runs that are written together."""
        return groups_of(runs, size)

    def path(self, group: Runs) -> Path:
        """Other runs or responses, or another way to read responses, have another file."""
        return self.folder / f"{self._named(group)}.nc"

    def missing(self, group: Runs) -> Runs:
        """The runs of the group that are still to be simulated: all of them, or none.

        A group in which a run had failed is simulated again as a whole.
        """
        import netCDF4

        path = self.path(group)
        try:
            check(path, _name(path))
        except DamagedError as error:
            self.damaged[path] = error
            return group
        except FileNotFoundError:
            return group
        with netCDF4.Dataset(path) as file:
            there = list(file["run_id"][:])
        return group[:0] if there == [run.id for run in group] else group

    def had(self, runs: Runs) -> set[Column]:
        """Nothing: files hold the responses only."""
        return set()

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """A function that tells how many runs of groups are there, by the names of files alone."""
        sizes = {self.path(group).name: len(group) for group in groups}
        return lambda: sum(sizes.get(name, 0) for name in listed(self.folder))

    def write(self, group: Runs, results: Iterable[Result]) -> None:
        """Write the results of runs of a group; ValueError if a number is not finite."""
        import netCDF4

        results = list(results)
        if not results:
            return
        first = results[0].outcome
        found = [result.outcome.impacts() for result in results]
        events, contacts = padded([each.events for each in found]), found[0].names
        path = self.path(group)
        with (
            whole_file(path, {"name": _name(path)}) as temporary,
            netCDF4.Dataset(temporary, "w", format="NETCDF4") as file,
        ):
            file.createDimension("run", len(results))
            file.createDimension("time", len(first.time))
            file.createDimension("event", max(1, events.shape[1]))
            file.createVariable("time", "f8", ("time",))[:] = first.time
            write_dimension(file, "contact", contacts, "name of the contact, stop or latch")
            names = [response.name for response in self.responses]
            write_dimension(file, "response", names, "name of the response")
            ids = np.array([result.id for result in results], dtype=object)
            file.createVariable("run_id", str, ("run",))[:] = ids
            # Not compressed: it would save a third, and take half of the time of writing.
            variable = file.createVariable("values", "f4", ("run", "response", "time"))
            for i, response in enumerate(self.responses):
                values = np.stack([response.evaluate(result.outcome) for result in results])
                if not np.isfinite(values).all():
                    raise ValueError(f"{response.name} has values that are not finite")
                variable[:, i] = values
            overlaps = [largest_overlap(r.outcome.openings, contacts) for r in results]
            file.createVariable("overlap", "f8", ("run",))[:] = overlaps
            for column, name in enumerate(EVENT_VARIABLES):
                variable = file.createVariable(name, "f8", ("run", "event"), fill_value=np.nan)
                variable[:, : events.shape[1]] = events[..., column]
            if self.quantities:
                write_dimension(file, "quantity", [q.name for q in self.quantities], "quantity")
                numbers = [numbers_of(self.quantities, r.outcome) for r in results]
                file.createVariable("quantities", "f8", ("run", "quantity"))[:] = numbers

    def read(self, group: Runs) -> dict[str, Record]:
        """Those runs of a group that are there, by id."""
        import netCDF4

        if self.missing(group):
            return {}
        with netCDF4.Dataset(self.path(group)) as file:
            file.set_auto_mask(False)
            time, contacts = file["time"][:], list(file["contact"][:])
            values, overlaps = file["values"][:], file["overlap"][:]
            events = np.stack([file[name][:] for name in EVENT_VARIABLES], axis=-1)
            none = np.zeros((len(group), 0))
            numbers = file["quantities"][:] if self.quantities else none
        return {
            run.id: Record(
                time,
                values[row],
                events[row][np.isfinite(events[row, :, 0])],
                contacts,
                numbers[row],
                float(overlaps[row]),
            )
            for row, run in enumerate(group)
        }


def _name(path: Path) -> str:
    """What the file of a group is called in its seal."""
    return f"runs {path.stem}"


STORES = {"trajectories": Trajectories, "responses": Responses, "extremes": Extremes}
