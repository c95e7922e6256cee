"""Gather the responses of all runs of a plan into one file, `samples.nc`.

    dims   run, response, time, parameter, event
    values(run, response, time)   in the units response_units(response)
    response, response_units, response_long_name (response)
    unit(run, parameter)          coordinates in the box, -1 to 1
    value(run, parameter)         parameter values, in the units box_units(parameter)
    parameter_<name>(run)         the same by name, with units
    box_lower, box_upper, box_nominal (parameter)
    role(run)                     node, nominal or held_out
    run_id(run)
    event_time, event_contact, event_closing (run, event)   contact events, padded with NaN

No variable is named after a response, so that a response may have any name. This file is all that
the interval side needs.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from campaign.errors import CampaignError
from campaign.files import whole_file
from campaign.run import groups_of
from campaign.store import EVENT_VARIABLES, Record, open_store, write_dimension

_CHUNK_RUNS = 64


def gather(
    plan: Mapping, batches: int, jobs: Mapping, folder: str | Path, path: str | Path
) -> None:
    """Write `samples.nc` at `path` from the runs in `folder`.

    Memory stays bounded by one group of lanes. Raises `CampaignError` when runs are missing.
    """
    import netCDF4

    store = open_store(jobs["keep"], folder, plan["config"])
    groups = [group for mine in groups_of(plan, batches, jobs["lanes"]) for group in mine]
    rows: dict[str, list[int]] = {}
    for row, run in enumerate(plan["runs"]):
        rows.setdefault(run["id"], []).append(row)
    missing: list[str] = []
    with whole_file(path) as temporary, netCDF4.Dataset(temporary, "w", format="NETCDF4") as file:
        _write_runs(file, plan)
        _write_names(file, store.responses)
        for group in groups:
            found = store.read(group)
            missing += [run["id"] for run in group if run["id"] not in found]
            if missing:
                continue
            if "time" not in file.variables:
                _define_curves(file, next(iter(found.values())), plan["names"])
            placed = sorted((row, id_) for id_ in found for row in rows[id_])
            _write_rows(file, [row for row, _ in placed], [found[id_] for _, id_ in placed])
        if missing:
            raise CampaignError(
                f"{len(missing)} runs are missing in {folder}, e.g. {missing[0]}; add "
                "`--forcerun simulate` to the same call of snakemake to simulate them again"
            )


def _write_runs(file: Any, plan: Mapping) -> None:
    """Define the dimensions and write what is known of the runs before they are simulated."""
    runs, config = plan["runs"], plan["config"]
    file.createDimension("run", len(runs))
    file.createDimension("event", None)
    write_dimension(file, "parameter", plan["names"], "interval parameter")
    _text(file, "role", "run", [run["role"] for run in runs], "what the run is for")
    _text(file, "run_id", "run", [run["id"] for run in runs], "name of the trajectory")
    for name, key, long_name in (
        ("unit", "unit", "coordinates in the box, -1 to 1"),
        ("value", "values", "parameter values in their units"),
    ):
        variable = file.createVariable(name, "f8", ("run", "parameter"))
        variable[:] = np.array([run[key] for run in runs])
        variable.long_name = long_name
    file["unit"].units = "1"
    units = parameter_units(config["scene"]["name"], plan["names"])
    _text(file, "box_units", "parameter", units, "units of the parameter")
    for key in ("lower", "upper", "nominal"):
        variable = file.createVariable(f"box_{key}", "f8", ("parameter",))
        variable[:] = plan[key]
        variable.long_name = f"{key} value of the parameter"
    for column, (name, unit) in enumerate(zip(plan["names"], units, strict=True)):
        variable = file.createVariable(f"parameter_{name}", "f8", ("run",))
        variable[:] = [run["values"][column] for run in runs]
        variable.setncatts({"units": unit, "long_name": f"value of {name}"})
    file.setncatts(
        {
            "Conventions": "CF-1.11",
            "title": f"Responses of all runs of the campaign {plan['campaign']}",
            "campaign": plan["campaign"],
            "scene": config["scene"]["name"],
            "config_hash": plan["config_hash"],
            "config": json.dumps(config, sort_keys=True),
            "time_step": plan["step"],
            "time_step_limit": plan["step_limit"],
            "limiting_element": plan["limiting_element"],
            "data_version": str(plan["data_version"]),
        }
    )


def parameter_units(scene: str, names: Sequence[str]) -> list[str]:
    """Units of a scene's parameters."""
    import fpm

    known = fpm.scenes.get(scene).parameters
    return [known[name].unit for name in names]


def _define_curves(file: Any, record: Record, parameters: Sequence[str]) -> None:
    """Define time, values and events as the first run has them."""
    size = len(record.time)
    file.createDimension("time", size)
    time = file.createVariable("time", "f8", ("time",))
    time[:] = record.time
    time.setncatts({"units": "s", "long_name": "time", "axis": "T"})
    write_dimension(file, "contact", record.contacts, "name of the contact")
    # Doubles hardly shrink; whoever keeps them has the trajectories beside, a hundred times larger.
    compact = {}
    kind = record.values.dtype.newbyteorder("=")
    if kind.itemsize == 4:
        chunk = (min(_CHUNK_RUNS, len(file.dimensions["run"])), 1, size)
        compact = {"zlib": True, "complevel": 4, "shuffle": True, "chunksizes": chunk}
    variable = file.createVariable("values", kind, ("run", "response", "time"), **compact)
    named = [f"parameter_{name}" for name in parameters]
    named += ["role", "run_id", "response_units", "response_long_name"]
    variable.setncatts({"long_name": "value of the response", "coordinates": " ".join(named)})
    for name, units, long_name in (
        ("event_time", "s", "time at which a contact closes or opens"),
        ("event_contact", "1", "index of the contact"),
        ("event_closing", "1", "1 where it closes, 0 where it opens"),
    ):
        variable = file.createVariable(name, "f8", ("run", "event"), fill_value=np.nan)
        variable.setncatts({"units": units, "long_name": long_name})


def _write_names(file: Any, responses: Sequence[Any]) -> None:
    """Write which responses there are."""
    write_dimension(file, "response", [r.name for r in responses], "name of the response")
    for key, values in (
        ("units", [r.unit for r in responses]),
        ("long_name", [r.long_name for r in responses]),
    ):
        text = f"{key.replace('_', ' ')} of the response"
        _text(file, f"response_{key}", "response", values, text)


def _write_rows(file: Any, rows: list[int], records: Sequence[Record]) -> None:
    """Write the responses and events of some runs."""
    file["values"][rows] = np.stack([record.values for record in records])
    for row, record in zip(rows, records, strict=True):
        for column, name in enumerate(EVENT_VARIABLES):
            file[name][row, : len(record.events)] = record.events[:, column]


def _text(file: Any, name: str, dimension: str, values: Sequence[str], long_name: str) -> None:
    variable = file.createVariable(name, str, (dimension,))
    variable[:] = np.array(values, dtype=object)
    variable.long_name = long_name
