"""Errors that a user is meant to read."""

import errno
import shutil
from pathlib import Path

from fpm.files.seals import DamagedError

_NO_ROOM = {errno.ENOSPC, errno.EDQUOT}
_LITTLE = 64 << 20
"""Bytes of room below which that is why netCDF's library, which tells no reason, failed."""

_SAFE = "nothing there is half written, and all runs that were finished are kept"
_REMEDIES: dict[int | None, str] = {
    errno.ENOENT: "it was removed, or never made: `snakemake` or `python -m deployable run` with "
    "the campaign makes results",
    **dict.fromkeys(
        (errno.EEXIST, errno.ENOTDIR, errno.ELOOP),
        "a file, or a link that leads nowhere, is in the place of a folder: remove or rename it",
    ),
    errno.EISDIR: "a folder is in the place of a file: remove or rename it",
    **dict.fromkeys(
        (errno.EACCES, errno.EPERM, errno.EROFS),
        "allowed: files and folders that may be read, and written to, such as `run --results` of "
        "another folder",
    ),
}


class CampaignError(Exception):
    """An error that the user can mend: `str()` is the whole message. text: the message, in which
    characters that would control a terminal, as in a file's name, are replaced."""

    def __init__(self, text: str = ""):
        super().__init__("".join(s if s.isprintable() or s == "\n" else "\N{REPLACEMENT CHARACTER}"
                                 for s in text))  # fmt: skip


def error_of_files(error: Exception, folder: Path) -> CampaignError | None:
    """Turn an error of memory, or of reading or writing files, into a `CampaignError` that tells
    users the remedy; None for others. netCDF's library names no cause: a full disk is guessed."""
    if isinstance(error, DamagedError):
        advice = "remove it and call snakemake or `python -m deployable run` to have it made again"
        return CampaignError(f"{error}; {advice}")
    if isinstance(error, MemoryError):
        return CampaignError(
            f"this machine has too little memory ({error or 'no size is known'}); {_SAFE}: lower "
            "jobs.group, solver.instants or the number of responses"
        )
    library = isinstance(error, RuntimeError) and "NetCDF" in str(error)
    if not library and not isinstance(error, OSError):
        return None
    number = getattr(error, "errno", None)  # None: no system raised it
    most = _largest_file()
    if number == errno.EFBIG or (library and most is not None):
        limit = "the file system's" if most is None else f"{most / 1024:.0f} kB, `ulimit -f`"
        return CampaignError(
            f"a file in {folder} would be larger than files may be ({limit}); {_SAFE}: raise the "
            "limit and give the same command again"
        )
    place = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    free = shutil.disk_usage(place).free
    if number in _NO_ROOM or (library and free < _LITTLE):
        quota = ", but for a quota" if number == errno.EDQUOT else ""
        return CampaignError(
            f"no room to write in {folder} ({free / 2**20:.0f} MiB free{quota}); {_SAFE}: make "
            "room and give the same command again"
        )
    text = f"{getattr(error, 'filename', None) or folder}: {getattr(error, 'strerror', 0) or error}"
    remedy = _REMEDIES.get(number)
    return CampaignError(f"{text}; {remedy}" if remedy else text)


def _largest_file() -> int | None:
    """Bytes that a file of this process may have; None where nothing limits them."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    most, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
    return None if most == resource.RLIM_INFINITY else most


class ConfigError(CampaignError):
    """All problems found in a config, as the message and as attributes. source: name of the file,
    or what else the config came from; problems: sentences that start with the key."""

    def __init__(self, source: str, problems: list[str]):
        self.source = source
        self.problems = list(problems)
        count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
        super().__init__(f"{source} has {count}:\n" + "\n".join(f"  {p}" for p in problems))
