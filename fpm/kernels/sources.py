"""A digest of source code that changes with what the code does, not with how it is written.

Numbers come from code in memory, names from files: so the files of a package are noted before they
are imported (`PackageFiles`); one that has changed since is refused where something is named."""

import ast
import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from fpm.errors import ChangedError

PACKAGE = Path(__file__).parents[1]

READ = ("reading", "travel")
"""Folders of the mechanics that read numbers off a run. What is recorded on request, and what is
kept of runs in the place of their curves, has their digest beside the run's; curves that are kept
do not depend on them."""

DISPLAY = (
    *("errors.py", "motions", "scenes/effort.py"),
    *(f"structures/{name}.py" for name in ("describe", "plausible", "report")),
)
"""Files and folders that decide no number that is kept of a run: words, prices, and motions that
are made again with every page. Everything else of the mechanics counts in the names of runs."""

CODE = (".py", ".html", ".jinja", ".css", ".js", ".yaml", ".json")
"""Files of a package that decide about results, by how they end."""

LINKS = "program_data/"
"""Folders that end so hold what does not decide: workflow and campaigns that are shipped along."""

VERSION = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:8]
"""Digest of this file, so that digests kept on disk by another version of it are not met."""

State = tuple[int, ...]
"""What tells a file that was changed from before, without reading it."""


def state_of(stat: os.stat_result) -> State:
    """Return what tells a changed file, out of os.stat's result: inode, size, mtime, ctime (ns)."""
    return stat.st_ino, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns


class PackageFiles:
    """Files of a package as they are when this object is made, which has to be before their import:
    a digest of them is one of the code in memory then, and a later change is found. folder: of the
    package; files in it are named by their paths below it. files: None, or, if the package was
    imported already, os.stat results of its Python files by path, from before that."""

    def __init__(self, folder: Path, files: Mapping[Path, os.stat_result] | None = None):
        self.folder = folder
        self._states = dict(_states(folder))
        if files is not None:
            data = {n: state for n, state in self._states.items() if not n.endswith(".py")}
            stats = {path.relative_to(folder): state_of(stat) for path, stat in files.items()}
            code = {p.as_posix(): s for p, s in stats.items() if LINKS not in p.parent.as_posix()}
            self._states = data | code
        self._digests_of: dict[tuple, str] = {}
        # Whatever is not imported is read whenever it is used.
        self._data = [name for name in self._states if not name.endswith(".py")]
        self._foreign_modules: set[str] = set()
        self._specs: dict[str, object] = {}

    def digest(self, include: tuple[str, ...] = (), exclude: tuple[str, ...] = ()) -> str:
        """Return the first 16 hex digits of the SHA-256 of some of the package's files, without
        comments, formatting and docstrings of Python files. include: files and folders (paths in
        it), (): all; exclude: those left out. Raises ChangedError as `check` does."""
        self.check()
        if (include, exclude) not in self._digests_of:
            names = (n for n in self._states if not include or _is_within(n, include))
            digests = [(n, self._digest(n)) for n in sorted(names) if not _is_within(n, exclude)]
            self._digests_of[include, exclude] = _sha256(digests)[:16]
        return self._digests_of[include, exclude]

    def check(self, reread: bool = False) -> None:
        """Check that the package's code in memory is that of its files when this object was made;
        raises ChangedError if it may not be. reread=False: a Python file is compared once after
        each of its imports, so that later changes of it are no error; True: all that are imported
        are compared. Other files are compared at every call."""
        start, package = f"{self.folder}{os.sep}", self.folder.name
        for module in sys.modules.keys() - self._foreign_modules:
            if module.partition(".")[0] != package:
                self._foreign_modules.add(module)
                continue
            spec = getattr(sys.modules[module], "__spec__", None)  # another one at every import
            file = getattr(sys.modules[module], "__file__", None) or ""
            if (reread or self._specs.get(module) is not spec) and file.startswith(start):
                self._check(file.removeprefix(start).replace(os.sep, "/"))
            self._specs[module] = spec
        for name in self._data:
            self._check(name)

    def _check(self, name: str) -> None:
        path = self.folder / name
        try:
            if state_of(path.stat()) == self._states.get(name):
                return
            if tree_digest(path) == self._digests[name]:  # touched, or changed and changed back
                return
        except (OSError, KeyError, SyntaxError):
            pass
        raise ChangedError(f"{self.folder.name}/{name}")

    def _digest(self, name: str) -> str:
        if name not in self._digests:
            raise ChangedError(f"{self.folder.name}/{name}")
        return self._digests[name]

    @cached_property
    def _digests(self) -> dict[str, str]:
        """Digests of all files that are as they were, kept on disk by what tells a change."""
        key = repr((str(self.folder), sorted(self._states.items())))
        return _recall(key.encode(), lambda: dict(self._read_digests()))

    def _read_digests(self) -> Iterator[tuple[str, str]]:
        for name, state in self._states.items():
            path = self.folder / name
            with suppress(OSError, SyntaxError):
                digest = tree_digest(path)
                if state_of(path.stat()) == state:
                    yield name, digest


def _states(folder: str | Path, prefix: str = "") -> Iterator[tuple[str, State]]:
    for entry in os.scandir(folder):
        if entry.is_dir(follow_symlinks=False):
            if entry.name != "__pycache__" and not prefix.endswith(LINKS):
                yield from _states(entry.path, f"{prefix}{entry.name}/")
        elif entry.name.endswith(CODE):
            with suppress(FileNotFoundError):  # a dangling link, as editors leave them for a lock
                yield prefix + entry.name, state_of(entry.stat())


def _is_within(name: str, places: tuple[str, ...]) -> bool:
    """Whether a file is one of some, or in one of some folders."""
    return any(name == place or name.startswith(f"{place}/") for place in places)


def _sha256(data: object) -> str:
    return hashlib.sha256((data if isinstance(data, str) else repr(data)).encode()).hexdigest()


MECHANICS = PackageFiles(PACKAGE)
"""Files of the package fpm, which imports this module before all others, as they were then."""


def digest_mechanics() -> str:
    """Return a digest (16 hex digits) of all files of fpm that can change what runs record."""
    return MECHANICS.digest(exclude=READ + DISPLAY)


def digest_reading() -> str:
    """Return a digest (16 hex digits) of the files of fpm that read numbers off a run (READ)."""
    return MECHANICS.digest(include=READ)


def kernels() -> str:
    """Return a digest (16 hex digits) of the source files of fpm that are compiled: those in its
    folders `elements` and `kernels`, as they were when fpm was imported. It is part of the name of
    the cache's folder, so that compiled code of other sources is not used."""
    return MECHANICS.digest(include=("elements", "kernels"))


def syntax_digest(paths: Iterable[Path]) -> str:
    """Return the first 16 hex digits of a SHA-256 of the syntax trees of Python files, and of every
    byte of other files. Comments, formatting and docstrings do not count, nor folders and the order
    of `paths`; file names do. SyntaxError for a `.py` that is no Python."""
    return _sha256(sorted((path.name, tree_digest(path)) for path in paths))[:16]


def tree_digest(path: Path) -> str:
    """Return a SHA-256 (hex) of the syntax tree without docstrings of the Python file at `path`, so
    that comments do not count, or of another file's bytes. It is kept on disk, as to parse takes a
    hundred times longer than to read; a cache that can not be written is done without."""
    content = path.read_bytes()
    if path.suffix != ".py":
        return hashlib.sha256(content).hexdigest()
    return _tree_digest(content, str(path))


@cache
def _tree_digest(content: bytes, path: str) -> str:
    return _recall(content, lambda: _sha256(_tree(content, path)))


def _recall(key: bytes, find: Callable[[], Any]) -> Any:
    """What `find` returns, as JSON can say it; kept on disk by what it follows from, `key`."""
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    name = f"{hashlib.sha256(key).hexdigest()}-{version}-{VERSION}"
    folder = os.path.join(_cache_path(), "syntax")  # no Path: there are hundreds in each process
    with suppress(OSError, ValueError), open(os.path.join(folder, name), encoding="utf-8") as memo:
        return json.loads(memo.read())
    value = find()
    with suppress(OSError):
        os.makedirs(folder, exist_ok=True)
        part = Path(folder, f"{name}.{os.getpid()}")
        part.write_text(json.dumps(value), encoding="utf-8")
        os.replace(part, os.path.join(folder, name))
    return value


def user_cache() -> Path:
    """Return this program's own folder in the user's cache (~/.cache, or XDG_CACHE_HOME), for files
    that can be made again; it need not exist."""
    return Path(_cache_path())


def _cache_path() -> str:
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(home, "deployable-intervals")


def _tree(content: bytes, path: str) -> str:
    """The syntax tree of a file as text, without bare strings (docstrings)."""
    tree = ast.parse(content, path)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [statement for statement in body if not _is_text(statement)]
    return ast.dump(tree)


def _is_text(statement: ast.AST) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )
