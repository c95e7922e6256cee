"""A campaign's files: whole or absent, sealed (`fpm.files.seals`), and known by what they are of.

The seal of a result says, beside its name, of which `plan` it is (the digest of its runs), what
its stage made it from (`basis`, the digest of code and config), and what computed it when."""

import csv
import io
import os
import sys
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from deployable.campaign.config.sections import Experiment
from deployable.campaign.errors import CampaignError
from deployable.campaign.files.contents import data_of, experiment_of, report_damage
from deployable.campaign.files.external_links import refuse_outside
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import stamp
from fpm.files.seals import DamagedError, check, check_content, read_bytes, whole_file

__all__ = ["check_results", "csv_text", "open_dataset", "open_netcdf", "read_json", "refuse_links",
           "result_file", "whole_file", "write_result", "write_text"]  # fmt: skip

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
    seals the file (checksum and origin) and renames it to `path`. facts: texts by name for the
    seal, besides name, program and date."""
    facts = {"name": Path(path).name, **stamp(), **_FACTS.get(), **facts}
    with whole_file(path, facts) as file:
        yield file


def open_netcdf(path: str | Path) -> Any:
    """Check a result in netCDF and open it as a `netCDF4.Dataset`, with plain, not masked, arrays.
    Raises `fpm.files.seals.DamagedError` if the file is not as written."""
    import netCDF4

    _check(path)
    file = netCDF4.Dataset(path)
    file.set_auto_mask(False)
    return file


def _check(path: str | Path) -> Experiment | None:
    """The experiment of a result in netCDF that is whole, and holds what it should."""
    check(path, Path(path).name)
    refuse_outside(path)
    HISTORY.append(Path(path))
    return experiment_of(path)


HISTORY: deque[Path] = deque(maxlen=9)
"""The results that this process has opened last."""


def wrap_error(error: Exception) -> CampaignError | None:
    """Turn an error that was not foreseen into a CampaignError for the user, which names the
    results that this process opened last; None where it opened none, or with `python -X dev`."""
    if not HISTORY or sys.flags.dev_mode:
        return None
    words, paths = " ".join(str(error).split())[:200], ", ".join(dict.fromkeys(map(str, HISTORY)))
    return CampaignError(
        f"what {paths} hold led to {type(error).__name__}: {words}; `python -m deployable run` "
        "with the campaign makes results again; if that ends so too, the program is at fault: "
        "`python -X dev -m deployable` shows where"
    )


def read_json(path: str | Path) -> dict:
    """Read the data of a result in JSON, checked and without its seal. Raises
    `fpm.files.seals.DamagedError` if the file is not as written."""
    content = read_bytes(path)
    check_content(path, content, Path(path).name)
    HISTORY.append(Path(path))
    return data_of(path, content)


def check_results(folder: Folder, names: Iterable[str]) -> None:
    """Check that files of a campaign's results are as written, and all of one campaign; else raises
    DamagedError. folder: of the results; names: of the files in it, such as `bounds.nc`."""
    first: tuple[Path, Experiment] | None = None
    for path in (folder / name for name in names):
        if path.suffix == ".json":
            data, experiment = read_json(path), None
            if path == folder.plan:
                with report_damage(path):
                    experiment = Experiment.from_results(data["config"])
            if path.name == "summary.json" and first is not None:
                _check_summary(path, data, first[1])
        else:
            experiment = _check(path)
        first = first or (experiment and (path, experiment))
        if experiment is not None and experiment != first[1]:
            raise DamagedError(path, f"it is of another campaign than {first[0].name}")


def _check_summary(path: Path, data: dict, experiment: Experiment) -> None:
    for key, section in (
        ("responses", experiment.responses),
        ("quantities", experiment.quantities),
        ("parameters", experiment.intervals),
    ):
        if [row["name"] for row in data[key]] != list(section):
            raise DamagedError(path, f"its {key} have other names than those of the campaign")
    for limit in (limit for row in data.get("requirements", ()) for limit in row["limits"]):
        if limit["quantity"] not in experiment.quantities:
            raise DamagedError(path, f"{limit['quantity'][:80]!r} is no name of a quantity")
    names = set(experiment.intervals)
    for row in data["quantities"]:
        if not set(row["argmin"]) == set(row["argmax"]) == set(row["influence"]) == names:
            raise DamagedError(path, f"its {row['name']} has other parameters")


def open_dataset(path: str | Path) -> Any:
    """Check a result in netCDF and open it as an `xarray.Dataset`. Raises
    `fpm.files.seals.DamagedError` if the file is not as written."""
    import xarray

    _check(path)
    return xarray.open_dataset(path, engine="netcdf4", decode_times=False)


def refuse_links(folder: str | Path) -> None:
    """Raise CampaignError if a folder of results has anywhere a link out of it, pipe or device."""
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
                    text = f"{entry.path} is a pipe or a device; allowed: files and folders"
                    raise CampaignError(text)


def write_text(path: str | Path, text: str) -> None:
    """Write a text to the file `path` in UTF-8, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_result(path: str | Path, text: str, **facts: str) -> None:
    """Write a text to the file `path` as a result with a seal (checksum and origin), whole or not
    at all; facts: further texts by name for the seal."""
    with result_file(path, **facts) as temporary:
        temporary.write_text(text, encoding="utf-8")


def csv_text(rows: Iterable[Sequence]) -> str:
    """Write rows (sequences of texts and numbers) as CSV text, numbers with all their digits. A
    text that a spreadsheet would take for a formula gets an apostrophe in front."""
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows([*map(_cell, row)] for row in rows)
    return buffer.getvalue()


def _cell(value: Any) -> Any:
    is_formula = isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r"))
    return f"'{value}" if is_formula else value
