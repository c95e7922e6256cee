"""Runs of a user's own: rows of a CSV file, or values of one parameter (section `design`)."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from fpm.arithmetic.units import Unit, unit
from fpm.errors import did_you_mean
from fpm.structures.curves_file import NO_UNIT, CsvTable, CurvesFileError

LABELS = ("", "run", "id", "no", "number", "name", "note")
"""Names of columns that are of no parameter, in lower case."""

CONSTANT_TEXT = "No run varies {}, so no bound and no answer includes its influence."


class OwnRunsError(ValueError):
    """Raised for runs that cannot be made; its text begins with a key of the section `design`."""


def file_digest(path: str | None) -> str:
    """Return a digest of the file of runs at `path`; "" for none, or one that cannot be read."""
    with suppress(CurvesFileError):
        return CsvTable(path).digest if path else ""
    return ""


def key_problems(user_config: Mapping) -> Iterator[str]:
    """Yield a sentence for each key of a config without defaults that own runs exclude."""
    design = user_config.get("design", {})
    if kind := next((key for key in ("file", "values") if key in design), ""):
        keys = [f"design.{key}" for key in design if key != kind]
        for key in keys + ["held_out"] * ("held_out" in user_config):
            yield f"{key}: not allowed beside design.{kind}; allowed: one of the two"


def own_points(experiment: Any) -> np.ndarray:
    """Return the points (N, k), from -1 to 1, of the runs that the section `design` of an
    experiment states, with nominal values where it states none. Raises `OwnRunsError`."""
    design, intervals = experiment.design, experiment.intervals
    free = [name for name, i in intervals.items() if i.lower < i.upper]
    if design.file:
        try:
            columns, places = _read_columns(design, experiment)
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
        for row in np.flatnonzero((column < lower - rounding) | (column > upper + rounding)):
            text = f"{places[row]}: {name} = {column[row]:.9g} is outside its interval"
            raise OwnRunsError(f"{text}; allowed: {lower:.9g} to {upper:.9g}")
        values[:, [*intervals].index(name)] = np.clip(column, lower, upper)
    if not np.ptp([experiment.nominal, *values], axis=0).any():
        text = "no run differs from the nominal one; allowed: at least one that does"
        raise OwnRunsError(f"{'file' if design.file else 'values'}: {text}")
    return experiment.box.to_unit(values)


def _read_columns(design: Any, experiment: Any) -> tuple[dict[str, np.ndarray], list[str]]:
    """Values of the parameters in the file of runs, by name, and the place of each row."""
    table, columns, names = CsvTable(design.file), {}, ", ".join(experiment.intervals)
    if design.digest not in ("", table.digest):
        table.refuse(1, "it changed since it was checked; allowed: the campaign again")
    table.refuse_decimal_commas(experiment.intervals)
    for number, name in enumerate(table.names):
        if name in experiment.intervals:
            symbol = experiment.scene_type.parameters[name].unit.replace("degree", "deg")
            si_unit, column_unit = unit(symbol), table.units[number]
            columns[name] = table.numbers(number, si_unit) / si_unit.si(1.0)
            if isinstance(column_unit, Unit) and not column_unit.fits(si_unit):
                table.refuse(table.head, f"the unit of {name} does not fit; allowed: {symbol}")
        elif name.lower() not in LABELS:
            fault = table.units[number]
            if isinstance(fault, str) and fault != NO_UNIT:
                table.refuse(table.head, f"{name}: {fault}")
            missing = ", ".join(n for n in experiment.intervals if n not in table.names)
            word = name.replace("±", " ").partition(" ")[0]
            text = f"there is no interval {name}{did_you_mean(word, experiment.intervals)}"
            text += f", and no column {missing}" if missing else ""
            table.refuse(table.head, f"{text}; allowed: {names}, and `run` or `note`")
    if not columns:
        table.refuse(table.head, f"no column of a parameter; allowed: {names}")
    return columns, [f"file: {design.file}, line {line}" for line, _ in table.rows]
