"""A share of a scan's runs: their least and largest values over time, and a few numbers a run.

In its netCDF file:

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

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.runs import results as common
from deployable.intervals.running import Running

CURVES = ("lower", "upper", "lower_run", "upper_run")
EVENTS = {"event_time": ("f4", np.nan), "event_contact": ("i2", -1), "event_closing": ("i1", -1)}
"""Kind and filling of the tables of impacts (run, event)."""

_PACKED = {"zlib": True, "complevel": 1, "shuffle": True}


class Share:
    """What is kept of `count` runs, of which `done` (count) tells those that are in."""

    def __init__(self, count: int, responses: Sequence[Any], quantities: Sequence[Any]):
        self.responses, self.quantities = responses, quantities
        self.done = np.zeros(count, bool)
        self.numbers = np.full((count, len(quantities)), np.nan)
        self.events = {n: np.full((count, 0), fill, kind) for n, (kind, fill) in EVENTS.items()}
        self.overlap = 0.0
        self.running: Running | None = None
        self.time = self.first = np.zeros(0)
        self.contacts: list[str] = []

    def take(self, rows: Sequence[int], results: Sequence[common.Result]) -> None:
        """Take in results; rows: their places in the share, which increase.

        ValueError if a number is not finite.
        """
        outcomes = [result.outcome for result in results]
        values = np.array([[r.evaluate(outcome) for r in self.responses] for outcome in outcomes])
        if not np.isfinite(values).all():
            raise ValueError("responses have values that are not finite")
        self.running = Running.of(values, np.array(rows, np.int32)).merged(self.running)
        if not self.done.any():
            self.time, self.first = outcomes[0].time, np.zeros_like(values[0])
        if rows[0] == 0:
            self.first = values[0]
        for row, outcome in zip(rows, outcomes, strict=True):
            found = outcome.impacts()
            self.contacts = found.names
            self._note(row, found.events)
            self.overlap = max(
                self.overlap, common.largest_overlap(outcome.openings, self.contacts)
            )
            if self.quantities:
                self.numbers[row] = common.numbers_of(self.quantities, outcome)
            self.done[row] = True

    def _note(self, row: int, events: np.ndarray) -> None:
        """Note the impacts (e, 3) of a run."""
        short = len(events) - self.events["event_time"].shape[1]
        for column, (name, (_, fill)) in enumerate(EVENTS.items()):
            if short > 0:
                grown = ((0, 0), (0, short))
                self.events[name] = np.pad(self.events[name], grown, constant_values=fill)
            self.events[name][row, : len(events)] = events[:, column]

    def write(self, path: Path) -> None:
        """Write the netCDF file."""
        import netCDF4

        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            sizes = {"run": len(self.done), "time": len(self.time)}
            sizes["event"] = max(1, self.events["event_time"].shape[1])
            for name, size in sizes.items():
                file.createDimension(name, size)
            file.createVariable("time", "f8", ("time",))[:] = self.time
            for name, names in (
                ("response", [r.name for r in self.responses]),
                ("quantity", [q.name for q in self.quantities]),
                ("contact", self.contacts),
            ):
                common.write_dimension(file, name, names, f"name of the {name}")
            curves, running = ("response", "time"), self.running
            found = (running.low, running.high, running.low_run, running.high_run, self.first)
            for name, values in zip((*CURVES, "first"), found, strict=True):
                kind = "i4" if name.endswith("run") else "f8"
                file.createVariable(name, kind, curves, **_PACKED)[:] = values
            file.createVariable("overlap", "f8", ())[:] = self.overlap
            file.createVariable("done", "i1", ("run",), **_PACKED)[:] = self.done
            for name, values in self.events.items():
                kind, fill = EVENTS[name]
                variable = file.createVariable(
                    name, kind, ("run", "event"), fill_value=fill, **_PACKED
                )
                variable[:, : values.shape[1]] = values
            if self.quantities:
                across = ("run", "quantity")
                file.createVariable("quantities", "f8", across, **_PACKED)[:] = self.numbers

    @classmethod
    def read(cls, path: Path, responses: Sequence[Any], quantities: Sequence[Any]) -> Share:
        """The share in a netCDF file."""
        import netCDF4

        with netCDF4.Dataset(path) as file:
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
