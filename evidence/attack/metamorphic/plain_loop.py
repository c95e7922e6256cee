"""The time loop as plain Python on numpy's arrays: no kind of structure takes time to compile.

A step takes some hundred times as long so; `NUMBA_DISABLE_JIT=1` must be set."""

import numpy as np

from evidence.benchmark.loop import Vector, run_as_python


def load(array, row, field):
    """Lanes of a row."""
    return array[row, field].copy()


def store(array, row, field, value):
    """Write what `load` reads."""
    array[row, field] = value


def disable_compilation() -> None:
    """Let fpm run its kernels so from here on."""
    np.seterr(all="ignore")  # as compiled code does
    operations = {
        "load": load,
        "store": store,
        "vector": Vector,
        "where_negative": lambda condition, x, y: np.where(condition < 0, x, y),
        "any_negative": lambda x: bool((x < 0).any()),
        "sqrt": np.sqrt,
        "floor": np.floor,
        "absolute": np.abs,
    }
    run_as_python(operations, lambda name, kernel: kernel)
