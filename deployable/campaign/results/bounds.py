"""From `samples.nc` to surrogate, bounds and sensitivities, by the `intervals` package, which says
what the files hold. Bounds may be a spline's, the others are always the polynomial's."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from deployable import intervals
from deployable.campaign.config.sections import OWN_RUNS, BoundsChoice, Experiment, make_design
from deployable.campaign.files import open_dataset, result_file
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import as_attribute
from fpm.files.seals import unseal


def analyse(
    folder: Folder, choice: BoundsChoice, with_errors: Callable[[Any], Any] | None = None
) -> None:
    """Fit the runs of a campaign, and write `surrogate.nc`, `design_bounds.nc` and
    `sensitivities.nc`. choice: section `bounds` of the config, whose model the bounds are of; the
    other two are of the polynomial; with_errors: function of the dataset of bounds that returns it
    with further errors. A scan's samples are read in pieces, so they may be larger than memory."""
    import xarray as xr

    with open_dataset(folder.samples) as samples:
        experiment = Experiment.read(samples.attrs["config"])
        design = _design(samples, experiment)
        bounds = intervals.bounds_dataset(samples, design, model=choice.model)
        if bounds.attrs["held_out_runs"]:  # which a polynomial's range may lack
            table = samples["values"].values
            runs = intervals.RunBounds.from_runs(table, np.arange(len(table)))
            bounds = intervals.include_runs(bounds, runs, samples["value"].values)
        surrogate = intervals.surrogate_dataset(samples, design)
        write_dataset(surrogate, folder.surrogate, "Surrogates of the responses")
        if not surrogate.sizes["term"]:
            sensitivities = xr.Dataset(attrs=samples.attrs)
        else:
            sensitivities = intervals.sensitivity_dataset(samples, design)
        write_dataset(sensitivities, folder.sensitivities, "Influence of each parameter")
        bounds = bounds.load()
    if with_errors is not None:
        bounds = with_errors(bounds)
    write_dataset(bounds, folder.design_bounds, "Bounds of the responses")


def include_runs(folder: Folder, runs: Any) -> None:
    """Write `bounds.nc`: the bounds by the planned runs and by further ones, `runs`. Models that
    are chosen by left-out runs are fitted to them as well; other bounds are widened to them."""
    if not runs.values:
        with result_file(folder.bounds) as temporary:
            temporary.write_bytes(unseal(folder.design_bounds))
        return
    values = np.array(runs.values)
    curves = np.array([record.values for record in runs.records], dtype=float)
    with open_dataset(folder.design_bounds) as bounds, open_dataset(folder.samples) as samples:
        wider = bounds
        if "models" in bounds.attrs:
            points = runs.experiment.box.to_unit(values)
            samples = intervals.add_runs(samples, points, values, curves, *runs.events)
            design = _design(samples, runs.experiment)
            wider = intervals.bounds_dataset(samples, design, model="auto")
            parts = [part for part in bounds.attrs.get("error_parts", []) if part != "surrogate"]
            if parts:
                errors = {part: bounds[f"error_{part}"].values for part in parts}
                wider = intervals.add_errors(wider, errors)
        extremes = intervals.RunBounds.from_runs(curves, np.arange(len(curves)))
        wider = intervals.include_runs(wider, extremes, values)
        write_dataset(wider, folder.bounds, "Bounds of the responses")


def _design(samples: Any, experiment: Experiment) -> Any:
    """Return the design of the runs in `samples`: of a plain scan to make it again takes longer
    than its bounds, and a file of runs may be elsewhere by now."""
    method, order = experiment.design.method, experiment.design.order
    if not (method == OWN_RUNS or (method == "sobol" and order is None)):
        return make_design(experiment)
    points = samples["normalized"].values[samples["role"].values == "node"]
    orders = (0,) * points.shape[1]
    return intervals.Design(points, np.zeros((0, len(orders)), dtype=int), method, orders)


def write_dataset(dataset: Any, path: str | Path, title: str) -> None:
    """Write an `xarray.Dataset`, whose attribute `campaign` is the name, as compressed netCDF with
    a seal and provenance, whole or not at all. title: what it holds, in words."""
    heading = f"{title}, campaign {dataset.attrs['campaign']}"
    history = f"{dataset.attrs.get('history', '')}\n{title}".strip()
    dataset = dataset.assign_attrs(title=heading, history=history, provenance=as_attribute())
    encoding: dict[str, dict] = {}
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "f" and variable.ndim:
            encoding[name] = {"zlib": True, "complevel": 1}
            if variable.dims == (name,):  # no value of a coordinate is ever missing
                encoding[name]["_FillValue"] = None
        elif variable.dtype.kind == "i":  # 64 bits are not in the conventions
            encoding[name] = {"dtype": "int32"}
    with result_file(path) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)
