"""The compiled time loop: one for every set of kinds, cached on disk.

Numba's cache looks at the file of the cached function only; the loop is made of many files. So the
cache folder is named after a digest of all kernel sources as they were imported, and of the files
of kinds from elsewhere with what they import from beside them: an edited kernel never meets old
code, and what was imported before an edit is not kept under the name of what came after. Every set
has a folder of its own, so that no kind is needed to load a loop without it, and so has every kind
of processor, so that machines can share a cache."""

import fcntl
import functools
import gc
import hashlib
import json
import logging
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numba
from numba.core.dispatcher import Dispatcher

from fpm.errors import ChangedError
from fpm.kernels import run as loop
from fpm.kernels import sources
from fpm.kernels.hooks import HASHES, KERNELS
from fpm.kernels.vectors import OPTIONS


def find_user_sources(parts: tuple[type, ...]) -> dict[Path, str]:
    """Return digests, by path, of the files outside of the package fpm on which the compiled code
    of some element types depends: where their arrays and kernels are defined, and files beside
    these that they import. parts: classes of the named tuples that their kernels take. Raises
    ChangedError if a file changed since its kernels were imported."""
    kernels = [(part, k.py_func) for (part, _), k in KERNELS.items() if part in parts]
    digests = {}
    for part, definition in [*((part, part) for part in parts), *kernels]:
        digests |= sources.digests(sources.file_of(definition))
        for path, digest in HASHES.get(part, {}).items():
            if digests.get(path, digest) != digest:
                raise ChangedError(str(path))
    return digests


@functools.cache
def source_digest(parts: tuple[type, ...] = ()) -> str:
    """Return a digest (16 hex digits) of numba's version, the kernel sources of fpm, and the
    sources of element types from outside of fpm, after which the folder of compiled code is named.
    parts: classes of the named tuples that the types' kernels take."""
    digests = [digest for _, digest in sorted(find_user_sources(parts).items())]
    text = repr([numba.__version__, sources.kernels(), digests])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@functools.cache
def processor() -> str:
    """Return a digest (8 hex digits) of what numba compiles for: the processor's name and features,
    in which machines that share a file system may differ."""
    from numba.core.registry import cpu_target

    target = repr(cpu_target.target_context.codegen().magic_tuple())
    return hashlib.sha256(target.encode()).hexdigest()[:8]


LONGEST = 200
"""Letters of a folder's name; file systems take some 255, with what is added to it."""


def cache_folder(parts: tuple[type, ...] = (), entry: str = "loop") -> Path:
    """Return the folder for the compiled code of one set of element types (it may not exist): in
    NUMBA_CACHE_DIR, beside the sources, or in the user's cache. parts: classes of the named tuples
    that their kernels take; entry: "loop" (the whole time loop) or "act" (its forces)."""
    loop_name = "-".join([entry, *(p.__name__ for p in parts)])
    if len(loop_name) > LONGEST:  # else nothing could be kept of a scene of nearly all kinds
        loop_name = f"{loop_name[:LONGEST]}-{hashlib.sha256(loop_name.encode()).hexdigest()[:16]}"
    name = Path(f"numba-{source_digest(parts)}-{processor()}", loop_name)
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR) / name
    pycache = Path(__file__).parent / "__pycache__"
    try:
        pycache.mkdir(exist_ok=True)
        is_writable = os.access(pycache, os.W_OK)
    except OSError:
        is_writable = False
    return (pycache if is_writable else sources.user_cache()) / name


ENTRIES = {"loop": loop.run, "act": loop.act}
"""What is compiled for a set of kinds, by name: the whole loop, or their forces alone."""

LOOPS: dict[tuple[str, tuple[type, ...]], Dispatcher] = {}
"""What was compiled for every set of kinds met so far, by the named tuples of the kinds."""

READY: set[tuple] = set()
"""The sets of kinds, what is optional of them and there, and precisions for which that was
compiled or loaded."""

THREADS = threading.Lock()
"""Lock held by the thread that makes a loop ready."""


def _loop(parts: tuple[type, ...], entry: str, is_cached: bool) -> Dispatcher:
    """The loop for a set of kinds, cached in its folder without changing numba's own setting."""
    if (entry, parts) not in LOOPS:
        previous, folder = numba.config.CACHE_DIR, cache_folder(parts, entry)
        numba.config.CACHE_DIR = str(folder)
        try:
            LOOPS[entry, parts] = numba.njit(cache=is_cached, **OPTIONS)(ENTRIES[entry].py_func)
        finally:
            numba.config.CACHE_DIR = previous
    return LOOPS[entry, parts]


def loop_for(arguments: tuple, entry: str = "loop") -> Callable:
    """Return a function compiled, or loaded from the cache on disk, for the types of its arguments:
    the time loop `run.run` (entry "loop") or the sum of forces `run.act` ("act"); the caller calls
    it with them. arguments: all of its arguments, of which the first two are the element types'
    arrays and the World. numba's cache can break when several processes write it at once, so the
    first that arrives compiles and the others wait for its lock; so do threads."""
    parts, world = arguments[:2]
    kinds = tuple(map(type, parts))
    ready = entry, kinds, _optional(parts), world.state.dtype
    if ready not in READY:  # to find the whole signature takes milliseconds
        with THREADS, _one_at_a_time(folder := cache_folder(kinds, entry)) as is_locked:
            run = _loop(kinds, entry, is_cached=is_locked)
            if is_locked and (files := _damaged_files(folder)):
                logging.getLogger(__name__).warning(
                    "%s: compiled code that is not as it was written; it is made again",
                    ", ".join(str(folder / name) for name in files),
                )
                for path in _cache_files(folder):
                    path.unlink(missing_ok=True)
            with _collect_seldom():
                run.compile(tuple(map(numba.typeof, arguments)))
            if is_locked:
                with suppress(OSError):  # a full disk, say
                    (folder / DIGESTS).write_text(json.dumps(_digests(folder)), encoding="utf-8")
            READY.add(ready)
    return LOOPS[entry, kinds]


@contextmanager
def _collect_seldom() -> Iterator[None]:
    """With fewer searches for circles, which take a tenth of a compiler's time."""
    threshold = gc.get_threshold()
    gc.set_threshold(20_000)
    try:
        yield
    finally:
        gc.set_threshold(*threshold)


def _optional(parts: tuple) -> tuple[str, ...]:
    """The fields of named tuples that may be None, and are not."""
    fields = ((part, n, x) for part in parts for n, x in part._field_defaults.items())
    return tuple(n for part, n, x in fields if x is None and getattr(part, n) is not None)


DIGESTS = "digests.json"
"""In a cache folder, digests of the files in it: numba loads, and runs, whatever is there."""


def _cache_files(folder: Path) -> list[Path]:
    """numba's files: indices and compiled code."""
    return sorted(folder.rglob("*.nb[ci]"))


def _digests(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in _cache_files(folder)
    }


def _damaged_files(folder: Path) -> list[str]:
    """Names of files of compiled code that are not as written; none where there are none yet."""
    new, old = _digests(folder), {}
    with suppress(OSError, ValueError, TypeError):
        old = dict(json.loads((folder / DIGESTS).read_text(encoding="utf-8")))
    return [name for name in new | old if new and new.get(name) != old.get(name)]


@contextmanager
def _one_at_a_time(folder: Path) -> Iterator[bool]:
    """Hold a lock for a folder among all processes, on all machines that share its file system.
    Gives False where none can be had: nothing is kept there safely."""
    with ExitStack() as stack:
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            # In its parent, since a lock is beside what it guards, and stays.
            file = stack.enter_context(open(folder.with_name(f"{folder.name}.lock"), "a"))
            fcntl.flock(file, fcntl.LOCK_EX)
        except OSError:
            is_locked = False
        else:
            is_locked = True
        yield is_locked
