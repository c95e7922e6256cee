"""The compiled time loop, and the compiled kernels of each kind, kept as machine code on disk.

Loop and kernels are compiled apart, each once for the types of its arrays, and the loop calls the
kernels by their addresses (`hooks.Calls`). Their files stand in a folder that is named after a
digest of all kernel sources, and of the processor: an edited kernel never meets old code, and
machines can share a cache. Each file is written whole, with checksums: what is not as written is
compiled again."""

import ctypes
import fcntl
import functools
import gc
import hashlib
import logging
import os
import pickle
import re
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import types

from fpm.errors import SceneError
from fpm.kernels import run as loop
from fpm.kernels import sources
from fpm.kernels.hooks import ENTRIES, KERNELS, NAMES, Calls, entry_of
from fpm.kernels.inlining import EntryCompiler, InlinedKernel
from fpm.kernels.references import Reference
from fpm.kernels.vectors import INLINE
from fpm.kernels.world import StepTime


@functools.cache
def source_digest() -> str:
    """Return a digest (16 hex digits) of numba's version and the kernel sources of fpm, after which
    the folder of compiled code is named."""
    code = sources.digest(sources.PACKAGE / "elements", sources.PACKAGE / "kernels")
    text = repr([numba.__version__, code])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@functools.cache
def processor() -> str:
    """Return a digest (8 hex digits) of numba's target: the processor's name and features, which
    may differ between machines that share a file system."""
    features = llvm.get_host_cpu_features().flatten()
    target = repr([llvm.get_process_triple(), llvm.get_host_cpu_name(), features])
    return hashlib.sha256(target.encode()).hexdigest()[:8]


def cache_folder() -> Path:
    """Return the folder for compiled code (it may not exist): in NUMBA_CACHE_DIR, beside the
    sources, or in the user's cache."""
    name = f"numba-{source_digest()}-{processor()}"
    if numba.config.CACHE_DIR:
        return Path(numba.config.CACHE_DIR) / name
    pycache = Path(__file__).parent / "__pycache__"
    try:
        pycache.mkdir(exist_ok=True)
        is_writable = os.access(pycache, os.W_OK)
    except OSError:
        is_writable = False
    return (pycache if is_writable else sources.user_cache()) / name


def cache_file(name: str, form: str, arrays: type | None = None) -> Path:
    """Return a file of compiled code (it may not exist). name: of function or class; form: of the
    arguments (`form_of`); arrays: class of an element type's named tuple, None: the loop's."""
    constants = [_constants_of(KERNELS[arrays, hook]) for hook in _hooks(arrays)] if arrays else []
    text = repr([form, constants])
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    return cache_folder() / f"{name}-{digest}.npz"


def form_of(value: Any) -> str:
    """Return what compiled code depends on of an argument, as text: number types and dimensions of
    arrays, names and fields of named tuples. Raises TypeError for what kernels do not take."""
    if isinstance(value, np.ndarray) and value.flags.c_contiguous:
        return f"{value.dtype.str}{value.ndim}"
    if isinstance(value, tuple):
        return f"{type(value).__name__}({','.join(map(form_of, value))})"
    if isinstance(value, float):
        return "float"
    if value is None or isinstance(value, int | np.integer | np.bool_):
        return "None" if value is None else "int"
    raise TypeError(f"{value!r}: kernels take C-contiguous arrays, int, float, None, named tuples")


def words_of(value: Any) -> list[int]:
    """Return the 64-bit words of an argument in memory, as compiled code reads them (of an array:
    two pointers of Python, count and size of items, address, shape, strides); it has to live on."""
    if isinstance(value, np.ndarray):
        address = value.__array_interface__["data"][0]
        return [0, 0, value.size, value.itemsize, address, *value.shape, *value.strides]
    if isinstance(value, tuple):
        return [word for field in value for word in words_of(field)]
    if isinstance(value, float):
        return [int(np.float64(value).view(np.int64))]
    return [0 if value is None else int(value)]


def numba_type(value: Any) -> types.Type:
    """Return numba's type of an argument, as in `form_of`."""
    if isinstance(value, np.ndarray):
        return types.Array(numba.from_dtype(value.dtype), value.ndim, "C")
    if isinstance(value, tuple):
        return types.BaseTuple.from_types([numba_type(field) for field in value], type(value))
    if isinstance(value, float):
        return types.float64
    return types.none if value is None else types.intp


FUNCTIONS: dict[str, Any] = {"run": loop.run, "act": loop.act}
"""What is compiled for all scenes, by name: the whole loop, and the sum of forces alone."""

READY: dict[tuple[Any, str], dict[str, int]] = {}
"""Of each element type (class of its arrays) and function of the loop (name), and the form of its
arguments, the addresses in memory of its kernels by hook, or its own by name."""

COMPILED_NAMES: list[str] = []
"""What this process compiled: names of classes of arrays, and of functions of the loop."""

_ENGINES: list[llvm.ExecutionEngine] = []
"""What keeps machine code in memory."""

THREADS = threading.Lock()
"""Lock held by the thread that makes code ready."""

SEAL = "seal"
"""Name, in a file of compiled code, of the entry with what file it is."""

Code = dict[str, tuple[str, bytes]]
"""Of compiled functions, by name, the name in their machine code, and that."""

PYTHON = re.compile(r"@Py[A-Z]|@numba_gil|store .*%excinfo")
"""What in the code of a kernel needs Python, or raises an error, which the loop cannot hand on."""


def prepare_call(name: str, parts: Sequence[tuple], world: tuple, *rest: Any) -> Callable[[], None]:
    """Return a call of the time loop `run.run` ("run"), or of the sum of forces `run.act` ("act"),
    with compiled kernels, to be made once or many times. parts: arrays of each element type; world,
    rest: further arguments of the function; the call reads and changes these arrays themselves."""
    helper = _start_helper(name, parts, world, rest)
    world_form = form_of(world)
    codes = [_kernels(part, world, world_form) for part in reversed(parts)]
    codes.reverse()
    memory = [_in_memory(part) for part in parts]
    calls = [
        [(code[hook], words.ctypes.data) for code, words in zip(codes, memory, strict=True)
         if hook in code]
        for hook in NAMES
    ]  # fmt: skip
    table = Calls(
        np.cumsum([0, *map(len, calls)], dtype=np.int64),
        np.array([c for row in calls for c in row], dtype=np.int64).reshape(-1, 2),
    )
    arguments = table, world, *rest
    address = _loop(name, arguments)
    if helper:
        helper.wait()
    values: list = []
    kinds: list[type] = []
    for argument in arguments:
        if _is_by_reference(argument):
            memory.append(words := _in_memory(argument))
            values.append(words.ctypes.data)
            kinds.append(ctypes.c_void_p)
        else:
            numbers = argument if isinstance(argument, tuple) else (argument,)
            values += numbers
            kinds += [ctypes.c_double if isinstance(n, float) else ctypes.c_int64 for n in numbers]
    # As numba calls: first where a result and an error would go.
    result = ctypes.c_void_p()
    function = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *kinds)(address)

    def call(memory=(memory, arguments)) -> None:  # which live as long as the call
        function(ctypes.addressof(result), None, *values)

    return call


HELPER = """
import pickle, sys
sys.path[:], name, parts, world, rest = pickle.load(sys.stdin.buffer)
from fpm.kernels import compiled_loop
compiled_loop.compile_from_start(name, parts, world, rest)
"""


def _start_helper(
    name: str, parts: Sequence[tuple], world: tuple, rest: tuple
) -> subprocess.Popen | None:
    """Start a process that compiles the same list from its other end, if there is a core for it and
    more than one item. None: there is none. Locks prevent that anything is compiled twice."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    if {type(part) for part in parts} <= {unit for unit, _ in READY} or cores == 1:
        return None
    missing = [part for part in parts if not is_compiled(part, world)]
    if len(missing) + (not is_loop_compiled()) < 2:
        return None
    with suppress(OSError, pickle.PicklingError, AttributeError):
        blanks = _blank((tuple(parts), world, rest))
        content = pickle.dumps((sys.path, name, *blanks))
        streams: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL}
        command = [sys.executable, "-c", HELPER]
        helper: Any = subprocess.Popen(command, stderr=subprocess.DEVNULL, **streams)
        with suppress(BrokenPipeError), helper.stdin:
            helper.stdin.write(content)
        return helper
    return None


def _blank(value: Any) -> Any:
    """Return a value of the same form with empty arrays."""
    if isinstance(value, np.ndarray):
        return np.empty((0,) * value.ndim, value.dtype)
    if isinstance(value, tuple):
        fields = map(_blank, value)
        return type(value)(*fields) if hasattr(value, "_fields") else tuple(fields)
    return value


def compile_from_start(name: str, parts: Sequence[tuple], world: tuple, rest: tuple) -> None:
    """Compile what `prepare_call` needs of its arguments, in the other order: the loop first,
    joints, which take longest, last. Only the form of arrays counts, not their size."""
    table = Calls(np.zeros(1, np.int64), np.zeros((0, 2), np.int64))
    _loop(name, (table, world, *rest))
    for part in filter(_is_kept, parts):
        _kernels(part, world, form_of(world))


def _is_kept(part: tuple) -> bool:
    """Return whether compiled kernels of an element type are kept on disk."""
    kernels = [KERNELS[type(part), hook] for hook in _hooks(type(part))]
    return all(_constants_of(kernel) is not None for kernel in kernels)


def is_compiled(part: tuple, world: tuple) -> bool:
    """Return whether kernels of an element type (its arrays) are on disk, or it has none."""
    arrays = type(part)
    path = cache_file(arrays.__name__, f"{form_of(part)} {form_of(world)}", arrays)
    return not _hooks(arrays) or path.exists()


def is_loop_compiled() -> bool:
    """Return whether the compiled time loop is on disk."""
    return any(cache_folder().glob("run-*.npz"))


def _hooks(arrays: type) -> list[str]:
    """Names of the hooks for which an element type has kernels."""
    return [hook for hook in ENTRIES if (arrays, hook) in KERNELS]


def _is_by_reference(argument: Any) -> bool:
    return isinstance(argument, tuple) and any(isinstance(f, np.ndarray) for f in argument)


def _in_memory(value: tuple) -> np.ndarray:
    return np.array(words_of(value), dtype=np.int64)


def _kernels(part: tuple, world: Any, world_form: str) -> dict[str, int]:
    """Return the addresses, by hook, of an element type's kernels compiled for these arrays."""
    arrays, form = type(part), f"{form_of(part)} {world_form}"
    if (arrays, form) not in READY:
        hooks, path = _hooks(arrays), cache_file(arrays.__name__, form, arrays)
        is_kept = _is_kept(part)

        def compile_kernels() -> tuple[Code, bool]:
            lanes = types.Array(numba.from_dtype(world.state.dtype), 3, "C")
            argument_types = {
                "world": Reference(numba_type(world)),
                "timing": numba_type(StepTime(0.0, 0.0, 0.0)),
                **dict.fromkeys(("row", "number"), types.intp),
                **dict.fromkeys(("energies", "points"), lanes),
            }
            code, is_portable = {}, True
            for hook in hooks:
                function, arguments = entry_of(arrays, hook)
                kinds = [Reference(numba_type(part)), *(argument_types[a] for a in arguments)]
                library, code[hook] = _compile(function, kinds)
                # A user's own kernel may call Python by mistake; the program's are tested not to.
                if not is_kept and PYTHON.search(library.get_llvm_str()):
                    allowed = "kernels that raise no error and use nothing of Python"
                    raise SceneError(f"kernel of {arrays.__name__}", hook, allowed)
                is_portable &= not library.has_dynamic_globals
            return code, is_portable

        READY[arrays, form] = _make_ready(path, compile_kernels, is_kept) if hooks else {}
    return READY[arrays, form]


def _loop(name: str, arguments: tuple) -> int:
    """Address of a function of the loop for these arguments."""
    form = form_of(arguments)
    if (name, form) not in READY:

        def compile_loop() -> tuple[Code, bool]:
            kinds = [
                Reference(numba_type(a)) if _is_by_reference(a) else numba_type(a)
                for a in arguments
            ]
            return {name: _compile(FUNCTIONS[name].py_func, kinds)[1]}, True

        READY[name, form] = _make_ready(cache_file(name, form), compile_loop)
    return READY[name, form][name]


def _constants_of(kernel: Any) -> list | None:
    """Return the constants that identify compiled code: numbers and texts bound in a kernel by the
    function that made it, and likewise of the kernels that it calls. None if it has any other
    object, or is defined outside of this package."""
    if not kernel.py_func.__code__.co_filename.startswith(f"{sources.PACKAGE}{os.sep}"):
        return None
    constants: list = [kernel.py_func.__qualname__]
    for cell in kernel.py_func.__closure__ or ():
        value = cell.cell_contents
        value = _constants_of(value) if isinstance(value, InlinedKernel) else value
        if type(value) not in (list, bool, int, float, str):
            return None
        constants.append(value)
    return constants


def _compile(function: Callable, kinds: Sequence[types.Type]) -> tuple[Any, tuple[str, bytes]]:
    """Compile a function for arguments of some types; return its library, its name in machine code,
    and that code."""
    dispatcher = numba.njit(**{**INLINE, "pipeline_class": EntryCompiler})(function)
    dispatcher.compile(tuple(kinds))
    (result,) = dispatcher.overloads.values()
    return result.library, (result.fndesc.llvm_func_name, result.library.object_code)


def _make_ready(
    path: Path, compile_all: Callable[[], tuple[Code, bool]], is_kept: bool = True
) -> dict[str, int]:
    """Addresses of functions, loaded from their file, or compiled and written there. compile_all:
    returns code, and whether other processes may load it; is_kept: False: no file. The first
    process compiles, and others wait for its lock; so do threads."""
    with THREADS, _one_at_a_time(path) if is_kept else ExitStack():
        code = _read(path) if is_kept else {}
        if not code:
            with _collect_seldom():
                code, is_portable = compile_all()
            COMPILED_NAMES.append(path.stem.split("-")[0])
            if is_kept and is_portable:
                with suppress(OSError):  # a full disk, say
                    _write(path, code)
        return {function: _load(*entry) for function, entry in code.items()}


def _read(path: Path) -> Code:
    """Code in a file; {}: there is none, or it is not as it was written."""
    if not path.is_file():
        return {}
    try:
        with np.load(path) as file:
            content = {tuple(key.split(" ")): file[key].tobytes() for key in file.files}
        if content.pop((SEAL,)) != _seal(path):
            raise ValueError(SEAL)  # the file of something else
        return {name: (symbol, code) for (name, symbol), code in content.items()}
    except Exception:  # whatever a damaged file makes its readers raise
        logging.getLogger(__name__).warning(
            "%s: compiled code that is not as it was written; it is made again", path
        )
        return {}


def _seal(path: Path) -> bytes:
    """Return the bytes that tie a file to its folder and name."""
    return f"{path.parent.name}/{path.name}".encode()


def _write(path: Path, code: Code) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}.{os.getpid()}.npz")
    arrays: dict[str, Any] = {
        f"{n} {symbol}": np.frombuffer(c, np.uint8) for n, (symbol, c) in code.items()
    }
    arrays[SEAL] = np.frombuffer(_seal(path), np.uint8)
    try:
        np.savez(part, **arrays)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _load(symbol: str, code: bytes) -> int:
    """Load machine code, which stays in memory, and return the address of its function `symbol`."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _ENGINES.append(engine)
    return engine.get_function_address(symbol)


@contextmanager
def _collect_seldom() -> Iterator[None]:
    """Search seldom for reference cycles, which takes a tenth of a compiler's time."""
    threshold = gc.get_threshold()
    gc.set_threshold(500_000)
    try:
        yield
    finally:
        gc.set_threshold(*threshold)


@contextmanager
def _one_at_a_time(path: Path) -> Iterator[None]:
    """Hold a lock for a file among all processes, on all machines that share its file system; where
    none can be had, several may make the same file, each whole."""
    with ExitStack() as stack:
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            # Beside what it guards, which is replaced.
            file = stack.enter_context(open(path.with_suffix(".lock"), "a"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield
