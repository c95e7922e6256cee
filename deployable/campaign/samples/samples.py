"""Gather the responses of all runs of a plan into `samples.nc`, all that the interval side needs.
`files/variables.json` says what it holds. Variables are named after parameters
(`parameter_<name>`), none after a response, so that a response may have any name."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Jobs
from deployable.campaign.files import EVENT_VARIABLES, create, result_file
from deployable.campaign.plan.plan import FailedRun, Plan, Runs, box_columns, failure_columns
from deployable.campaign.provenance import as_attribute
from deployable.campaign.runs.batch import Simulation, check_failures, complete_group
from deployable.campaign.runs.progress import Notify
from deployable.campaign.runs.results import RunRecord, groups_of, pad_events
from deployable.campaign.runs.store import open_store

_FILE = "samples.nc"


def gather(
    plan: Plan, jobs: Jobs, folder: str | Path, path: str | Path, notify: Notify = lambda text: None
) -> None:
    """Write responses and quantities of all runs to `path`, one group at a time; missing or damaged
    runs are made again, failed ones listed apart. Raises `CampaignError` if too many failed."""
    import netCDF4

    store, unique = open_store(jobs.keep, folder, plan.experiment), plan.unique_runs
    groups, failures = groups_of(unique, jobs.group), store.list_failures(unique)
    check_failures(plan, failures, len(unique))
    runs = store.sound(plan.runs)
    rows: dict[str, list[int]] = {}
    finest = plan.time.step
    for row, run in enumerate(runs):
        rows.setdefault(run.id, []).append(row)
    with (
        result_file(path, plan=plan.digest) as temporary,
        netCDF4.Dataset(temporary, "w", format="NETCDF4") as file,
    ):
        _write_runs(file, plan, runs, failures)
        _write_names(file, "response", store.responses)
        if quantities := plan.experiment.quantity_list:
            _write_names(file, "quantity", quantities)
            blanks = np.full((len(runs), len(quantities)), np.nan)
            for name in ("quantities", "margin"):
                create(file, _FILE, name, blanks)
        for group in groups:
            records = store.read(group)
            if len(records) < len(store.sound(group)):
                text = f"{plan.experiment.name}: {{}} runs are missing and made again"
                complete_group(plan, store, group, Simulation(plan, jobs.group), notify, text)
                records = store.read(group)
            if not records:
                continue
            if "time" not in file.variables:
                _define_curves(file, next(iter(records.values())), plan.experiment.intervals)
            pairs = sorted((row, id_) for id_ in records for row in rows[id_])
            places, group_records = [row for row, _ in pairs], [records[id_] for _, id_ in pairs]
            columns = {
                "values": [record.values for record in group_records],
                "overlap": [max(0.0, record.overlap) for record in group_records],
                "event_margin": [record.event_margins for record in group_records],
                "quantities": [record.numbers for record in group_records],
                "margin": [record.margins for record in group_records],
            }
            for name in (name for name in columns if name in file.variables):
                file[name][places] = np.stack(columns[name])
            events = pad_events([record.events for record in group_records])
            for column, name in enumerate(EVENT_VARIABLES):
                file[name][places, : events.shape[1]] = events[..., column]
            finest = min(finest, *(record.step for record in group_records))
        file.finest_step = finest
    if len(store.list_failures(unique)) > len(failures):  # of runs that were made again
        gather(plan, jobs, folder, path, notify)


def _write_runs(file: Any, plan: Plan, runs: Runs, failures: Sequence[FailedRun]) -> None:
    """Define the dimensions and write what is known of the runs before they are simulated."""
    for name, values in box_columns(plan.experiment).items():
        create(file, _FILE, name, values)
    file.setncatts({
        **plan.attributes,
        "title": f"Responses of all runs of the campaign {plan.experiment.name}",
        "source": "finite particle method",
        "history": f"deployable gather: {len(plan.unique_runs)} runs of fpm",
        "time_step": plan.time.step,
        "time_step_limit": plan.time.step_limit,
        "limiting_element": plan.time.limiting_element,
        "assembly_energy": plan.time.assembly_energy,
        "provenance": as_attribute(),
    })  # fmt: skip
    if failures:
        file.createDimension("failed", len(failures))
    for name, column in failure_columns(failures).items():
        create(file, _FILE, name, column)
    file.createDimension("run", len(runs))
    file.createDimension("event", None)
    create(file, _FILE, "role", [run.role for run in runs])
    create(file, _FILE, "run_id", [run.id for run in runs])
    create(file, _FILE, "normalized", runs.normalized)
    create(file, _FILE, "value", runs.values)
    types = plan.experiment.scene_type.parameters
    for name, column in zip(plan.experiment.intervals, runs.values.T, strict=True):
        variable = file.createVariable(f"parameter_{name}", "f8", ("run",))
        variable[:] = column
        variable.setncatts({"long_name": f"value of {name}", "units": types[name].unit})


def _define_curves(file: Any, record: RunRecord, parameters: Iterable[str]) -> None:
    """Define time, values and events as the first run has them."""
    create(file, _FILE, "time", record.time).setncatts({"standard_name": "time", "axis": "T"})
    create(file, _FILE, "contact", record.contacts)
    # Not compressed: it would save a third at most, and take half of the time of gathering.
    variable = create(file, _FILE, "values", kind=record.values.dtype.newbyteorder("="))
    variables = [f"parameter_{name}" for name in parameters]
    variables += ["role", "run_id", "response_units", "response_long_name"]
    variable.coordinates = " ".join(variables)
    create(file, _FILE, "overlap")
    create(file, _FILE, "event_margin")
    for name in EVENT_VARIABLES:
        create(file, _FILE, name, fill_value=np.nan)


def _write_names(file: Any, dimension: str, items: Sequence[Any]) -> None:
    """Write names, units and long names of responses or quantities (`dimension`); of responses
    their axes and physical lower bounds, too."""
    columns = {dimension: [item.name for item in items]}
    columns[f"{dimension}_units"] = [item.unit for item in items]
    columns[f"{dimension}_long_name"] = [item.long_name for item in items]
    if dimension == "response":
        if any(item.along for item in items):
            axes = [json.dumps(item.along and item.along._asdict()) for item in items]
            columns["response_along"] = axes
            columns["response_ratio"] = [float(item.kind == "margin") for item in items]
        limits = zip(*((item.least, *item.ends) for item in items), strict=True)
        for side, ends in zip(("least", "floor", "ceiling"), limits, strict=True):
            columns[f"response_{side}"] = [np.nan if x is None else x for x in ends]
    for name, values in columns.items():
        create(file, _FILE, name, values)
