"""Gather the responses of all runs of a plan into one file, `samples.nc`.

    dims   run, time, parameter, event
    unit(run, parameter)    coordinates in the box, -1 to 1
    value(run, parameter)   parameter values, in the units parameter_unit(parameter)
    role(run)               node, nominal or held_out
    run_id(run)
    <response>(run, time)   with units and long_name
    event_time, event_contact, event_closing (run, event)   contact events, padded with NaN

This file is all that the interval side needs.
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
from campaign.store import EVENT_VARIABLES, open_store, write_names

_CHUNK_RUNS = 64


def gather(
    plan: Mapping, batches: int, jobs: Mapping, folder: str | Path, path: str | Path
) -> None:
    """Write `samples.nc` at `path` from the runs in `folder`.

    Memory stays bounded by one group of lanes. Raises `CampaignError` when runs are missing.
    """
    import netCDF4

    store = open_store(jobs["keep"], folder)
    groups = [group for mine in groups_of(plan, batches, jobs["lanes"]) for group in mine]
    missing = [run["id"] for group in groups for run in store.missing(group)]
    if missing:
        raise CampaignError(
            f"{len(missing)} runs are missing in {folder}, e.g. {missing[0]}; "
            "simulate them again with: snakemake -c2 --forcerun simulate"
        )
    rows: dict[str, list[int]] = {}
    for row, run in enumerate(plan["runs"]):
        rows.setdefault(run["id"], []).append(row)
    names = list(plan["config"]["responses"])
    with whole_file(path) as temporary, netCDF4.Dataset(temporary, "w", format="NETCDF4") as file:
        _write_runs(file, plan)
        for group in groups:
            for id_, run in store.read(group, names).items():
                if "time" not in file.variables:
                    _define_responses(file, run, names)
                for row in rows[id_]:
                    for name in names:
                        file[name][row] = run[name]
                    for name in EVENT_VARIABLES:
                        events = run.get(name, np.zeros(0))
                        file[name][row, : len(events)] = events


def _write_runs(file: Any, plan: Mapping) -> None:
    """Define the dimensions and write what is known of the runs before they are simulated."""
    runs, config = plan["runs"], plan["config"]
    file.createDimension("run", len(runs))
    file.createDimension("event", None)
    write_names(file, "parameter", plan["names"])
    file["parameter"].long_name = "interval parameter"
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
    _text(file, "parameter_unit", "parameter", units, "unit of the parameter")
    for key in ("lower", "upper", "nominal"):
        variable = file.createVariable(f"parameter_{key}", "f8", ("parameter",))
        variable[:] = plan[key]
        variable.long_name = f"{key} value of the parameter"
    file.setncatts(
        {
            "Conventions": "CF-1.11",
            "title": f"Responses of all runs of the campaign {plan['campaign']}",
            "campaign": plan["campaign"],
            "scene": config["scene"]["name"],
            "config_hash": plan["config_hash"],
            "config": json.dumps(config, sort_keys=True),
            "responses": " ".join(config["responses"]),
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


def _define_responses(file: Any, run: Mapping, names: Sequence[str]) -> None:
    """Define time, responses and events as the first run has them."""
    size = len(run["time"])
    file.createDimension("time", size)
    time = file.createVariable("time", "f8", ("time",))
    time[:] = run["time"]
    time.setncatts({"units": "s", "long_name": "time", "axis": "T"})
    write_names(file, "contact", run["contact"])
    file["contact"].long_name = "name of the contact"
    chunk = (min(_CHUNK_RUNS, len(file.dimensions["run"])), size)
    for name in names:
        variable = file.createVariable(
            name,
            run[name].dtype,
            ("run", "time"),
            zlib=True,
            complevel=4,
            shuffle=True,
            chunksizes=chunk,
        )
        variable.setncatts(run["attributes"][name])
    for name, units, long_name in (
        ("event_time", "s", "time at which a contact closes or opens"),
        ("event_contact", "1", "index of the contact"),
        ("event_closing", "1", "1 where it closes, 0 where it opens"),
    ):
        variable = file.createVariable(name, "f8", ("run", "event"), fill_value=np.nan)
        variable.setncatts({"units": units, "long_name": long_name})


def _text(file: Any, name: str, dimension: str, values: Sequence[str], long_name: str) -> None:
    variable = file.createVariable(name, str, (dimension,))
    variable[:] = np.array(values, dtype=object)
    variable.long_name = long_name
