"""What a structure in Python opens while it is loaded and built: its digest is made of all that.

Python tells of every file that it opens itself, also of those that a helper opens while it is
imported. Compiled code of other packages opens files unseen, and so do other programs: a structure
that has such code is refused, unless it names its files itself (`DATA`).
"""

import glob
import hashlib
import importlib.util
import os
import re
import sys
import sysconfig
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib.machinery import ExtensionFileLoader, SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import Any

from fpm.errors import ChangedError, SceneError
from fpm.kernels import sources

SEEN = {"numpy", "scipy", "numba", "fpm"}
"""Packages beside Python's own whose compiled code opens files by Python only."""

UNSEEN = {
    "__import__", "asyncio", "concurrent", "ctypes", "dbm", "importlib", "multiprocessing", "runpy",
    "shelve", "socket", "subprocess", "threading",
}  # fmt: skip
"""Of Python itself, by which a file is read, or code run, that cannot be seen."""

EVENTS = {
    "subprocess.Popen", "os.system", "os.exec", "os.fork", "os.forkpty", "os.posix_spawn",
    "os.spawn", "socket.connect",
}  # fmt: skip
"""The same, as Python tells of it while it happens."""

STATED = 'with DATA = ["tables/*.csv"], patterns of all files that it reads, [] for none'
"""What makes up for what is not seen."""

_PROGRAM = tuple(str(sources.PACKAGE.parent / name) for name in ("fpm", "deployable"))


class Opened:
    """The files of one structure, in `path`: all that it opened so far, by digest.

    What is opened later on, by a build at other values, has to be among them as it was; else a
    SceneError says so, since the structure has a name already.
    """

    def __init__(self, path: Path):
        self.path, self.folder = path, path.parent
        self.files: dict[Path, str] = {}
        self.unseen: list[str] = []
        self.modules: dict[str, ModuleType] = {}
        self.data: tuple[str, ...] | None = None
        self._states: dict[Path, sources.State | None] = {}
        self._now: dict[Path, sources.State | None] = {}
        self._made: set[Path] = set()

    # -- while it runs --------------------------------------------------------------------------

    @contextmanager
    def watched(self) -> Iterator[None]:
        """See what this thread opens, with modules of the structure's own: another structure, or
        who loads it, may have others of the same names, or of the same files as they were."""
        _hook()
        before, _WATCHED.by = watching(), self
        others = _own_modules()
        for name in others:
            del sys.modules[name]
        sys.modules.update(self.modules)
        sys.meta_path.insert(0, finder := _Finder(self))
        try:
            yield
        finally:
            sys.meta_path.remove(finder)
            self.modules = _own_modules()
            for name in self.modules:
                del sys.modules[name]
            sys.modules.update(others)
            _WATCHED.by = before

    def note(self, file: Any, flags: int) -> None:
        """Note a file that is opened."""
        if not isinstance(file, str | bytes | os.PathLike):
            return  # by its number: it was opened before
        name = os.path.realpath(os.fsdecode(file))
        if is_installed(name) or name.startswith(("/dev/", "/proc/", "/sys/")):
            return
        if "__pycache__" in name:
            return
        path = Path(name)
        if flags & (os.O_TRUNC | os.O_EXCL):
            self._made.add(path)
        elif flags & os.O_ACCMODE != os.O_WRONLY and path not in self._made:
            self._now.setdefault(path, _state(path))

    def imported(self, path: Path, content: bytes) -> None:
        """Note a file of code as it is imported."""
        path = Path(os.path.realpath(path))
        self._now.pop(path, None)
        digest = sources.content_digest(content, path)
        if self.files.setdefault(path, digest) != digest:
            raise ChangedError(str(path))

    # -- afterwards -----------------------------------------------------------------------------

    def seal(self, data: Iterable[str] | None) -> str:
        """The digest of the structure, when it has been loaded and built at its defaults.

        data: patterns of the files that it says to read, None if it says nothing. ChangedError
        where a file is not what was read.
        """
        self.data = None if data is None else tuple(data)
        code = sources.own_sources(self.path, *(p for p in self.files if p.suffix == ".py"))
        for path in (*code, *self._now, *self._stated()):
            self.files.setdefault(path, _digest(path))
        for path, state in self._now.items():
            if path not in self._made and _state(path) != state:
                raise ChangedError(str(path))
        self._now.clear()
        self._states = {path: _state(path) for path in self.files}
        found = sorted((os.path.relpath(p, self.folder), d) for p, d in self.files.items())
        return hashlib.sha256(repr(found).encode()).hexdigest()[:16]

    def check(self, values: Mapping[str, Any]) -> None:
        """SceneError where a build at some values opened what had not been opened before, or is
        another now."""
        opened, self._now = {*self._now, *self._stated()}, {}
        if self.unseen and self.data is None:
            raise SceneError(f"{self.path.name} at {dict(values)}", self.unseen, STATED)
        for path in sorted(opened):
            if path not in self.files:
                raise SceneError(
                    f"{self.path.name} at {dict(values)}", f"opens {path}",
                    "files that it opens at its default values, too, or names in "
                    'DATA = ["tables/*.csv"]: its results are named after their content',
                )  # fmt: skip
            if not self._is_same(path):
                raise ChangedError(str(path))

    def is_same(self) -> bool:
        """Whether all files are what they were."""
        return all(map(self._is_same, self.files)) and self._stated() <= set(self.files)

    def _is_same(self, path: Path) -> bool:
        return _state(path) == self._states.get(path, ()) or _digest(path) == self.files[path]

    def follow(self, before: "Opened") -> None:
        """ChangedError where the same code, loaded before, opened a file that changed, and does not
        open it any more: what it gives is what some library has in memory."""
        code = [path for path in before.files if path.suffix == ".py"]
        if all(self.files.get(path) == before.files[path] for path in code):
            for path in before.files.keys() - self.files.keys():
                if not before._is_same(path):
                    raise ChangedError(str(path))

    def files_of(self, pattern: str) -> set[Path]:
        """The files that a pattern of DATA stands for."""
        names = glob.glob(str(self.folder / pattern), recursive=True, include_hidden=True)
        return {path.resolve() for path in map(Path, names) if path.is_file()}

    def _stated(self) -> set[Path]:
        return set().union(*map(self.files_of, self.data or ()))

    def adopt(self, other: "Opened") -> None:
        """Note the files of another structure that this one loads."""
        self._now |= {p: other._states[p] for p in other.files if p not in self.files}

    def hidden(self) -> list[str]:
        """By what its code may read files unseen, if it does not say which it reads: packages that
        it imports anywhere, and other programs."""
        if self.data is not None:
            return []
        found = sorted(set(self.unseen))
        names = (n for p in self.files if p.suffix == ".py" for n in sources.packages_imported(p))
        for name in sorted(set(names) - SEEN):
            if name in UNSEEN or (name not in sys.stdlib_module_names and _is_installed(name)):
                found.append(f"import {name}")
        return found


class Build:
    """The `build` of a structure, watched."""

    def __init__(self, function: Callable, opened: Opened):
        self.function, self.opened = function, opened

    def __call__(self, **values: Any) -> Any:
        """The scene at some values; SceneError where it opens what is not in its digest."""
        with self.opened.watched():
            scene = self.function(**values)
        self.opened.check(values)
        return scene


class _Finder:
    """Has modules that are not installed imported from their source, and noted."""

    def __init__(self, opened: Opened):
        self.opened = opened

    def find_spec(self, name: str, path: Any, target: Any = None) -> Any:
        others = (each for each in sys.meta_path if not isinstance(each, _Finder))
        specs = (other.find_spec(name, path, target) for other in others)
        spec = next(filter(None, specs), None)
        own = spec and spec.has_location
        if own and not is_installed(os.path.realpath(spec.origin)):
            if isinstance(spec.loader, ExtensionFileLoader):
                self.opened.unseen.append(f"import {name}")
            elif isinstance(spec.loader, SourceFileLoader):
                spec.loader = Loader(name, spec.origin, self.opened)
        return spec


class Loader(SourceFileLoader):
    """Compiles what the file holds, whatever older compiled code says of seconds and sizes."""

    def __init__(self, name: str, path: str, opened: Opened):
        super().__init__(name, path)
        self.opened = opened

    def path_stats(self, path: str) -> Mapping[str, Any]:
        """None: without them, compiled code is neither read nor kept."""
        raise OSError

    def get_data(self, path: str) -> bytes:
        """The source, which is noted."""
        content = super().get_data(path)
        self.opened.imported(Path(path), content)
        return content


_WATCHED = threading.local()
"""Its attribute `by`: for whom files are noted that this thread opens."""


def watching() -> Opened | None:
    """For whom this thread's files are noted."""
    return getattr(_WATCHED, "by", None)


@cache
def _hook() -> None:
    """Note what is opened, for good: hooks stay."""

    def note(event: str, arguments: tuple) -> None:
        if (opened := watching()) is None:
            return
        if event == "open":
            opened.note(arguments[0], arguments[2] or 0)
        elif event == "sqlite3.connect":
            opened.note(arguments[0], os.O_RDONLY)
        elif event in EVENTS:
            opened.unseen.append(event)

    sys.addaudithook(note)


@cache
def _places() -> tuple[str, ...]:
    """Where Python itself and this program lie, and what they keep."""
    both = {sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib")}
    kept = (sources.user_cache(), os.environ.get("NUMBA_CACHE_DIR") or sources.user_cache())
    folders = (*both, *map(os.path.realpath, both), *_PROGRAM, *kept)
    return tuple(f"{folder}{os.sep}" for folder in folders)


@cache
def is_installed(file: str) -> bool:
    """Whether a file is of Python, an installed package or this program: it is not a structure's,
    and its version counts by itself or not at all."""
    return file.startswith(_places()) or bool("-packages" in file and _PACKAGES.search(file))


_PACKAGES = re.compile(r"[/\\](site|dist)-packages[/\\]")


def _own_modules() -> dict[str, ModuleType]:
    """Modules in memory that are not installed."""
    found = {}
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if isinstance(file, str) and not is_installed(file) and name != "__main__":
            found[name] = module
    return found


def _is_installed(name: str) -> bool:
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, ValueError):
        return False
    return bool(spec and spec.origin and is_installed(os.path.realpath(spec.origin)))


def _digest(path: Path) -> str:
    """Of a file; "" of one that is not there."""
    return sources.tree_digest(path) if path.is_file() else ""


def _state(path: Path) -> sources.State | None:
    try:
        return sources.state_of(path.stat())
    except OSError:
        return None
