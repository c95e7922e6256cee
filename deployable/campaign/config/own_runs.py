"""Runs of a user's own: rows of a CSV file, or values of one parameter (section `design`)."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from fpm.arithmetic.units import unit
from fpm.errors import did_you_mean
from fpm.structures.curves_file import CsvTable, CurvesFileError

LABELS = ("", "run", "id", "no", "number", "name", "note")
"""Names of columns that are of no parameter, in lower case."""


class OwnRunsError(ValueError):
    """Raised for runs that cannot be made; its text begins with a key of the section `design`."""


def file_digest(path: str | None) -> str:
    """Return a digest of the file of runs at `path`; "" for none, or one that cannot be read."""
    with suppress(CurvesFileError):
        return CsvTable(path).digest if path else ""
    return ""


def key_problems(user_config: Mapping) -> list[str]:
    """Return a sentence for each key that does not go with runs of one's own in a config that is
    without defaults."""
    design = user_config.get("design", {})
    kinds = [key for key in ("file", "values") if key in design]
    keys = [f"design.{key}" for key in design if key not in kinds[:1]]
    keys += ["held_out"] * ("held_out" in user_config)
    text = f"not allowed beside design.{kinds[0] if kinds else ''}; allowed: one of the two"
    return [f"{key}: {text}" for key in keys] if kinds else []


def own_points(experiment: Any) -> np.ndarray:
    """Return the points (N, k), from -1 to 1, of the runs that the section `design` of an
    experiment states, with nominal values where it states none. Raises `OwnRunsError`."""
    design, intervals = experiment.design, experiment.intervals
    free = [name for name, i in intervals.items() if i.lower < i.upper]
    if design.file:
        try:
            columns, places = _read_columns(design.file, experiment)
        except CurvesFileError as error:
            raise OwnRunsError(f"file: {error}") from None
    elif len(free) != 1:
        text = f"they are of one parameter, and the intervals are of {', '.join(free)}"
        raise OwnRunsError(f"values: {text}; allowed: a `file` with a column for each")
    else:
        columns = {free[0]: np.array(design.values)}
        places = [f"values[{row}]" for row in range(len(design.values))]
    values = np.tile(np.array(experiment.nominal, dtype=float), (len(places), 1))
    for name, column in columns.items():
        lower, upper = intervals[name].lower, intervals[name].upper
        rounding = 1e-12 * max(abs(lower), abs(upper))  # of units
        for place, value in zip(places, column, strict=True):
            if not lower - rounding <= value <= upper + rounding:
                text = f"{name} = {value:.9g} is outside its interval"
                raise OwnRunsError(f"{place}: {text}; allowed: {lower:.9g} to {upper:.9g}")
        values[:, [*intervals].index(name)] = np.clip(column, lower, upper)
    return experiment.box.to_unit(values)


def _read_columns(path: str, experiment: Any) -> tuple[dict[str, np.ndarray], list[str]]:
    """Values of the parameters in the file `path`, by name, and the place of each row."""
    table, columns = CsvTable(path), {}
    if experiment.design.digest not in ("", table.digest):
        raise CurvesFileError(
            f"{path}: it changed since it was checked; allowed: the campaign again"
        )
    for number, name in enumerate(table.names):
        if name not in experiment.intervals:
            if name.lower() not in LABELS:
                text = (
                    f"the column {name} is of no interval{did_you_mean(name, experiment.intervals)}"
                )
                names = ", ".join(experiment.intervals)
                table.refuse(table.head, f"{text}; allowed: {names}, and `run` or `note`")
            continue
        symbol = experiment.scene_type.parameters[name].unit.replace("degree", "deg")
        parameter_unit, column_unit = unit(symbol), table.units[number]
        numbers = table.numbers(number, parameter_unit)
        has_unit = not isinstance(column_unit, str)
        if has_unit and column_unit.dimension.powers != parameter_unit.dimension.powers:
            table.refuse(table.head, f"the unit of {name} does not fit; allowed: {symbol}")
        columns[name] = numbers / parameter_unit.si(1.0)
    if not columns:
        names = ", ".join(experiment.intervals)
        table.refuse(table.head, f"no column of a parameter; allowed: {names}")
    return columns, [f"file: {path}, line {line}" for line in table.lines]
