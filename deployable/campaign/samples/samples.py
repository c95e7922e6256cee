"""Gather the responses of all runs of a plan into one file, `samples.nc`.

    dims   run, response, time, parameter, event
    values(run, response, time)   in the units response_units(response)
    response, response_units, response_long_name (response)
    response_along(response)      over what it lies instead of time; only where some do
    response_least(response)      the least value that it can have, NaN where there is none
    response_floor, response_ceiling(response)  of openings: at a stop or latch
    normalized(run, parameter)    coordinates in the box, -1 to 1
    value(run, parameter)         parameter values, in the units box_units(parameter)
    parameter_<name>(run)         the same by name, with units
    box_lower, box_upper, box_nominal (parameter)
    role(run)                     node, nominal or held_out
    run_id(run)
    overlap(run)                  largest overlap of the faces of a contact, rad
    event_time, event_contact, event_closing (run, event)   impacts, padded with NaN
    margin(run, quantity)         by how much a run has it, above 0 if it does, NaN if not known
    quantities(run, quantity)     in the units quantity_units(quantity), NaN where what is asked for
                                  does not happen; only in campaigns that have quantities
    quantity, quantity_units, quantity_long_name (quantity)

With `keep: extremes` (`campaign.samples.kept_extremes`) there are no values, and the variables of
runs are as small as can be.

No variable is named after a response, so that a response may have any name. This file is all that
the interval side needs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Jobs, plain_data
from deployable.campaign.files import result_file
from deployable.campaign.plan.plan import Plan
from deployable.campaign.plan.runs import Runs
from deployable.campaign.provenance import as_attribute
from deployable.campaign.runs.batch import make_again
from deployable.campaign.runs.progress import Notify
from deployable.campaign.runs.results import EVENT_VARIABLES, RunRecord, pad_events, write_dimension
from deployable.campaign.runs.store import open_store
from fpm.files.trajectory import CONVENTIONS

ATTRIBUTES = {
    name: {"units": units, "long_name": long_name}
    for name, units, long_name in (
        ("overlap", "rad", "largest overlap of the faces of a contact, at the recorded instants"),
        ("event_time", "s", "time at which a contact, stop or latch closes or opens"),
        ("event_contact", "1", "index of the contact, stop or latch"),
        ("event_closing", "1", "1 where the contact, stop or latch closes, 0 where it opens"),
        ("quantities", "", "value of the quantity, missing where the quantity does not exist"),
        ("margin", "", "event margin: positive if the quantity exists, missing if not known"),
    )
}
"""Of variables of runs."""


def gather(
    plan: Plan, jobs: Jobs, folder: str | Path, path: str | Path, notify: Notify = lambda text: None
) -> None:
    """Write the responses and quantities of all runs of a plan, from their store, to `path`
    (`samples.nc`). jobs: section of the config; folder: of the store; notify: called with each
    message. One group of runs at a time is in memory. Missing or damaged runs are simulated again;
    raises `CampaignError` if runs fail."""
    import netCDF4

    store = open_store(jobs.keep, folder, plan.experiment)
    groups = store.groups(plan.unique_runs(), jobs.group)
    rows: dict[str, list[int]] = {}
    for row, run in enumerate(plan.runs):
        rows.setdefault(run.id, []).append(row)
    with (
        result_file(path, plan=plan.digest) as temporary,
        netCDF4.Dataset(temporary, "w", format="NETCDF4") as file,
    ):
        _write_runs(file, plan)
        write_names(file, "response", store.responses)
        if quantities := plan.experiment.quantity_list:
            write_names(file, "quantity", quantities)
            blanks = np.full((len(plan.runs), len(quantities)), np.nan)
            for name in ("quantities", "margin"):
                text = ATTRIBUTES[name]["long_name"]
                _numbers(file, name, ("run", "quantity"), blanks, text)
        for group in groups:
            records = store.read(group)
            if len(records) < len(group):
                make_again(plan, store, group, jobs.group, notify)
                records = store.read(group)
            if "time" not in file.variables:
                _define_curves(file, next(iter(records.values())), plan.experiment.intervals)
            pairs = sorted((row, id_) for id_ in records for row in rows[id_])
            _write_rows(file, [row for row, _ in pairs], [records[id_] for _, id_ in pairs])


def _write_runs(file: Any, plan: Plan) -> None:
    """Define the dimensions and write what is known of the runs before they are simulated."""
    runs, units = plan.runs, write_box(file, plan)
    file.createDimension("run", len(runs))
    file.createDimension("event", None)
    _text(file, "role", "run", [run.role for run in runs], "what the run is for")
    _text(file, "run_id", "run", [run.id for run in runs], "id of the run")
    write_points(file, runs)
    for name, column, unit in zip(plan.experiment.intervals, runs.values.T, units, strict=True):
        _numbers(file, f"parameter_{name}", ("run",), column, f"value of {name}", units=unit)


def write_points(file: Any, runs: Runs, **compression: Any) -> None:
    """Write the points of runs in the box, as variables `normalized` (-1 to 1) and `value` (in the
    parameters' units), each (run, parameter), into an open `netCDF4.Dataset`, whose dimensions
    exist. compression: options of `createVariable`."""
    dims = ("run", "parameter")
    text = "coordinates in the box, -1 to 1"
    _numbers(file, "normalized", dims, runs.normalized, text, compression, units="1")
    _numbers(file, "value", dims, runs.values, "parameter values in their units", compression)


def write_box(file: Any, plan: Plan) -> list[str]:
    """Write the parameter box of a plan, and the attributes of a samples file, into an open
    `netCDF4.Dataset`; returns the units of the interval parameters, in order."""
    experiment = plan.experiment
    names, parameters = list(experiment.intervals), experiment.scene_type.parameters
    units = [parameters[name].unit for name in names]
    write_dimension(file, "parameter", names, "interval parameter")
    _text(file, "box_units", "parameter", units, "units of the parameter")
    for key in ("lower", "upper", "nominal"):
        ends = [getattr(interval, key) for interval in experiment.intervals.values()]
        _numbers(file, f"box_{key}", ("parameter",), ends, f"{key} value of the parameter")
    file.setncatts(
        {
            "Conventions": CONVENTIONS,
            "title": f"Responses of all runs of the campaign {experiment.name}",
            "source": "finite particle method",
            "history": f"deployable gather: {len(plan.unique_runs())} runs of fpm",
            "campaign": experiment.name,
            "scene": experiment.scene.name,
            "config_hash": plan.config_hash,
            "config": json.dumps(plain_data(experiment)),
            "time_step": plan.time.step,
            "time_step_limit": plan.time.step_limit,
            "limiting_element": plan.time.limiting_element,
            "assembly_energy": plan.time.assembly_energy,
            "mechanics": plan.mechanics,
            "provenance": as_attribute(),
        }
    )
    return units


def _define_curves(file: Any, record: RunRecord, parameters: Iterable[str]) -> None:
    """Define time, values and events as the first run has them."""
    write_time(file, record.time, record.contacts)
    # Not compressed: it would save a third at most, and take half of the time of gathering.
    kind = record.values.dtype.newbyteorder("=")
    variable = file.createVariable("values", kind, ("run", "response", "time"))
    variables = [f"parameter_{name}" for name in parameters]
    variables += ["role", "run_id", "response_units", "response_long_name"]
    variable.setncatts({"long_name": "value of the response", "coordinates": " ".join(variables)})
    variable = file.createVariable("overlap", "f8", ("run",))
    variable.setncatts(ATTRIBUTES["overlap"])
    for name in EVENT_VARIABLES:
        variable = file.createVariable(name, "f8", ("run", "event"), fill_value=np.nan)
        variable.setncatts(ATTRIBUTES[name])


def write_time(file: Any, instants: np.ndarray, contacts: Sequence[str]) -> None:
    """Write the instants (T) (s), and the names of contacts, stops and latches, as coordinates
    `time` and `contact` into an open `netCDF4.Dataset`."""
    file.createDimension("time", len(instants))
    time = file.createVariable("time", "f8", ("time",))
    time[:] = instants
    variables = {"long_name": "time", "standard_name": "time", "axis": "T"}
    time.setncatts({"units": "s", **variables})
    write_dimension(file, "contact", contacts, "name of the contact, stop or latch")


def write_names(file: Any, dimension: str, items: Sequence[Any]) -> None:
    """Write names, units and long names of responses or quantities into an open `netCDF4.Dataset`;
    of responses their axes and physical lower bounds, too. dimension: "response" or "quantity";
    items: `Response` or `Quantity` objects."""
    write_dimension(file, dimension, [item.name for item in items], f"name of the {dimension}")
    for key, values in (
        ("units", [item.unit for item in items]),
        ("long_name", [item.long_name for item in items]),
    ):
        text = f"{key.replace('_', ' ')} of the {dimension}"
        _text(file, f"{dimension}_{key}", dimension, values, text)
    if dimension == "response":
        if any(item.along for item in items):
            abscissas = [json.dumps(item.along and item.along._asdict()) for item in items]
            text = "over what the response lies instead of time, evenly, as JSON; null: over time"
            _text(file, "response_along", dimension, abscissas, text)
            text = (
                "1 where the response is a ratio less one, as margins are, that is fitted as such"
            )
            ratio = [float(item.kind == "margin") for item in items]
            _numbers(file, "response_ratio", ("response",), ratio, text)
        least = [np.nan if item.least is None else item.least for item in items]
        text = "least value that the response can have, in its units; missing where there is none"
        _numbers(file, "response_least", ("response",), least, text)
        for side, name in enumerate(("response_floor", "response_ceiling")):
            ends = [np.nan if item.ends[side] is None else item.ends[side] for item in items]
            text = (
                f"{name[9:]} that a stop or latch sets to an opening; missing where there is none"
            )
            _numbers(file, name, ("response",), ends, text)


def _write_rows(file: Any, rows: list[int], records: Sequence[RunRecord]) -> None:
    """Write the responses and events of some runs."""
    file["values"][rows] = np.stack([record.values for record in records])
    file["overlap"][rows] = [max(0.0, record.overlap) for record in records]
    events = pad_events([record.events for record in records])
    for column, name in enumerate(EVENT_VARIABLES):
        file[name][rows, : events.shape[1]] = events[..., column]
    if len(records[0].numbers):
        file["quantities"][rows] = np.stack([record.numbers for record in records])
        file["margin"][rows] = np.stack([record.margins for record in records])


def _text(file: Any, name: str, dimension: str, values: Sequence[str], long_name: str) -> None:
    variable = file.createVariable(name, str, (dimension,))
    variable[:] = np.array(values, dtype=object)
    variable.long_name = long_name


def _numbers(
    file: Any, name: str, dimensions: tuple[str, ...], values: Any, long_name: str,
    compression: Mapping | None = None, **attributes: str,
) -> None:  # fmt: skip
    variable = file.createVariable(name, "f8", dimensions, **(compression or {}))
    variable[:] = values
    variable.setncatts({"long_name": long_name, **attributes})
