"""`keep: extremes`: of a scan the least and largest values over time, and a few numbers a run.

A chunk of the scan has one netCDF file, `<digest of its runs>.<runs in it>.nc`, which grows while
its runs are made. There are as many chunks as the scan's size asks for, whatever the jobs, and the
quarters of the scan consist of whole chunks. In the file, of the runs that are `done`: extremes,
with the runs (counted in the chunk) that have them; curves of the `first` one; quantities with
event margins, and impacts, padded with NaN, -1, -1; the largest overlap of contacts (rad)."""

import time
from collections.abc import Callable, Iterable, Sequence
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import report_damage, whole_file
from deployable.campaign.plan.plan import Runs
from deployable.campaign.runs import results as common
from deployable.intervals.samples import RunBounds

FEWEST, MOST = 4, 128  # chunks of a scan; quarters consist of whole ones
LARGE = 512  # runs of a chunk from which there are more chunks, as long as there are not `MOST`
PAUSE = 2.0  # seconds, at least, from one time that a chunk is written to the next, but for its end

_LOT = 32  # runs that are taken in side by side

CURVES = {"lower": "f8", "upper": "f8", "lower_run": "i4", "upper_run": "i4"}
"""Tables (response, time) of a chunk, in the order of `RunBounds`, and their kinds."""

EVENTS = {"event_time": ("f4", np.nan), "event_contact": ("i2", -1), "event_closing": ("i1", -1)}
"""Kind and filling of the tables of impacts (run, event)."""


class ScanChunk:
    """What is kept of `count` runs, a chunk of a scan. `mask` (count): which runs are included yet;
    `bounds`: their extremes (`RunBounds`); `numbers` (count, 2, q): quantities and event margins;
    `events`: tables (count, events) of contacts by name; `first` (n, T): responses of the first
    run; `time` (T): s; `overlap`: largest of contacts (rad)."""

    def __init__(self, count: int, responses: Sequence[Any], quantities: Sequence[Any]):
        self.responses, self.quantities = responses, quantities
        self.mask = np.zeros(count, bool)
        self.numbers = np.full((count, 2, len(quantities)), np.nan)
        self.events = {n: np.full((count, 1), fill, kind) for n, (kind, fill) in EVENTS.items()}
        self.overlap = 0.0
        self.bounds: Any = None
        self.time = self.first = np.zeros(0)
        self.contacts: list[str] = []

    def take(self, rows: Sequence[int], results: Sequence[common.Result]) -> None:
        """Include the results of runs in the chunk. rows: their indices in the chunk, increasing;
        results: one each. Raises ValueError if a response is not finite."""
        outcomes = [result.outcome for result in results]
        values = common.values_of(self.responses, outcomes)
        self.bounds = RunBounds.from_runs(values, np.array(rows, np.int32)).merge(self.bounds)
        if not self.mask.any():
            self.time, self.first = outcomes[0].time, np.zeros_like(values[0])
        if rows[0] == 0:
            self.first = values[0]
        for row, outcome in zip(rows, outcomes, strict=True):
            events, self.contacts = outcome.impacts()
            padding = (0, 0), (0, max(0, len(events) - self.events["event_time"].shape[1]))
            for column, (name, (_, fill)) in enumerate(EVENTS.items()):
                self.events[name] = np.pad(self.events[name], padding, constant_values=fill)
                self.events[name][row, : len(events)] = events[:, column]
            overlap = common.largest_overlap(outcome.openings, self.contacts)
            self.overlap = max(self.overlap, overlap)
            self.numbers[row] = common.numbers_of(self.quantities, outcome)
            self.mask[row] = True

    def write(self, path: Path) -> None:
        """Write the chunk to the netCDF file `path`, without a seal (checksum)."""
        options = {"zlib": True, "complevel": 1, "shuffle": True}
        events, curves, bounds = ("run", "event"), ("response", "time"), self.bounds
        tables = bounds.low, bounds.high, bounds.low_run, bounds.high_run
        variables = {
            "time": ("f8", ("time",), self.time, {}),
            "first": ("f8", curves, self.first, options),
            "overlap": ("f8", (), self.overlap, {}),
            "done": ("i1", ("run",), self.mask, options),
            **{name: (kind, curves, table, options)
               for (name, kind), table in zip(CURVES.items(), tables, strict=True)},
            **{name: (kind, events, self.events[name], {"fill_value": fill, **options})
               for name, (kind, fill) in EVENTS.items()},
        }  # fmt: skip
        if self.quantities:
            variables["quantities"] = "f8", ("run", "pair", "quantity"), self.numbers, options
        common.write_netcdf(path, {"contact": self.contacts, **common.names_of(self)}, variables)

    @classmethod
    def read(cls, path: Path, responses: Sequence[Any], quantities: Sequence[Any]) -> "ScanChunk":
        """Read a chunk from the netCDF file `path`. responses, quantities: those of the experiment,
        by which further results are evaluated. Raises `DamagedError` for malformed content."""
        import netCDF4

        with report_damage(path), netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            chunk = cls(len(file.dimensions["run"]), responses, quantities)
            chunk.mask = file["done"][:].astype(bool)
            chunk.time, chunk.first = file["time"][:], file["first"][:]
            chunk.bounds = RunBounds(*(file[name][:] for name in CURVES))
            chunk.contacts = list(file["contact"][:])
            chunk.overlap = float(file["overlap"][:])
            chunk.events = {name: file[name][:] for name in EVENTS}
            if quantities:
                chunk.numbers = file["quantities"][:]
        return chunk


class ScanExtremes(common.Store):
    """Store of the runs of a scan for `jobs.keep: extremes`, in at most 128 chunks (`ScanChunk`), a
    file each."""

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """Divide the runs of a scan, in order, into 4 to 128 chunks, a file each; size: unused."""
        count = FEWEST
        while count < MOST and len(runs) > count * LARGE:
            count *= 2
        ends = [-(-len(runs) * chunk // count) for chunk in range(count + 1)]
        return [runs[a:b] for a, b in pairwise(ends) if b > a]

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """Return a function that counts the stored runs of these chunks, by file names alone."""
        names = {self.file_of(group) for group in groups}

        def count() -> int:
            counts: dict[str, int] = {}
            for path in self.folder.glob("*.nc"):
                name = path.name.split(".")[0]
                if name in names:
                    counts[name] = max(_runs_in(path), counts.get(name, 0))
            return sum(counts.values())

        return count

    def missing(self, group: Runs) -> Runs:
        """Return the runs of a chunk (`group`) that are not stored yet, to be simulated."""
        chunk = self.read(group)
        return self.sound(group if chunk is None else group[np.flatnonzero(~chunk.mask)])

    def write(self, group: Runs, results: Iterable[common.Result]) -> None:
        """Add results, in the order of the chunk's runs (`group`), to the stored chunk, written
        at most every two seconds and at the end. ValueError if a response is not finite."""
        chunk = self.read(group) or ScanChunk(len(group), self.responses, self.quantities)
        rows = {values: row for row, values in enumerate(map(tuple, group.values.tolist()))}
        results, write_time = iter(results), time.monotonic()
        while lot := list(islice(results, _LOT)):
            chunk.take([rows[result.run.values] for result in lot], lot)
            if time.monotonic() > write_time + PAUSE:
                self._save(group, chunk)
                write_time = time.monotonic()
        if chunk.mask.any():
            self._save(group, chunk)

    def read(self, group: Runs) -> "ScanChunk | None":
        """Read what is stored of a chunk (`group`), from its undamaged file with most runs; None
        without one."""
        files = self.folder.glob(f"{self.file_of(group)}.*.nc")
        paths = sorted(files, key=_runs_in, reverse=True)
        path = next(filter(self.is_whole, paths), None)  # a file may be replaced meanwhile
        if path is None:
            return None
        return ScanChunk.read(path, self.responses, self.quantities)

    def _save(self, group: Runs, chunk: "ScanChunk") -> None:
        name = self.file_of(group)
        path = self.folder / f"{name}.{chunk.mask.sum()}.nc"
        with whole_file(path, {"name": common.title(path)}) as temporary:
            chunk.write(temporary)
        for stale_path in {*self.folder.glob(f"{name}.*.nc")} - {path}:
            stale_path.unlink(missing_ok=True)


def _runs_in(path: Path) -> int:
    """Return how many runs the file of a chunk has, by its name."""
    return int(path.stem.rsplit(".", 1)[1])
