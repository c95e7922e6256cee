"""`keep: extremes`: of a scan the least and largest values over time, and a few numbers a run.

A share of the scan has one netCDF file, `<digest of its runs>.<runs in it>.nc`, which grows while
its runs are made. There are as many shares as the scan's size asks for, whatever the jobs, and the
quarters of the scan consist of whole shares. In the file:

    dims   run, response, time, quantity, event, contact
    done(run)                               1 where a run is among those below
    lower, upper (response, time)           least and largest value of those runs
    lower_run, upper_run (response, time)   which run that is, counted in the share
    first(response, time)                   the curves of the first run of the share
    quantities(run, quantity)               NaN where what is asked for does not happen
    event_time, event_contact, event_closing (run, event)   impacts, the times in single precision,
                                            padded with NaN, -1, -1
    overlap                                 largest overlap of the faces of a contact, rad
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import whole_file
from deployable.campaign.files.contents import reading
from deployable.campaign.plan.runs import Runs
from deployable.campaign.runs import results as common
from deployable.intervals.samples import Running
from fpm.files.sealed import DamagedError

FEWEST, MOST = 4, 128
"""Shares of a scan; quarters consist of whole ones."""

LARGE = 512
"""Runs of a share from which there are more shares, as long as there are not `MOST`."""

PAUSE = 2.0
"""Seconds, at least, from one time that a share is written to the next, but for its end."""

_AT_ONCE = 32  # runs that are taken in side by side

CURVES = {"lower": "f8", "upper": "f8", "lower_run": "i4", "upper_run": "i4"}
"""Tables (response, time) of a share, in the order of `Running`, and their kinds."""

EVENTS = {"event_time": ("f4", np.nan), "event_contact": ("i2", -1), "event_closing": ("i1", -1)}
"""Kind and filling of the tables of impacts (run, event)."""


class Share:
    """What is kept of `count` runs, of which `done` (count) tells those that are in."""

    def __init__(self, count: int, responses: Sequence[Any], quantities: Sequence[Any]):
        self.responses, self.quantities = responses, quantities
        self.done = np.zeros(count, bool)
        self.numbers = np.full((count, len(quantities)), np.nan)
        self.events = {n: np.full((count, 1), fill, kind) for n, (kind, fill) in EVENTS.items()}
        self.overlap = 0.0
        self.running: Running | None = None
        self.time = self.first = np.zeros(0)
        self.contacts: list[str] = []

    def take(self, rows: Sequence[int], results: Sequence[common.Result]) -> None:
        """Take in results; rows: their places in the share, which increase.

        ValueError if a number is not finite.
        """
        outcomes = [result.outcome for result in results]
        values = common.values_of(self.responses, outcomes)
        self.running = Running.of_runs(values, np.array(rows, np.int32)).merge(self.running)
        if not self.done.any():
            self.time, self.first = outcomes[0].time, np.zeros_like(values[0])
        if rows[0] == 0:
            self.first = values[0]
        for row, outcome in zip(rows, outcomes, strict=True):
            events, self.contacts = outcome.impacts()
            self._note(row, events)
            overlap = common.largest_overlap(outcome.openings, self.contacts)
            self.overlap = max(self.overlap, overlap)
            self.numbers[row] = common.numbers_of(self.quantities, outcome)
            self.done[row] = True

    def _note(self, row: int, events: np.ndarray) -> None:
        """Note the impacts (e, 3) of a run."""
        short = max(0, len(events) - self.events["event_time"].shape[1])
        for column, (name, (_, fill)) in enumerate(EVENTS.items()):
            grown = ((0, 0), (0, short))
            self.events[name] = np.pad(self.events[name], grown, constant_values=fill)
            self.events[name][row, : len(events)] = events[:, column]

    def write(self, path: Path) -> None:
        """Write the netCDF file."""
        packed = {"zlib": True, "complevel": 1, "shuffle": True}
        across, curves = ("run", "event"), ("response", "time")
        variables = {
            "time": ("f8", ("time",), self.time, {}),
            "first": ("f8", curves, self.first, packed),
            "overlap": ("f8", (), self.overlap, {}),
            "done": ("i1", ("run",), self.done, packed),
        }
        if self.quantities:
            variables["quantities"] = "f8", ("run", "quantity"), self.numbers, packed
        run = self.running
        found = run.low, run.high, run.low_run, run.high_run
        for (name, kind), values in zip(CURVES.items(), found, strict=True):
            variables[name] = kind, curves, values, packed
        for name, (kind, fill) in EVENTS.items():
            variables[name] = kind, across, self.events[name], {"fill_value": fill, **packed}
        common.write_netcdf(path, {"contact": self.contacts, **common.names_of(self)}, variables)

    @classmethod
    def read(cls, path: Path, responses: Sequence[Any], quantities: Sequence[Any]) -> Share:
        """The share in a netCDF file."""
        import netCDF4

        with reading(path), netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            share = cls(len(file.dimensions["run"]), responses, quantities)
            share.done = file["done"][:].astype(bool)
            share.time, share.first = file["time"][:], file["first"][:]
            share.running = Running(*(file[name][:] for name in CURVES))
            share.contacts = list(file["contact"][:])
            share.overlap = float(file["overlap"][:])
            share.events = {name: file[name][:] for name in EVENTS}
            if quantities:
                share.numbers = file["quantities"][:]
        return share


class Extremes(common.Store):
    """One netCDF file per share of a scan."""

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """The shares of a scan; they do not depend on the size of groups."""
        count = FEWEST
        while count < MOST and len(runs) > count * LARGE:
            count *= 2
        ends = [-(-len(runs) * share // count) for share in range(count + 1)]
        return [runs[a:b] for a, b in pairwise(ends) if b > a]

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        names = {self.file_of(group) for group in groups}

        def count() -> int:
            done: dict[str, int] = {}
            for path in self.folder.glob("*.nc"):
                share = path.name.split(".")[0]
                if share in names:
                    done[share] = max(_runs_in(path), done.get(share, 0))
            return sum(done.values())

        return count

    def missing(self, group: Runs) -> Runs:
        """The runs of the share that are still to be simulated."""
        found = self.read(group)
        return group if found is None else group[np.flatnonzero(~found.done)]

    def write(self, group: Runs, results: Iterable[common.Result]) -> None:
        """Take in the results of runs of a share as they come, in the order of its runs.

        It is written whenever `PAUSE` has passed, and at the end; ValueError if a number is not
        finite.
        """
        share = self.read(group) or Share(len(group), self.responses, self.quantities)
        rows = {values: row for row, values in enumerate(map(tuple, group.values.tolist()))}
        results, written = iter(results), time.monotonic()
        while some := list(islice(results, _AT_ONCE)):
            share.take([rows[result.run.values] for result in some], some)
            if time.monotonic() > written + PAUSE:
                self._save(group, share)
                written = time.monotonic()
        if share.done.any():
            self._save(group, share)

    def read(self, group: Runs) -> Share | None:
        """What is there of a share: of several files the one with most runs that is whole."""
        paths = sorted(self._files(group), key=_runs_in, reverse=True)
        path = next(filter(self.is_whole, paths), None)  # a file may be replaced meanwhile
        share = path and Share.read(path, self.responses, self.quantities)
        shape = len(group), len(self.responses), self.experiment.solver.instants
        if share and (len(share.done), *share.first.shape) != shape:
            raise DamagedError(path, "it has other runs, responses or instants than the campaign")
        return share

    def _files(self, group: Runs) -> list[Path]:
        return list(self.folder.glob(f"{self.file_of(group)}.*.nc"))

    def _save(self, group: Runs, share: Share) -> None:
        path = self.folder / f"{self.file_of(group)}.{share.done.sum()}.nc"
        with whole_file(path, {"name": common.title(path)}) as temporary:
            share.write(temporary)
        for other in self._files(group):
            if other != path:
                other.unlink(missing_ok=True)


def _runs_in(path: Path) -> int:
    """How many runs the file of a share has, by its name."""
    return int(path.stem.rsplit(".", 1)[1])
