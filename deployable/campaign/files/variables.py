"""What results in netCDF hold, as `variables.json` states it, by which they are written.

A row of the file is of the variables of a result: dimensions; `text` or `number`; names; unit, and
what it is. A text in the place of a row stands for all rows of that name."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np


class VariableSpec(NamedTuple):
    """A variable of a result in netCDF: its dimensions; what it holds:
    "text" or "number"; and its `attributes`: `long_name` and, if there is a single one, `units`."""

    dims: tuple[str, ...]
    content: str
    attributes: dict[str, str]


@cache
def variables_of(result: str) -> dict[str, VariableSpec]:
    """Variables of a result by name of its file; {} for one of which nothing is stated."""
    variables: dict[str, VariableSpec] = {}
    for row in _tables().get(result, ()):
        if isinstance(row, str):
            variables |= variables_of(row)
            continue
        dims, content, names, units, text = (*row, "", "")[:5]
        attributes = {"units": units} if units else {}
        attributes |= {"long_name": text} if text else {}
        spec = VariableSpec(tuple(dims.split()), content, attributes)
        variables |= dict.fromkeys(names.split(), spec)
    return variables


@cache
def _tables() -> dict[str, list]:
    return json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))


def create(
    file: Any, result: str, name: str, values: Any = None, kind: Any = "f8", **options
) -> Any:
    """Create a variable of a result in an open `netCDF4.Dataset` with its dimensions, which exist
    but for one that it names itself, and attributes, and return it. values: None for none yet;
    kind: netCDF's type of numbers; options: of `createVariable`."""
    dims, content, attributes = variables_of(result)[name]
    if content == "text":
        kind, values = str, np.array([str(value) for value in values], dtype=object)
    if name in dims:
        file.createDimension(name, len(values))
    variable = file.createVariable(name, kind, dims, **options)
    variable.setncatts(attributes)
    if np.size(values) and values is not None:
        variable[:] = values
    return variable


def dataset_of(result: str, columns: Mapping[str, Any], attributes: Mapping[str, Any]) -> Any:
    """Make the `xarray.Dataset` of a result from the values of its variables and its attributes."""
    import xarray as xr

    specs, coordinates = variables_of(result), variables_of("answers")
    variables = {name: (specs[name].dims, np.array(values), specs[name].attributes)
                 for name, values in columns.items()}  # fmt: skip
    coords = {name: variables.pop(name) for name in coordinates if name in variables}
    return xr.Dataset(variables, coords, attributes)
