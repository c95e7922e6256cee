"""A digest of source files, after which compiled code, runs and results are named."""

import hashlib
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[1]

CODE = (".py", ".html", ".jinja", ".css", ".js", ".yaml", ".json")
"""Endings of the files of a package that decide about results."""


@cache
def digest(*places: Path) -> str:
    """Return a digest (16 hex digits) of the bytes and names of all source files in some folders,
    and of single files, `places`. It is taken once in a process."""
    files = sorted(file for place in places for file in _files(place))
    hashes = [(name, hashlib.sha256(path.read_bytes()).hexdigest()) for name, path in files]
    return hashlib.sha256(repr(hashes).encode()).hexdigest()[:16]


def _files(place: Path) -> Iterator[tuple[str, Path]]:
    """Yield the name, relative to the folder around `place`, and path of each source file in it."""
    if place.is_file():
        yield place.name, place
    for folder, subfolders, names in os.walk(place):
        if os.path.basename(folder) == "program_data":
            subfolders.clear()  # what is copied for users changes no result
        for path in (Path(folder, name) for name in names if name.endswith(CODE)):
            if path.is_file():  # no link that leads nowhere, as editors leave them for a lock
                yield path.relative_to(place.parent).as_posix(), path


def user_cache() -> Path:
    """Return this program's folder in the user's cache (~/.cache, or XDG_CACHE_HOME), for files
    that can be made again. It need not exist."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(home, "deployable-intervals")
