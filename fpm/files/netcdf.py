"""netCDF files written in one go, from arrays that are whole."""

import os
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np


class NetcdfVariable(NamedTuple):
    """A netCDF variable. dims: names of its dimensions; values: array of numbers or text;
    attributes: by name, such as "units"; options: of `netCDF4.Dataset.createVariable`, and `kind`,
    the type in the file, if it is not that of the values."""

    dims: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Any] = {}
    options: Mapping[str, Any] = {}


def write(
    path: str | os.PathLike, attributes: Mapping[str, Any], variables: Mapping[str, NetcdfVariable]
) -> None:
    """Write a new netCDF-4 file. path: of the file; attributes: global ones by name; variables: by
    name; a dimension is as long as the first variable along it."""
    import netCDF4

    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(attributes)
        for name, (dims, values, attrs, options) in variables.items():
            values = np.asarray(values)
            for dim, size in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size)
            is_text = values.dtype.kind in "OU"
            options = {"kind": str if is_text else values.dtype, **options}
            column = file.createVariable(name, options.pop("kind"), dims, **options)
            column.setncatts(attrs)
            if values.size:
                column[...] = values.astype(object) if is_text else values
