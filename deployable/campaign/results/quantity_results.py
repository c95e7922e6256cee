"""Quantities over the box as `quantities.nc` has them, and their surrogates, fitted to the runs of
`samples.nc` and `refinement.nc`. Nothing else that shows or tells results knows that file."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import FailedRun
from deployable.campaign.results.response_bounds import COMPONENTS, read_parameters
from deployable.campaign.results.run_samples import RunTable, open_samples, read_refinement
from deployable.intervals.scalars import fit_scalar, share_borders

MAX_FIT_RUNS = 10_000  # runs up to which surrogates of quantities are fitted to all of them

_MAX_FITTED_RUNS = 4_000  # of more runs
_NUMBERS = ("lower", "upper", "simulated_lower", "simulated_upper", "surrogate_lower",
            "surrogate_upper", "nominal", "error", "happens",
            "happens_uncertainty")  # fmt: skip
_ERRORS = ("error_step", "error_mesh", "error_whole")
_INFLUENCE = ("share", "alone", "fixed", "halved", "width_error")


class QuantityResults(NamedTuple):
    """Quantities of a campaign over the box. rows: a dict of each, as in `summary.json`: interval,
    errors, numbers of runs with and without it, parameter values at both bounds, and the influence
    of each parameter, None where there is no number; `censored_at`: the end of the runs (s) of a
    time that some runs lack and whose upper bound reaches it, else None; `may_be_endless`: whether
    the runs leave open if a time has an upper bound. parameters: dicts of name,
    units, lower, nominal, upper; further_runs, check_runs: how many runs the search for the bounds
    added, and the estimate of errors made; errors (2, q): by mesh and step, of values and of event
    margins, by which shares of the box are uncertain; None where these were not estimated."""

    rows: list[dict[str, Any]]
    parameters: list[dict[str, Any]]
    further_runs: int
    check_runs: int
    errors: np.ndarray | None

    @classmethod
    def read(cls, folder: Folder) -> "QuantityResults":
        """Read the quantities of a campaign from its folder of results."""
        with open_netcdf(folder.quantities) as file:
            variables, parameters = file.variables, read_parameters(file)
            data = {name: variable[:] for name, variable in variables.items()}
            duration = Experiment.read(file.config).solver.duration
            counts = int(file.further_runs), int(file.check_runs)
        names = [parameter["name"] for parameter in parameters]
        rows = [_row(data, i, names, duration) for i in range(len(data["quantity"]))]
        errors = [data[name] for name in ("error_limit", "error_border") if name in data]
        return cls(rows, parameters, *counts, np.array(errors) if errors else None)


def _row(data: Mapping[str, Any], i: int, parameters: list[str], duration: float) -> dict[str, Any]:
    """Return the row of quantity `i`. data: all columns by name; duration: of the runs (s)."""
    texts = {"name": "quantity", "long_name": "quantity_long_name", "units": "quantity_units",
             "fit": "fit"}  # fmt: skip
    row: dict[str, Any] = {name: str(data[key][i]) for name, key in texts.items()}
    if "search_end" in data and data["search_end"][i]:
        row["search_end"] = str(data["search_end"][i])
    row |= {key: number(data[key][i]) for key in (*_NUMBERS, *_ERRORS) if key in data}
    if "error_whole" in row:
        keys = zip(COMPONENTS, ("error", *_ERRORS), strict=False)
        parts = {name: row[key] for name, key in keys if key in row}
        width = None if row["lower"] is None else row["upper"] - row["lower"]
        row["errors"] = add_total_error(parts, width)
    row |= {key: int(data[key][i]) for key in ("runs_with", "runs_without")}
    row["predicted_ends"] = [
        side for side in ("lower", "upper")
        if data[f"unconverged_{side}"][i] and row[side] != row[f"simulated_{side}"]
    ]  # fmt: skip
    is_late = data["is_time"][i] and row["runs_without"] and (row["upper"] or 0.0) >= duration
    row["censored_at"] = duration if is_late else None
    row["may_be_endless"] = bool(data["may_be_endless"][i])
    for key in ("argmin", "argmax"):
        row[key] = dict(zip(parameters, map(number, data[key][i]), strict=True))
    row["influence"] = {
        name: {key: number(data[key][i, j]) for key in _INFLUENCE}
        for j, name in enumerate(parameters)
    }
    return row


def whole_error(row: Mapping[str, Any]) -> float | None:
    """Return the error of a quantity's interval (`row`), with mesh and step if these are known."""
    return row.get("errors", {}).get("whole", row["error"])


def add_total_error(
    parts: Mapping[str, float | None], width: float | None
) -> dict[str, float | None]:
    """Add to the errors of an interval by component, None where unknown, their sum `whole`, and
    `share`, the sum over the `width` of the interval, None where there is none."""
    values: list[Any] = list(parts.values())
    whole = None if None in values else sum(values)
    if not width:  # nothing varies, or there is no interval
        return {**parts, "whole": whole, "share": 0.0 if whole == 0 and width == 0 else None}
    return {**parts, "whole": whole, "share": None if whole is None else whole / width}


def number(value: float) -> float | None:
    """Convert a number to what JSON can hold: None for NaN and infinity, else a float."""
    return float(value) if np.isfinite(value) else None


# -- surrogates ------------------------------------------------------------------------------------


def fitted_rows(numbers: np.ndarray) -> np.ndarray:
    """Choose the runs that surrogates of quantities are fitted to, of `numbers` (R, q): all of up
    to `MAX_FIT_RUNS`; else the first 4000, and each quantity's extremes and first absence."""
    if len(numbers) <= MAX_FIT_RUNS:
        return np.arange(len(numbers))
    rows = set(range(_MAX_FITTED_RUNS))
    for column in numbers.T:
        mask = np.isfinite(column)
        if mask.any():
            rows |= {int(np.nanargmin(column)), int(np.nanargmax(column))}
        if not mask.all():
            rows.add(int(np.argmin(mask)))
    return np.array(sorted(rows))


class FittedRuns(NamedTuple):
    """The R runs that surrogates of quantities rest on: `points`, `numbers`, `margins` as of
    `RunTable`. rest (S, q): quantities of the other runs of a large scan; refinement_count: how
    many of the last runs the search for bounds added; failures: runs that failed, not in R."""

    points: np.ndarray
    numbers: np.ndarray
    margins: np.ndarray
    rest: np.ndarray = np.zeros((0, 0))
    refinement_count: int = 0
    failures: tuple[list[FailedRun], list[FailedRun]] = ([], [])

    @classmethod
    def read(cls, folder: Folder, refinements: bool = True) -> "FittedRuns":
        """Read the runs from a campaign's folder: those of `samples.nc` (of a large scan those that
        `fitted_rows` chooses) and, with `refinements`, those that answers added."""
        with open_samples(folder) as samples:
            table, failures = samples.table, [samples.failures, []]
        rows = fitted_rows(table.numbers)
        tables = [RunTable(*(column[rows] for column in table))]
        if refinements:
            refinement, _, failures[1] = read_refinement(folder)
            tables.append(refinement)
        rest = np.delete(table.numbers, rows, axis=0)
        table = RunTable.join(tables)
        count = len(table.points) - len(rows)
        first, last = failures
        return cls(table.points, table.numbers, table.margins, rest, count, (first, last))

    def surrogates(self, experiment: Experiment) -> list[Any]:
        """Fit the `ScalarSurrogate` of each of an experiment's quantities to the runs, in order."""
        end, quantities = experiment.solver.duration, experiment.quantity_list
        columns = zip(quantities, self.numbers.T, self.margins.T, strict=True)
        return share_borders([
            fit_scalar(self.points, column, end if q.is_time else None, q.limits, margin)
            for q, column, margin in columns
        ])  # fmt: skip
