"""netCDF's classic format (64-bit offset), written and read in one go, by scipy.

A trajectory has some thirty small variables. Creating them through HDF5 takes half as long as the
run, and netCDF's own library is no faster; scipy's writer takes little longer than copying the
numbers, and its reader notices a file that was cut off. Any netCDF library reads these files."""

import os
from collections.abc import Mapping
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np

FILE_ERRORS = (OSError, ValueError, TypeError, KeyError, IndexError, AssertionError, OverflowError)
"""What scipy's reader may raise on a file that is not whole."""


class NetcdfVariable(NamedTuple):
    """A netCDF variable. dims: names of its dimensions; values: array of numbers or text;
    attributes: by name, such as "units"."""

    dims: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Any]


def write(
    path: str | os.PathLike, attributes: Mapping[str, Any], variables: Mapping[str, NetcdfVariable]
) -> None:
    """Write a netCDF file in the classic format. path: of the file; attributes: global ones, text
    or numbers, by name; variables: by name. Text takes one more dimension, `<name>_width`, as
    characters; variables without values are left out, as the format has no empty dimensions.
    ValueError for whole numbers of more than 32 bits."""
    from scipy.io import netcdf_file

    with netcdf_file(path, "w", version=2) as file:
        _set_attributes(file, attributes)
        for name, variable in variables.items():
            dims, values, attrs = _column(name, *variable)
            dims = tuple(map(_pack, dims))
            if not values.size:
                continue
            for dim, size in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, size)
            column = file.createVariable(_pack(name), values.dtype, dims)
            column[...] = values
            _set_attributes(column, attrs)


def read(
    path: str | os.PathLike, content: bytes | None = None
) -> tuple[dict[str, Any], dict[str, NetcdfVariable]]:
    """Return the global attributes and the variables of the classic netCDF file at `path`, by name,
    text as characters. content: the file's bytes, None: they are read. Raises OSError if the file
    is not in this format, or not whole."""
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path if content is None else BytesIO(content), "r", mmap=False) as file:
            variables = {
                _unpack(name): NetcdfVariable(
                    tuple(map(_unpack, v.dimensions)), v[...], _attributes(v)
                )
                for name, v in file.variables.items()
            }
            return _attributes(file), variables
    except FileNotFoundError:
        raise
    except FILE_ERRORS:
        raise OSError(f"{os.fspath(path)} is not a whole file in netCDF's classic format") from None


def _pack(name: str) -> str:
    """Return a name for scipy, which writes Latin 1, so that the file has it in UTF-8."""
    return name.encode().decode("latin1")


def _unpack(name: str) -> str:
    return name.encode("latin1").decode()


def _column(
    name: str, dims: tuple[str, ...], values: np.ndarray, attributes: Mapping
) -> NetcdfVariable:
    """A variable in the form in which the file stores it."""
    values = np.asarray(values)
    if values.dtype.kind == "O":  # text, as xarray reads it
        values = values.astype(str)
    if values.dtype.kind == "b":
        values = values.astype(np.int8)
    if values.dtype.kind in "iu" and values.dtype.itemsize == 8:
        if np.any(values != values.astype(np.int32)):
            raise ValueError(f"{name} has integers of more than 32 bits, which the format lacks")
        values = values.astype(np.int32)
    if values.dtype.kind != "U":
        return NetcdfVariable(tuple(dims), values, attributes)
    letters = np.char.encode(values.ravel(), "utf-8")
    width = max(1, letters.dtype.itemsize)
    characters = letters.astype(f"S{width}").view("S1").reshape(*values.shape, width)
    dims = (*dims, f"{name}_width")
    return NetcdfVariable(dims, characters, {**attributes, "_Encoding": "utf-8"})


def _set_attributes(holder, attributes: Mapping[str, Any]) -> None:
    for name, value in attributes.items():
        if not isinstance(value, str):
            # Plain numbers would be kept in single precision; the format has no long integers.
            whole = isinstance(value, (int, np.integer)) and -(2**31) <= value < 2**31
            value = np.int32(value) if whole else np.float64(value)
        # Not by setattr: a name like "mode" would be taken for the file's own.
        holder._attributes[_pack(name)] = value.encode() if isinstance(value, str) else value


def _attributes(holder) -> dict[str, Any]:
    return {
        _unpack(name): value.decode() if isinstance(value, bytes) else value
        for name, value in holder._attributes.items()
    }
