"""Check that a netCDF file holds all its data itself: HDF5 follows paths to any other file."""

import ctypes
import os
from functools import cache
from pathlib import Path
from typing import Any

from fpm.files.seals import DamagedError

_HARD, _DATASET, _VIRTUAL = 0, 5, 3
"""HDF5's codes of a link within the file, a dataset, and a layout of data in other datasets."""


def refuse_outside(path: str | Path) -> None:
    """Raise DamagedError if a file is no netCDF-4 file, may lead to other files (links, external
    storage, virtual datasets), or has groups, as no result does. Where the HDF5 library within the
    package netCDF4 cannot be called (as on Windows), nothing is checked. path: of the file."""
    if (hdf5 := _library()) is None:
        return
    file = hdf5.H5Fopen(os.fsencode(path), 0, 0)
    if file < 0:
        raise DamagedError(path, "it is no netCDF-4 file")
    try:
        info, name = (ctypes.c_uint64 * 8)(), ctypes.create_string_buffer(1024)
        hdf5.H5Gget_info(file, info)
        for number in range(info[1]):
            hdf5.H5Lget_name_by_idx(file, b".", 0, 0, number, name, len(name), 0)
            if not _is_within(hdf5, file, name.value):
                text = name.value.decode(errors="replace")
                raise DamagedError(path, f"{text!r} in it does not lie in this file")
    finally:
        hdf5.H5Fclose(file)


def _is_within(hdf5: Any, file: int, name: bytes) -> bool:
    """Whether an object of an open file is a dataset with all its numbers in the file."""
    link = (ctypes.c_int * 32)()
    if hdf5.H5Lget_info2(file, name, link, 0) < 0 or link[0] != _HARD:
        return False
    handle = hdf5.H5Oopen(file, name, 0)
    try:
        if hdf5.H5Iget_type(handle) != _DATASET:
            return False
        plist = hdf5.H5Dget_create_plist(handle)
        try:
            return hdf5.H5Pget_external_count(plist) == 0 and hdf5.H5Pget_layout(plist) != _VIRTUAL
        finally:
            hdf5.H5Pclose(plist)
    finally:
        hdf5.H5Oclose(handle)


@cache
def _library() -> Any:
    """The HDF5 that netCDF4 uses, found as one of its libraries; None if not found (Windows)."""
    import netCDF4

    library, ident, text = ctypes.CDLL(netCDF4._netCDF4.__file__), ctypes.c_int64, ctypes.c_char_p
    size, pointer = ctypes.c_size_t, ctypes.c_void_p
    try:
        for name, gives, *takes in (
            ("H5Fopen", ident, text, ctypes.c_uint, ident),
            ("H5Gget_info", ctypes.c_int, ident, pointer),
            ("H5Lget_name_by_idx", size, ident, text, ctypes.c_int, ctypes.c_int,
             ctypes.c_uint64, text, size, ident),
            ("H5Lget_info2", ctypes.c_int, ident, text, pointer, ident),
            ("H5Oopen", ident, ident, text, ident),
            ("H5Iget_type", ctypes.c_int, ident),
            ("H5Dget_create_plist", ident, ident),
            ("H5Pget_external_count", ctypes.c_int, ident),
            ("H5Pget_layout", ctypes.c_int, ident),
            ("H5Pclose", ctypes.c_int, ident),
            ("H5Oclose", ctypes.c_int, ident),
            ("H5Fclose", ctypes.c_int, ident),
        ):  # fmt: skip
            function = getattr(library, name)
            function.restype, function.argtypes = gives, takes
    except AttributeError:
        return None
    return library
