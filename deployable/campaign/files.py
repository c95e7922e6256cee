"""A campaign's files: whole or absent, sealed (`fpm.files.sealed`), and known by what they are of.

The seal of a result says, beside its name, of which `plan` it is (the digest of its runs), what
its stage made it from (`basis`, the digest of code and config), and what computed it when.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import NAME
from deployable.campaign.errors import CampaignError
from deployable.campaign.outside import refuse_outside
from deployable.campaign.plan.runs import RUN_ID
from deployable.campaign.provenance import check_code, dated
from fpm.files.sealed import DamagedError, check, whole_file

__all__ = ["csv_text", "open_dataset", "open_netcdf", "refuse_links", "result_file", "whole_file",
           "write_result", "write_text"]  # fmt: skip

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
    refuse_outside(path)
    file = netCDF4.Dataset(path)
    file.set_auto_mask(False)
    _check_names(path, file)
    return file


def open_dataset(path: str | Path) -> Any:
    """An open `xarray.Dataset` of a result; raises `fpm.files.sealed.DamagedError`."""
    import xarray

    check(path, Path(path).name)
    refuse_outside(path)
    file = xarray.open_dataset(path, engine="netcdf4")
    _check_names(path, file)
    return file


_NAMED = {
    "response": NAME.fullmatch,
    "quantity": NAME.fullmatch,
    "parameter": str.isidentifier,
    "run_id": RUN_ID.fullmatch,
}
"""Variables of results after which files, or other variables, are called, and what tells whether a
name may be: results may come from anybody."""


def _check_names(path: str | Path, file: Any) -> None:
    """DamagedError for an open file that has what is no name where a name should be."""
    for variable in _NAMED.keys() & file.variables.keys():
        for name in np.ravel(file.variables[variable][:]).tolist():
            if not isinstance(name, str) or not _NAMED[variable](name):
                file.close()
                raise DamagedError(path, f"{str(name)[:80]!r} is no name of a {variable}")


def refuse_links(folder: str | Path) -> None:
    """CampaignError for what nobody follows or waits for in a folder of results, which may come
    from anybody: a link to what lies outside, a pipe, a device."""
    whole, places = os.path.realpath(folder), [folder]
    while places:
        with suppress(FileNotFoundError, NotADirectoryError), os.scandir(places.pop()) as entries:
            for entry in entries:
                if entry.is_symlink():
                    target = os.path.realpath(entry.path)
                    if os.path.commonpath([whole, target]) != whole:
                        raise CampaignError(
                            f"{entry.path} is a link to {target}, outside of the results, and is "
                            "not followed; allowed: what it links to in its place, or a link in "
                            f"the place of the whole folder {folder}"
                        )
                elif entry.is_dir(follow_symlinks=False):
                    places.append(entry.path)
                elif not entry.is_file(follow_symlinks=False):
                    raise CampaignError(
                        f"{entry.path} is a pipe or a device; allowed: files and folders"
                    )


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_result(path: str | Path, text: str, **facts: str) -> None:
    """Write a text file that is a result."""
    with result_file(path, **facts) as temporary:
        temporary.write_text(text, encoding="utf-8")


def csv_text(rows: Iterable[Sequence]) -> str:
    """Rows as CSV, numbers with all their digits; a text that would be a formula in a spreadsheet
    begins with an apostrophe."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([*map(_cell, row)] for row in rows)
    return out.getvalue()


def _cell(value: Any) -> Any:
    is_formula = isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r"))
    return f"'{value}" if is_formula else value
