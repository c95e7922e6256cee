"""What a structure in Python opens while it is loaded and built: its digest is made of all that.

Python tells of every file that it opens itself, also of those that a helper opens while it is
imported. Compiled code of other packages opens files unseen, and so do other programs: a structure
that has such code is refused, unless it names its files itself (`DATA`)."""

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

TRACED_PACKAGES = {"numpy", "scipy", "numba", "fpm"}
"""Packages beside Python's own whose compiled code opens files by Python only."""

READERS = {
    "__import__", "asyncio", "concurrent", "ctypes", "dbm", "importlib", "multiprocessing", "runpy",
    "shelve", "socket", "subprocess", "threading",
}  # fmt: skip
"""Modules of Python itself by which files are read, or code run, unseen."""

EVENTS = {
    "subprocess.Popen", "os.system", "os.exec", "os.fork", "os.forkpty", "os.posix_spawn",
    "os.spawn", "socket.connect",
}  # fmt: skip
"""Audit events of Python by which files are read, or code run, unseen."""

DATA_HINT = 'with DATA = ["tables/*.csv"], patterns of all files that it reads, [] for none'
"""What a structure can state instead, for messages."""

_PROGRAM = tuple(str(sources.PACKAGE.parent / name) for name in ("fpm", "deployable"))


class FileRecord:
    """Record of all files that a structure in Python opens, by digest of their content. path: the
    structure's own file, noted too. It is sealed, its digest fixed, when the structure was loaded
    and built at its defaults: files that a build at other values opens beyond it are an error."""

    def __init__(self, path: Path):
        self.path, self.folder = path, path.parent
        self.files: dict[Path, str] = {}
        self.hidden_reads: list[str] = []
        self.modules: dict[str, ModuleType] = {}
        self.data: tuple[str, ...] | None = None
        self._states: dict[Path, sources.State | None] = {}
        self._new_states: dict[Path, sources.State | None] = {}
        self._outputs: set[Path] = set()

    # -- while it runs --------------------------------------------------------------------------

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Return a context manager in which files that this thread opens are noted in this record,
        and modules that are not installed are imported afresh, out of sight of other structures."""
        _hook()
        outer, _THREAD.record = current_record(), self
        user_modules = _find_user_modules()
        for name in user_modules:
            del sys.modules[name]
        sys.modules.update(self.modules)
        sys.meta_path.insert(0, finder := _Finder(self))
        try:
            yield
        finally:
            sys.meta_path.remove(finder)
            self.modules = _find_user_modules()
            for name in self.modules:
                del sys.modules[name]
            sys.modules.update(user_modules)
            _THREAD.record = outer

    def note(self, file: Any, flags: int) -> None:
        """Note a file that is opened to be read, if it is not of Python, a package or this program.
        file: its path (numbers of open files are passed over); flags: those of os.open."""
        if not isinstance(file, str | bytes | os.PathLike):
            return  # by its number: it was opened before
        name = os.path.realpath(os.fsdecode(file))
        if is_installed(name) or name.startswith(("/dev/", "/proc/", "/sys/")):
            return
        if "__pycache__" in name:
            return
        path = Path(name)
        if flags & (os.O_TRUNC | os.O_EXCL):
            self._outputs.add(path)
        elif flags & os.O_ACCMODE != os.O_WRONLY and path not in self._outputs:
            self._new_states.setdefault(path, _state(path))

    def add_import(self, path: Path, content: bytes) -> None:
        """Note an imported file's `path` and content; ChangedError if other content was noted."""
        path = Path(os.path.realpath(path))
        self._new_states.pop(path, None)
        digest = sources.content_digest(content, path)
        if self.files.setdefault(path, digest) != digest:
            raise ChangedError(str(path))

    # -- afterwards -----------------------------------------------------------------------------

    def seal(self, data: Iterable[str] | None) -> str:
        """Fix the record, once the structure was loaded and built at its defaults; returns the
        structure's digest, 16 hex digits. data: its DATA, glob patterns of the files that it reads;
        None if it has none. Raises ChangedError if a file changed since it was read."""
        self.data = None if data is None else tuple(data)
        code = sources.find_user_sources(self.path, *(p for p in self.files if p.suffix == ".py"))
        for path in (*code, *self._new_states, *self._data_files()):
            self.files.setdefault(path, _digest(path))
        for path, state in self._new_states.items():
            if path not in self._outputs and _state(path) != state:
                raise ChangedError(str(path))
        self._new_states.clear()
        self._states = {path: _state(path) for path in self.files}
        digests = sorted((os.path.relpath(p, self.folder), d) for p, d in self.files.items())
        return hashlib.sha256(repr(digests).encode()).hexdigest()[:16]

    def check(self, values: Mapping[str, Any]) -> None:
        """Check all files that a build of the structure opened, when it is done. values: its
        parameters' by name, for messages. Raises SceneError for a file not in the sealed record, or
        where files may have been read unseen and there is no DATA; ChangedError if one changed."""
        paths, self._new_states = {*self._new_states, *self._data_files()}, {}
        if self.hidden_reads and self.data is None:
            raise SceneError(f"{self.path.name} at {dict(values)}", self.hidden_reads, DATA_HINT)
        for path in sorted(paths):
            if path not in self.files:
                allowed = "files that it opens at its default values, too, or names in "
                allowed += 'DATA = ["tables/*.csv"]: its results are named after their content'
                raise SceneError(f"{self.path.name} at {dict(values)}", f"opens {path}", allowed)
            if not self._is_same(path):
                raise ChangedError(str(path))

    def is_same(self) -> bool:
        """Return whether all files in the record are as they were when it was sealed, and the
        patterns of DATA match no further ones."""
        return all(map(self._is_same, self.files)) and self._data_files() <= set(self.files)

    def _is_same(self, path: Path) -> bool:
        return _state(path) == self._states.get(path, ()) or _digest(path) == self.files[path]

    def follow(self, previous: "FileRecord") -> None:
        """Check, after a structure was loaded anew, that nothing was taken from memory that the
        previous load read from a file: raises ChangedError if a file that the same code opened then
        has changed, and was not opened now. previous: record of the previous load."""
        code = [path for path in previous.files if path.suffix == ".py"]
        if all(self.files.get(path) == previous.files[path] for path in code):
            for path in previous.files.keys() - self.files.keys():
                if not previous._is_same(path):
                    raise ChangedError(str(path))

    def files_of(self, pattern: str) -> set[Path]:
        """Return absolute paths of files in the structure's folder that a glob of DATA matches."""
        names = glob.glob(str(self.folder / pattern), recursive=True, include_hidden=True)
        return {path.resolve() for path in map(Path, names) if path.is_file()}

    def _data_files(self) -> set[Path]:
        return set().union(*map(self.files_of, self.data or ()))

    def adopt(self, record: "FileRecord") -> None:
        """Note files of another structure, which this one loads, as its own. record: of that."""
        self._new_states |= {p: record._states[p] for p in record.files if p not in self.files}

    def list_hidden_reads(self) -> list[str]:
        """Return the ways in which the structure's code may read files that cannot be noted, as
        texts such as "import ctypes"; [] if it states its files (DATA)."""
        if self.data is not None:
            return []
        readers = sorted(set(self.hidden_reads))
        names = (n for p in self.files if p.suffix == ".py" for n in sources.list_packages(p))
        for name in sorted(set(names) - TRACED_PACKAGES):
            if name in READERS or (name not in sys.stdlib_module_names and _is_installed(name)):
                readers.append(f"import {name}")
        return readers


class Build:
    """Builds a structure's scene and checks files opened meanwhile; called with parameter values by
    keyword. function: builds it, called likewise; record: its sealed FileRecord."""

    def __init__(self, function: Callable, record: FileRecord):
        self.function, self.record = function, record

    def __call__(self, **values: Any) -> Any:
        """The scene at values of parameters; SceneError if it opens an undigested file."""
        with self.record.recording():
            scene = self.function(**values)
        self.record.check(values)
        return scene


class _Finder:
    """Has modules that are not installed imported from their source, and noted."""

    def __init__(self, record: FileRecord):
        self.record = record

    def find_spec(self, name: str, path: Any, target: Any = None) -> Any:
        finders = (finder for finder in sys.meta_path if not isinstance(finder, _Finder))
        specs = (finder.find_spec(name, path, target) for finder in finders)
        spec = next(filter(None, specs), None)
        is_file = spec and spec.has_location
        if is_file and not is_installed(os.path.realpath(spec.origin)):
            if isinstance(spec.loader, ExtensionFileLoader):
                self.record.hidden_reads.append(f"import {name}")
            elif isinstance(spec.loader, SourceFileLoader):
                spec.loader = Loader(name, spec.origin, self.record)
        return spec


class Loader(SourceFileLoader):
    """Import loader of a module that is not installed: compiles its source, never takes cached
    bytecode, and notes its file. name: of the module; path: its source; record: FileRecord."""

    def __init__(self, name: str, path: str, record: FileRecord):
        super().__init__(name, path)
        self.record = record

    def path_stats(self, path: str) -> Mapping[str, Any]:
        """Raise OSError, so that importlib neither reads nor keeps bytecode of file `path`."""
        raise OSError

    def get_data(self, path: str) -> bytes:
        """Return the bytes of the source at `path`, which are noted in the record."""
        content = super().get_data(path)
        self.record.add_import(Path(path), content)
        return content


_THREAD = threading.local()
"""Its attribute `by`: for whom files are noted that this thread opens."""


def current_record() -> FileRecord | None:
    """Return the record of files that this thread opens now; None outside of `recording`."""
    return getattr(_THREAD, "record", None)


@cache
def _hook() -> None:
    """Note what is opened, for good: hooks stay."""

    def note(event: str, arguments: tuple) -> None:
        if (record := current_record()) is None:
            return
        if event == "open":
            record.note(arguments[0], arguments[2] or 0)
        elif event == "sqlite3.connect":
            record.note(arguments[0], os.O_RDONLY)
        elif event in EVENTS:
            record.hidden_reads.append(event)

    sys.addaudithook(note)


@cache
def _places() -> tuple[str, ...]:
    """Where Python itself and this program lie, and what they keep."""
    bases = {sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib")}
    caches = (sources.user_cache(), os.environ.get("NUMBA_CACHE_DIR") or sources.user_cache())
    folders = (*bases, *map(os.path.realpath, bases), *_PROGRAM, *caches)
    return tuple(f"{folder}{os.sep}" for folder in folders)


@cache
def is_installed(file: str) -> bool:
    """Return whether a file (absolute path) belongs to Python, an installed package or this
    program, so that it is no file of a structure."""
    return file.startswith(_places()) or bool("-packages" in file and _PACKAGES.search(file))


_PACKAGES = re.compile(r"[/\\](site|dist)-packages[/\\]")


def _find_user_modules() -> dict[str, ModuleType]:
    """Modules in memory that are not installed."""
    modules = {}
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if isinstance(file, str) and not is_installed(file) and name != "__main__":
            modules[name] = module
    return modules


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
