"""A campaign's files: whole or absent, sealed (`fpm.files.sealed`), and known by what they are of.

The seal of a result says, beside its name, of which `plan` it is (the digest of its runs), what
its stage made it from (`basis`, the digest of code and config), and what computed it when.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from deployable.campaign.provenance import check_code, dated
from fpm.files.sealed import check, whole_file

__all__ = ["open_dataset", "open_netcdf", "result_file", "whole_file", "write_result", "write_text"]

_FACTS: ContextVar[Mapping[str, str]] = ContextVar("facts of the results", default={})  # noqa: B039


@contextmanager
def results_of(facts: Mapping[str, str]) -> Iterator[None]:
    """What results written inside this block say of themselves beside their names."""
    token = _FACTS.set({**_FACTS.get(), **facts})
    try:
        yield
    finally:
        _FACTS.reset(token)


@contextmanager
def result_file(path: str | Path, **facts: str) -> Iterator[Path]:
    """A temporary path of a result: sealed and renamed when the block ends without an error, if the
    program is still the one that was imported."""
    with whole_file(path, {"name": Path(path).name, **dated(), **_FACTS.get(), **facts}) as made:
        yield made
        check_code()


def open_netcdf(path: str | Path) -> Any:
    """An open `netCDF4.Dataset` of a result with plain arrays; its import is faster than xarray's.

    Raises `fpm.files.sealed.DamagedError`.
    """
    import netCDF4

    check(path, Path(path).name)
    file = netCDF4.Dataset(path)
    file.set_auto_mask(False)
    return file


def open_dataset(path: str | Path) -> Any:
    """An open `xarray.Dataset` of a result; raises `fpm.files.sealed.DamagedError`."""
    import xarray

    check(path, Path(path).name)
    return xarray.open_dataset(path)


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_result(path: str | Path, text: str, **facts: str) -> None:
    """Write a text file that is a result."""
    with result_file(path, **facts) as temporary:
        temporary.write_text(text, encoding="utf-8")
