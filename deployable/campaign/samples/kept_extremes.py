"""Gather what `keep: extremes` left of all runs into `samples.nc`: in the place of curves the
extremes in each quarter of the runs, with the first run that has each, -1 in a quarter without
runs. There is no role and no name of a run: the first is the nominal one, and the name follows from
the values (`campaign.plan.runs.run_id`). `files/variables.json` says more (`extremes`)."""

from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Jobs
from deployable.campaign.files import create, result_file
from deployable.campaign.plan.plan import Plan
from deployable.campaign.runs.batch import check_failures, make_again
from deployable.campaign.runs.extremes import CURVES, EVENTS, ScanChunk
from deployable.campaign.runs.progress import Notify
from deployable.campaign.runs.results import complete_numbers
from deployable.campaign.runs.store import open_store
from deployable.campaign.samples import samples
from deployable.intervals.samples import RunBounds, quarter_ends

_CHUNK_RUNS = 4096
_FILE = "extremes"


def gather(
    plan: Plan, jobs: Jobs, folder: str | Path, path: str | Path, notify: Notify = lambda text: None
) -> None:
    """Write `samples.nc` to `path` from the chunks of a scan, one at a time; missing or damaged
    ones are made again, failed runs listed apart. Raises `CampaignError` if too many failed."""
    import netCDF4

    store, unique = open_store("extremes", folder, plan.experiment), plan.unique_runs
    failures = store.list_failures(unique)
    check_failures(plan, failures, len(unique))
    runs = store.sound(unique)
    quarters: list[RunBounds | None] = [None] * 4
    ends, first, place = quarter_ends(len(unique)), 0, 0
    with (
        result_file(path, plan=plan.digest) as temporary,
        netCDF4.Dataset(temporary, "w", format="NETCDF4") as file,
    ):
        samples.write_box(file, plan)
        samples.write_failures(file, failures)
        file.createDimension("run", len(runs))
        samples.write_points(file, runs, **_compression(len(runs), len(plan.experiment.intervals)))
        for group in store.groups(unique, jobs.group):
            chunk = store.read(group)
            if len(store.sound(group)) > (0 if chunk is None else chunk.mask.sum()):
                make_again(plan, store, group, jobs.group, notify)
                chunk = store.read(group)
            quarter = next(i for i in range(4) if place < ends[i + 1])
            place += len(group)
            if chunk is None:  # all of its runs failed
                continue
            if first == 0:
                _define(file, chunk, store, len(runs))
            _write(file, chunk, first, store)
            bounds = chunk.bounds
            places = np.cumsum(chunk.mask) - 1 + first  # among the runs that did not fail
            rows = places[bounds.low_run], places[bounds.high_run]
            quarters[quarter] = RunBounds(bounds.low, bounds.high, *rows).merge(quarters[quarter])
            file["overlap"][:] = max(float(file["overlap"][:]), chunk.overlap)
            first += int(chunk.mask.sum())
        _write_quarters(file, quarters)
    if len(store.list_failures(unique)) > len(failures):  # of runs that were made again
        gather(plan, jobs, folder, path, notify)


def _compression(runs: int, columns: int) -> dict:
    """Return the compression of a table of the runs."""
    chunk = (min(_CHUNK_RUNS, runs), max(1, columns))
    return {"zlib": True, "complevel": 1, "shuffle": True, "chunksizes": chunk}


def _define(file: Any, chunk: ScanChunk, store: Any, runs: int) -> None:
    """Define time, curves and tables of runs as the first chunk has them."""
    samples.write_time(file, chunk.time, chunk.contacts)
    samples.write_names(file, "response", store.responses)
    file.createDimension("quarter", 4)
    file.createDimension("event", None)
    create(file, _FILE, "nominal", chunk.first)
    create(file, _FILE, "overlap", 0.0)
    for name, (kind, fill) in EVENTS.items():
        create(file, _FILE, name, kind=kind, fill_value=fill, **_compression(runs, 8))
    if quantities := store.experiment.quantity_list:
        samples.write_names(file, "quantity", quantities)
        for name in ("quantities", "margin"):
            create(file, _FILE, name, **_compression(runs, len(quantities)))


def _write(file: Any, chunk: ScanChunk, first: int, store: Any) -> None:
    """Write the tables of the runs of a chunk, the first of which has the number `first`."""
    rows = slice(first, first + int(chunk.mask.sum()))
    for name, values in chunk.events.items():
        file[name][rows, : values.shape[1]] = values[chunk.mask]
    if store.quantities:
        table = complete_numbers(store.experiment, chunk.numbers[chunk.mask])
        file["quantities"][rows], file["margin"][rows] = table[:, 0], table[:, 1]


def _write_quarters(file: Any, quarters: list[RunBounds | None]) -> None:
    for name, key in zip(CURVES, ("low", "high", "low_run", "high_run"), strict=True):
        kind, fill = ("i4", -1) if name.endswith("run") else ("f8", 0.0)
        variable = create(file, _FILE, name, kind=kind, zlib=True, complevel=1)
        for i, quarter in enumerate(quarters):
            empty = np.full(variable.shape[1:], fill)
            variable[i] = empty if quarter is None else getattr(quarter, key)
