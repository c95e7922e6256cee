"""From the quantities of all runs to their intervals, `quantities.nc`, with the further runs that
their bounds take, `refinement.nc`.

    dims   quantity, parameter
    lower, upper (quantity)         the interval: of the simulated bounds and the surrogate's
    simulated_lower, simulated_upper, argmin, argmax    the extreme runs, and where they are
    surrogate_lower, surrogate_upper                    what the surrogate says
    unconverged_lower, unconverged_upper    1 where the surrogate is beyond the simulated bound
    error                           estimated error of the surrogate
    error_step, error_mesh, error_whole     those of step and mesh, if verified, and the sum
    runs_with, runs_without         in how many runs there is such a number, and in how many not
    happens, happens_uncertainty    share of the box in which there is, and what of it is open
    error_limit, error_border       errors by step and mesh, if verified, for shares of the box: of
                                    the number, and of whether there is one
    is_time, fit                    1 for times of the run; what was fitted
    search_end (quantity)           with an `accuracy`, why the search ended before an error is as
                                    small as is asked; empty if it is
    least                           physical lower bound, NaN where there is none
    share, alone, fixed, halved (quantity, parameter)   what each parameter contributes"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from deployable.campaign.answers.discretization import (
    estimate_discretization_errors,
    estimate_fraction_errors,
)
from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.limits import list_limits
from deployable.campaign.answers.quantity_bounds import QuantityBounds, converge_bounds
from deployable.campaign.config.sections import Jobs, Verify, plain_data
from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.plan.accuracy import (
    affordable_runs,
    allow_check_runs,
    left_tolerances,
)
from deployable.campaign.plan.decide import CHECKED_RUNS
from deployable.campaign.results.bounds import write_dataset
from deployable.campaign.runs.progress import Notify
from deployable.campaign.text import numbers
from deployable.campaign.text.numbers import VOLUME
from fpm.files.trajectory import CONVENTIONS

_DIM, _DIMS = ("quantity",), ("quantity", "parameter")


def answer(
    folder: Folder,
    requirements: Mapping[str, Mapping],
    verify: Verify,
    jobs: Jobs,
    notify: Notify,
    threads: int,
) -> None:
    """Bound each quantity over the parameter box, with further runs where bounds and requirements
    need them, and write `quantities.nc` and `refinement.nc` into `folder`, that of a campaign's
    results with `samples.nc`. requirements, verify, jobs: sections of the config; notify: called
    with each message; threads: how many simulate."""
    model = ModelEvaluator.from_folder(folder, jobs, notify, threads)
    with open_netcdf(folder.bounds) as file:  # whose check is counted already
        model.account.ids |= set(str(getattr(file, "check_ids", "")).split())
    tolerances: list[float] = []
    if model.experiment.is_adaptive:
        model.account.limit = allow_check_runs(model.plan)
        limit, reserve = model.account.limit, CHECKED_RUNS * len(model.experiment.quantities)
        affordable = max(affordable_runs(model.plan), reserve)
        model.max_refinements = min(max(limit - reserve, limit // 2), affordable)
        tolerances = left_tolerances(model.plan)
    if model.experiment.design.method == "screening":
        model.max_refinements = max(0, model.experiment.design.samples - len(model.distinct_rows))
    specs = list_limits(requirements, list(model.experiment.quantities))
    bounds = converge_bounds(model, verify.max_iterations, specs, tolerances)
    if count := len(model.refinements):
        notify(f"{model.experiment.name}: further runs at bounds and limits: {count}")
    finer = estimate_discretization_errors(model, bounds) if verify.discretization else {}
    dataset = quantities_dataset(model, bounds, finer)
    if tolerances:
        dataset["search_end"] = (_DIM, _describe_ends(model, bounds, tolerances))
    write_dataset(dataset, folder.quantities, "Intervals of quantities")
    write_dataset(
        make_refinement_dataset(model), folder.refinement, "Further runs for bounds of quantities"
    )


def _describe_ends(
    model: ModelEvaluator, bounds: list[QuantityBounds], tolerances: list[float]
) -> list[str]:
    """Why the search for the bounds of each quantity ended while an error was too large, and where
    in the box the runs are predicted worst; empty texts for the others."""
    box, types = model.experiment.box, model.experiment.scene_type.parameters
    units = [{"name": name, "units": types[name].unit} for name in box.names]
    is_spent = min(model.max_refinements - len(model.refinements), model.account.allowance) < 1
    cause = "its runs are made" if is_spent else "more runs no longer lower its error"
    texts = []
    for b, tolerance in zip(bounds, tolerances, strict=True):
        texts.append("")
        if b.surrogate.fit is not None and b.relative_error > tolerance:
            fit = b.surrogate.fit
            values = box.from_unit(fit.points[np.argmax(np.abs(np.nan_to_num(fit.left_out)))])
            place = numbers.place(dict(zip(box.names, values, strict=True)), units)
            texts[-1] = f"{cause}; runs are predicted worst about {place}"
    return texts


def quantities_dataset(
    model: ModelEvaluator, bounds: list[QuantityBounds], finer: Mapping[str, np.ndarray]
) -> Any:
    """Make the content of `quantities.nc`, an `xarray.Dataset` of the bounds and errors of all
    quantities. model: holds the runs; bounds: of each quantity, as `converge_bounds` returns them;
    finer: errors (q, 2) of lower and upper bounds by "step" and "mesh", as
    `estimate_discretization_errors` returns them; empty if not estimated."""
    import xarray as xr

    from deployable.intervals.estimates import MAX_DIRECTIONS

    variables = _Variables()
    _put_bounds(variables, model, bounds)
    is_adaptive = model.experiment.is_adaptive
    errors = [b.surrogate.bound_error if is_adaptive else b.surrogate.error for b in bounds]
    errors = np.fmax(errors, [b.error for b in bounds])
    errors = [error if np.isfinite(error) else np.nan for error in errors]
    is_averaged = is_adaptive and model.experiment.box.free.sum() <= MAX_DIRECTIONS
    kind = "mean" if is_averaged else "largest"
    text = f"estimated error of the surrogate: its {kind} left-out one"
    variables.put("error", _DIM, errors, text)
    number_errors, shifts = estimate_fraction_errors(model, bounds, finer)
    if finer:
        components = {name: e.max(axis=1) for name, e in finer.items()}
        for name, values in components.items():
            variables.put(f"error_{name}", _DIM, values, f"error of the bounds by {name}")
        whole = np.sum([errors, *components.values()], axis=0)
        variables.put("error_whole", _DIM, whole, "errors of surrogate, step and mesh together")
        text = "errors by step and mesh of {}, for shares of the box".format
        variables.put("error_limit", _DIM, number_errors, text("the quantity"))
        variables.put("error_border", _DIM, shifts, text("the event margin"))
    _put_occurrence(variables, model, bounds, shifts)
    _put_shares(variables, model, bounds)
    times = [int(quantity.is_time) for quantity in model.experiment.quantity_list]
    variables.put("is_time", _DIM, times, "1 for times of the run", "1")
    least = [np.nan if q.least is None else q.least for q in model.experiment.quantity_list]
    variables.put("least", _DIM, least, "physical lower bound of the quantity")
    kinds = [b.surrogate.fit.kind if b.surrogate.fit else "none" for b in bounds]
    variables["fit"] = (_DIM, kinds, {"long_name": "what was fitted to the runs"})
    return xr.Dataset(variables, coordinates(model), attributes_of(model))


class _Variables(dict):
    """Variables of a dataset: dimensions, values and attributes by name."""

    def put(
        self, name: str, dims: tuple[str, ...], values: Any, text: str, units: str = ""
    ) -> None:
        attributes = {"long_name": text} | ({"units": units} if units else {})
        self[name] = (dims, np.array(values), attributes)


def _put_bounds(variables: _Variables, model: ModelEvaluator, bounds: list[QuantityBounds]) -> None:
    """The bounds, where they are, and the surrogate at the nominal values."""
    to_value = model.experiment.box.from_unit
    for i, side in enumerate(("lower", "upper")):
        outer = [b.outer[i] for b in bounds]
        variables.put(side, _DIM, outer, f"{side} bound, by runs and surrogate")
        simulated = [getattr(b, side) for b in bounds]
        variables.put(f"simulated_{side}", _DIM, simulated, f"{side} bound attained by a run")
        predictions = [(b.surrogate_range.low, b.surrogate_range.high)[i] for b in bounds]
        variables.put(f"surrogate_{side}", _DIM, predictions, f"{side} bound by the surrogate")
        moving = [int(b.unconverged[i]) for b in bounds]
        text = f"1 where the surrogate is beyond the simulated {side} bound"
        variables.put(f"unconverged_{side}", _DIM, moving, text, "1")
        location = ("argmin", "argmax")[i]
        points = to_value(np.array([getattr(b, location) for b in bounds]))
        variables.put(location, _DIMS, points, f"parameters of the run at the {side} bound")
    nominal = [s.evaluate(model.nominal[None])[0] for s in model.surrogates()]
    variables.put("nominal", _DIM, nominal, "quantity at the nominal values, by the surrogate")


def _put_occurrence(
    variables: _Variables, model: ModelEvaluator, bounds: list[QuantityBounds], shifts: np.ndarray
) -> None:
    """In how many runs, and in which share of the box, there is such a number."""
    from deployable.intervals.scalars import Limit, share_of_box

    counts = np.isfinite(model.numbers[model.distinct_rows]).sum(axis=0) + model.rest_counts
    variables.put("runs_with", _DIM, counts, "number of runs with the quantity", "1")
    absences = len(model.distinct_rows) + model.rest_count - counts
    variables.put("runs_without", _DIM, absences, "number of runs without the quantity", "1")
    free = model.experiment.box.free
    limits = [
        Limit(b.surrogate, "happens", 1.0, border_error=float(shift))
        for b, shift in zip(bounds, shifts, strict=True)
    ]
    shares = np.array([share_of_box([limit], free) for limit in limits])
    text = f"share of the box, {VOLUME}, in which the quantity exists"
    variables.put("happens", _DIM, shares[:, 0], text, "1")
    variables.put("happens_uncertainty", _DIM, shares[:, 1], f"uncertainty of the {text}", "1")


def _put_shares(variables: _Variables, model: ModelEvaluator, bounds: list[QuantityBounds]) -> None:
    """What each parameter contributes."""
    from deployable.intervals.scalars import find_influence

    influences = [find_influence(b.surrogate, model.nominal) for b in bounds]
    texts = {
        "share": "fraction of the sum of the widths `alone`; 0 if not above the error",
        "alone": "width when only this parameter varies",
        "fixed": "width when this parameter is fixed",
        "halved": "width when its interval is half as wide",
    }
    # The search over a part may find more than that over the whole has.
    max_widths = {name: np.diff([b.outer for b in bounds]) for name in ("alone", "fixed", "halved")}
    for name, text in texts.items():
        units = "1" if name == "share" else ""
        values = np.minimum([getattr(f, name) for f in influences], max_widths.get(name, 1.0))
        variables.put(name, _DIMS, values, text, units)


def make_refinement_dataset(model: ModelEvaluator) -> Any:
    """Make the content of `refinement.nc`, an `xarray.Dataset` of the runs that `model` added
    beyond the plan: ids, coordinates in the box (-1 to 1), parameter values and quantities, each in
    its unit, and event margins, above 0 where the event occurs. Writes nothing."""
    import xarray as xr

    runs, k = model.refinements, model.points.shape[1]
    numbers, margins = (rows[len(rows) - len(runs) :] for rows in (model.numbers, model.margins))
    dims, text = ("run", "parameter"), "event margin: positive if the event occurs"
    values = np.array([run.values for run in runs]).reshape(-1, k)
    x = np.array([run.normalized for run in runs]).reshape(-1, k)
    ids = np.array([run.id for run in runs], dtype=object)
    variables = {
        "run_id": ("run", ids, {"long_name": "id of the run"}),
        "normalized": (dims, x, {"units": "1", "long_name": "coordinates in the box, -1 to 1"}),
        "value": (dims, values, {"long_name": "parameter values in their units"}),
        "quantities": (("run", "quantity"), numbers, {"long_name": "value of the quantity"}),
        "margin": (("run", "quantity"), margins, {"long_name": text}),
    }
    return xr.Dataset(variables, coordinates(model), attributes_of(model))


def coordinates(model: ModelEvaluator) -> dict:
    """Make the coordinates of the netCDF files of quantities: tuples of dimension, values and
    attributes by name, for names and units of the model's quantities and interval parameters, and
    lower, upper and nominal value of each interval."""
    experiment = model.experiment
    quantities, parameters = experiment.quantity_list, experiment.scene_type.parameters
    names, rows = list(experiment.intervals), experiment.intervals.values()
    columns = {
        "quantity": ("quantity", [q.name for q in quantities], "name of the quantity"),
        "quantity_units": ("quantity", [q.unit for q in quantities], "units of the quantity"),
        "quantity_long_name": ("quantity", [q.long_name for q in quantities], "quantity in words"),
        "parameter": ("parameter", names, "interval parameter"),
        "box_units": ("parameter", [parameters[n].unit for n in names], "units of the parameter"),
    }
    for key in ("lower", "upper", "nominal"):
        bounds = [getattr(interval, key) for interval in rows]
        columns[f"box_{key}"] = ("parameter", bounds, f"{key} value of the parameter")
    return {name: (dim, values, {"long_name": t}) for name, (dim, values, t) in columns.items()}


def attributes_of(model: ModelEvaluator) -> dict:
    """Make the attributes, by name, of the netCDF files of quantities: conventions, campaign,
    scene, config with its hash, digest of the mechanics (code and structure), `runs` (number of
    distinct runs that the results rest on), `further_runs` (number of those added at bounds and
    limit-state surfaces) and `check_runs` (runs repeated with finer step and mesh, beside those for
    responses). model: has the runs and their plan."""
    return {
        "Conventions": CONVENTIONS,
        "campaign": model.experiment.name,
        "scene": model.experiment.scene.name,
        "config_hash": model.plan.config_hash,
        "config": json.dumps(plain_data(model.experiment)),
        "mechanics": model.plan.mechanics,
        "runs": len(model.distinct_rows) + model.rest_count,
        "further_runs": len(model.refinements),
        "check_runs": model.account.count - len(model.refinements),
    }
