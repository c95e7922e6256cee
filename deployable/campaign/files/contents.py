"""What results in netCDF are made of, checks of names in them, and errors of those that cannot be
read. Files are called after some names, so that these are checked wherever a file is opened."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from deployable.campaign.config.sections import NAME
from deployable.campaign.errors import CampaignError, HeldConfigError
from fpm.files.seals import DamagedError

ROLES = ("nominal", "node", "held_out", "further")
EVENT_VARIABLES = ("event_time", "event_contact", "event_closing")
"""Variables of events of runs, in the order of the columns of their tables."""

FAILURE_VARIABLES = ("failed_id", "failed_normalized", "failed_value", "failed_time",
                     "failed_reason")  # fmt: skip
"""Variables of runs that failed, which no other variable has."""

RUN_ID = re.compile("[0-9a-f]{16}")  # pattern of the names of runs, after which files are called

_PATTERNS = {"run_id": RUN_ID, "response": NAME, "quantity": NAME, "parameter": NAME}
"""Patterns of names, by the variable that has them."""


def check_names(path: Path, file: Any) -> None:
    """Raise DamagedError if an open `netCDF4.Dataset` (`file`, at `path`) has a name that files
    could not be called after, such as a path that leads outside."""
    for variable in _PATTERNS.keys() & file.variables.keys():
        for name in file[variable][:].ravel():
            if not _PATTERNS[variable].fullmatch(str(name)):
                raise DamagedError(path, f"{str(name)[:80]!r} is no name of a {variable}")


@contextmanager
def report_damage(path: str | os.PathLike) -> Iterator[None]:
    """Context manager for code that reads the file `path`: errors from malformed content become
    DamagedErrors; others, such as a missing file or a message for users, stay as they are."""
    try:
        yield
    except Exception as error:
        is_other = isinstance(error, OSError) and (error.errno or 0) > 0  # it is not there, say
        is_ours = isinstance(error, CampaignError) and not isinstance(error, HeldConfigError)
        if is_other or is_ours or isinstance(error, DamagedError):
            raise
        words = " ".join(str(error).split()) or type(error).__name__
        is_missing = isinstance(error, LookupError)
        raise DamagedError(path, f"{words} is missing" if is_missing else words) from error
