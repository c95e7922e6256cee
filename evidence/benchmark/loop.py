"""Where the benchmark reaches into the time loop; all else uses fpm's public interface."""

from __future__ import annotations

import sys
import types
from collections.abc import Callable, Iterable


def lanes() -> types.ModuleType:
    """The module with the operations on lanes that the kernels are written in."""
    from fpm.kernels import lanes as module

    return module


def replace_operations(operations: Iterable[Callable], in_part: Callable) -> None:
    """Run the kernels as plain Python with other operations on lanes, before any kernel is read.

    in_part(name, function): what each kernel that the loop calls is replaced by. RuntimeError
    if numba compiles.
    """
    import numba

    if not numba.config.DISABLE_JIT:
        raise RuntimeError("set NUMBA_DISABLE_JIT=1 before this module is used")
    for operation in operations:
        setattr(lanes(), operation.__name__, operation)
    from fpm.kernels import run as loop

    for where in [loop, *(x for x in vars(loop).values() if isinstance(x, types.ModuleType))]:
        for name, function in list(vars(where).items()):
            if isinstance(function, types.FunctionType) and function is not loop.run:
                part = f"{function.__module__.rsplit('.', 1)[-1]}.{name}"
                setattr(where, name, in_part(part, function))
    compiled = types.ModuleType("fpm.kernels.compiled")
    compiled.run = loop.run
    sys.modules["fpm.kernels.compiled"] = compiled
