"""Errors that a user is meant to read."""

from __future__ import annotations

import errno
import shutil
from pathlib import Path

from fpm.files.sealed import DamagedError

_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


class CampaignError(Exception):
    """Something that the user can mend; `str()` is the whole message."""


def of_files(error: Exception, folder: Path) -> CampaignError | None:
    """What is to be told of trouble with the files of a campaign; None for an error of the program.

    `folder`: of its results. netCDF's library tells no reason, so that a full disk is guessed.
    """
    if isinstance(error, DamagedError):
        again = "call snakemake or `python -m deployable run` to have it made again"
        return CampaignError(f"{error}; {again}")
    library = isinstance(error, RuntimeError) and "NetCDF" in str(error)
    if not library and not isinstance(error, OSError):
        return None
    if not library and error.errno not in _NO_ROOM:
        return CampaignError(f"{error.filename or folder}: {error.strerror or error}")
    free = shutil.disk_usage(
        next(p for p in (folder, *folder.absolute().parents) if p.exists())
    ).free
    return CampaignError(
        f"no room to write in {folder} ({free / 2**20:.0f} MiB free); nothing there is half "
        "written, and all runs that were finished are kept: make room and give the same command "
        "again"
    )


class ConfigError(CampaignError):
    """All problems found in a config, one sentence each.

    Parameters
    ----------
    source : name of the file, or what else the config came from.
    problems : sentences that start with the key.
    """

    def __init__(self, source: str, problems: list[str]):
        self.source = source
        self.problems = list(problems)
        count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
        super().__init__(f"{source} has {count}:\n" + "\n".join(f"  {p}" for p in problems))
