"""A campaign's files: whole or absent, sealed (`fpm.files.seals`), and known by what they are of.

The seal of a result says, beside its name, of which `plan` it is (the digest of its runs), what
its stage made it from (`basis`, the digest of code and config), and what computed it when."""

import csv
import io
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.config.sections import FREE_NAME, NAME
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import stamp
from fpm.files.seals import DamagedError, check, check_content, read_bytes, whole_file

ROLES = ("nominal", "node", "held_out", "further")
EVENT_VARIABLES = ("event_time", "event_contact", "event_closing")
"""Variables of events of runs, in the order of the columns of their tables."""

FAILURE_VARIABLES = ("failed_id", "failed_normalized", "failed_value", "failed_time",
                     "failed_reason")  # fmt: skip
"""Variables of runs that failed, which no other variable has."""

RUN_ID = re.compile("[0-9a-f]{16}")  # pattern of the names of runs, after which files are called

_PATTERNS = {"run_id": RUN_ID, "response": FREE_NAME, "quantity": NAME, "parameter": NAME}
"""Patterns of names, by the variable that has them."""


@contextmanager
def report_damage(path: str | os.PathLike) -> Iterator[None]:
    """Context manager for code that reads the file `path`: errors from malformed content become
    DamagedErrors; others, such as a missing file or a message for users, stay as they are."""
    try:
        yield
    except Exception as error:
        is_other = isinstance(error, OSError) and (error.errno or 0) > 0  # it is not there, say
        if is_other or isinstance(error, CampaignError | DamagedError):
            raise
        raise DamagedError(path, describe_error(error)) from error


def describe_error(error: Exception) -> str:
    """Say what of the data is wrong, by the error that reading it raised."""
    words = " ".join(str(error).split()) or type(error).__name__
    return f"{words} is missing" if isinstance(error, KeyError) else words


_FACTS: ContextVar[Mapping[str, str]] = ContextVar("facts of the results", default={})  # noqa: B039


@contextmanager
def results_of(facts: Mapping[str, str]) -> Iterator[None]:
    """Context manager in which files that `result_file` writes get `facts` into their seals
    (checksum and origin): texts by name, such as `plan`, the digest of their plan."""
    token = _FACTS.set({**_FACTS.get(), **facts})
    try:
        yield
    finally:
        _FACTS.reset(token)


@contextmanager
def result_file(path: str | Path, **facts: str) -> Iterator[Path]:
    """Context manager that yields a temporary path to write to, and at its end, without an error,
    seals the file and renames it to `path`. facts: texts by name for the seal."""
    facts = {"name": Path(path).name, **stamp(), **_FACTS.get(), **facts}
    with whole_file(path, facts) as file:
        yield file


def open_netcdf(path: str | Path) -> Any:
    """Check a result in netCDF and open it as a `netCDF4.Dataset`, with plain, not masked, arrays.
    Raises `fpm.files.seals.DamagedError` if the file is not as written, or has a name that files
    could not be called after, such as a path that leads outside."""
    import netCDF4

    check(path, Path(path).name)
    with report_damage(path), ExitStack() as stack:
        file = stack.enter_context(netCDF4.Dataset(path))
        file.set_auto_mask(False)
        for variable in _PATTERNS.keys() & file.variables.keys():
            for name in file[variable][:].ravel():
                if not _PATTERNS[variable].fullmatch(str(name)):
                    raise DamagedError(path, f"{str(name)[:80]!r} is not the name of a {variable}")
        # One that is refused is closed: HDF5 can crash on texts of a file that is open twice.
        stack.pop_all()
    return file


def read_json(path: str | Path) -> dict:
    """Read the data of a result in JSON, checked and without its seal. Raises
    `fpm.files.seals.DamagedError` if the file is not as written."""
    content = read_bytes(path)
    check_content(path, content, Path(path).name)
    with report_damage(path):
        return {key: value for key, value in json.loads(content).items() if key != "seal"}


def check_results(folder: Folder, names: Iterable[str]) -> dict[str, str]:
    """Check that files of a campaign's results are as written, and all of one plan; else raises
    DamagedError. Returns {"plan": its digest}; {} without names."""
    plans = {name: check(folder / name, name).get("plan") for name in names}
    for name, plan in plans.items():
        if plan != (first := next(iter(plans.values()))):
            text = f"it is of plan {plan}, {next(iter(plans))} of {first}"
            raise DamagedError(folder / name, text)
    return {"plan": str(first)} if plans else {}


def open_dataset(path: str | Path) -> Any:
    """Check a result in netCDF and open it as an `xarray.Dataset`. Raises `DamagedError`."""
    import xarray

    open_netcdf(path).close()
    return xarray.open_dataset(path, engine="netcdf4", decode_times=False)


def write_text(path: str | Path, text: str) -> None:
    """Write a text to the file `path` in UTF-8, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_result(path: str | Path, text: str, **facts: str) -> None:
    """Write a text to the file `path` as a result with a seal, whole or not at all."""
    with result_file(path, **facts) as temporary:
        temporary.write_text(text, encoding="utf-8")


def csv_text(rows: Iterable[Sequence]) -> str:
    """Write rows (sequences of texts and numbers) as CSV text, numbers with all their digits. A
    text that a spreadsheet would take for a formula gets an apostrophe in front."""
    buffer, starts = io.StringIO(), ("=", "+", "-", "@", "\t", "\r")
    csv.writer(buffer, lineterminator="\n").writerows(
        [f"'{x}" if isinstance(x, str) and x.startswith(starts) else x for x in row] for row in rows
    )
    return buffer.getvalue()


# -- variables of netCDF, as `variables.json` states them -----------------------------------------
# A row of that file is of the variables of a result: dimensions; `text` or `number`; names; unit,
# and what it is. A text in the place of a row stands for all rows of that name.


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
    text = Path(__file__).with_name("variables.json").read_text(encoding="utf-8")
    for row in json.loads(text).get(result, ()):
        if isinstance(row, str):
            variables |= variables_of(row)
            continue
        dims, content, names, units, long_name = (*row, "", "")[:5]
        attributes = {"units": units} if units else {}
        attributes |= {"long_name": long_name} if long_name else {}
        spec = VariableSpec(tuple(dims.split()), content, attributes)
        variables |= dict.fromkeys(names.split(), spec)
    return variables


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
