"""From the quantities of all runs to their intervals, `quantities.nc`, with the further runs that
their bounds take, `refinement.nc`; `files/variables.json` says what they hold."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.answers.discretization import (
    estimate_discretization_errors,
    estimate_fraction_errors,
)
from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.limits import list_limits
from deployable.campaign.answers.quantity_bounds import QuantityBounds, converge_bounds
from deployable.campaign.config.sections import Verify
from deployable.campaign.files import dataset_of
from deployable.campaign.plan.accuracy import affordable_runs, allow_check_runs, left_tolerances
from deployable.campaign.plan.decide import CHECKED_RUNS
from deployable.campaign.plan.plan import box_columns, failure_columns
from deployable.campaign.results.bounds import write_dataset
from deployable.campaign.results.quantity_results import FittedRuns
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.text import numbers
from deployable.intervals.scalars import Limit, find_influence, share_of_box
from fpm.reading.quantities import Quantity


def answer(model: ModelEvaluator, requirements: Mapping[str, Mapping], verify: Verify) -> None:
    """Bound each quantity over the parameter box, with further runs where bounds and requirements
    need them, and write `quantities.nc` and `refinement.nc` into the folder of `model`, which has
    the planned runs. requirements, verify: sections of the config."""
    folder = model.folder
    attributes = read_bounds(folder, of_design=True).attributes
    model.account.ids |= set(str(attributes.get("check_ids", "")).split())  # are counted already
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
        model.notify(f"{model.experiment.name}: further runs at bounds and limits: {count}")
    finer = estimate_discretization_errors(model, bounds) if verify.discretization else {}
    columns = _columns(model, bounds, finer)
    if tolerances:
        columns["search_end"] = [*_describe_ends(model, bounds, tolerances)]
    _write(model, "quantities.nc", columns, folder.quantities, "Intervals of quantities")
    runs, shape = model.refinements, (-1, model.points.shape[1])
    first = len(model.numbers) - len(runs)
    columns = {
        "run_id": np.array([run.id for run in runs], dtype=object),
        "normalized": np.reshape([run.normalized for run in runs], shape),
        "value": np.reshape([run.values for run in runs], shape),
        "quantities": model.numbers[first:],
        "margin": model.margins[first:],
        **failure_columns(model.failures),
    }
    title = "Further runs for bounds of quantities"
    _write(model, "refinement.nc", columns, folder.refinement, title)


def _write(model: ModelEvaluator, result: str, columns: dict, path: Path, title: str) -> None:
    """Write columns, by name, with names and units of the model's quantities and parameters."""
    quantities, count = model.experiment.quantity_list, len(model.refinements)
    columns |= {
        "quantity": [quantity.name for quantity in quantities],
        "quantity_units": [quantity.unit for quantity in quantities],
        "quantity_long_name": [quantity.long_name for quantity in quantities],
        **box_columns(model.experiment),
    }
    attributes = model.plan.attributes | {
        "runs": len(model.distinct_rows) + model.rest_count,
        "further_runs": count,
        "check_runs": model.account.count - count - len(model.failures),
    }
    write_dataset(dataset_of(result, columns, attributes), path, title)


def _describe_ends(
    model: ModelEvaluator, bounds: list[QuantityBounds], tolerances: list[float]
) -> Iterator[str]:
    """Why the search for each quantity's bounds ended although an error was too large, and where
    runs are predicted worst; empty texts for the other quantities."""
    box, types = model.experiment.box, model.experiment.scene_type.parameters
    units = [{"name": name, "units": types[name].unit} for name in box.names]
    is_spent = min(model.max_refinements - len(model.refinements), model.account.allowance) < 1
    cause = "its runs are made" if is_spent else "more runs no longer lower its error"
    for b, tolerance in zip(bounds, tolerances, strict=True):
        if (fit := b.surrogate.fit) is None or not b.relative_error > tolerance:
            yield ""
            continue
        values = box.from_unit(fit.points[np.argmax(np.abs(np.nan_to_num(fit.left_out)))])
        place = numbers.place(dict(zip(box.names, values, strict=True)), units)
        yield f"{cause}; runs are predicted worst about {place}"


def _columns(
    model: ModelEvaluator, bounds: list[QuantityBounds], finer: Mapping[str, np.ndarray]
) -> dict[str, Any]:
    """Columns of `quantities.nc` by name. finer: errors (q, 2) of lower and upper bounds by "step"
    and "mesh", empty if not estimated."""
    number_errors, shifts = estimate_fraction_errors(model, bounds, finer)
    design = slice(len(model.points) - len(model.refinements))
    runs = FittedRuns(model.points[design], model.numbers[design], model.margins[design])
    previous = runs.surrogates(model.experiment)
    quantities = zip(model.experiment.quantity_list, bounds, previous, shifts.tolist(), strict=True)
    rows = [_row(model, *quantity) for quantity in quantities]
    columns: dict[str, Any] = {name: [row[name] for row in rows] for name in rows[0]}
    counts = np.isfinite(model.numbers[model.distinct_rows]).sum(axis=0) + model.rest_counts
    columns["runs_with"] = counts
    columns["runs_without"] = len(model.distinct_rows) + model.rest_count - counts
    if finer:
        components = {f"error_{name}": e.max(axis=1) for name, e in finer.items()}
        whole = np.sum([columns["error"], *components.values()], axis=0)
        columns |= {**components, "error_whole": whole}
        columns |= {"error_limit": number_errors, "error_border": shifts}
    return columns


def _row(
    model: ModelEvaluator, quantity: Quantity, bounds: QuantityBounds, previous: Any, shift: float
) -> dict[str, Any]:
    """Return a quantity's row of `quantities.nc`, by the names of its columns. previous: surrogate
    before further runs; shift: error of the decision function by mesh and step."""
    box, surrogate, extremes = model.experiment.box, bounds.surrogate, bounds.surrogate_range
    (lower, upper), unconverged = bounds.outer, map(int, bounds.unconverged)
    error = surrogate.bound_error if model.experiment.is_adaptive else surrogate.error
    error = np.fmax(error, bounds.error)
    limit = Limit(surrogate, "happens", 1.0, border_error=shift)
    is_endless = bounds.may_be_endless or upper == surrogate.latest
    influence = find_influence(surrogate, model.nominal, previous, is_endless)
    row = {
        "lower": lower, "upper": upper,
        "simulated_lower": bounds.lower, "simulated_upper": bounds.upper,
        "surrogate_lower": extremes.low, "surrogate_upper": extremes.high,
        "argmin": box.from_unit(bounds.argmin), "argmax": box.from_unit(bounds.argmax),
        "nominal": surrogate.evaluate(model.nominal[None])[0],
        "error": error if np.isfinite(error) else np.nan,
        "is_time": int(quantity.is_time), "may_be_endless": int(bounds.may_be_endless),
        "fit": surrogate.fit.kind if surrogate.fit else "none",
        # The search over a part may find more than that over the whole has.
        **{name: np.minimum(getattr(influence, name), upper - lower)
           for name in ("alone", "fixed", "halved")},
        "share": influence.share, "width_error": influence.error,
    }  # fmt: skip
    row |= zip(("unconverged_lower", "unconverged_upper"), unconverged, strict=True)
    return row | dict(zip(("happens", "happens_uncertainty"),
                          share_of_box([limit], box.free), strict=True))  # fmt: skip
