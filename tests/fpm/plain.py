"""The time loop as plain Python, one sample at a time: small scenes of any kinds, none compiled.

NUMBA_DISABLE_JIT=1 python script.py, where the script imports this first.
"""

import numpy as np

from evidence.benchmark.loop import Vector, run_as_python
from fpm.kernels import lanes


def load(array, row, field):
    return array[row, field, 0]


def store(array, row, field, value):
    array[row, field, 0] = value


OPERATIONS = {
    "vector": Vector,
    "load": load,
    "store": store,
    "sqrt": np.sqrt,
    "floor": np.floor,
    "absolute": np.abs,
    "where_negative": lambda condition, x, y: x if condition < 0 else y,
    "any_negative": lambda x: bool(np.any(x < 0)),
}

np.seterr(all="ignore")  # as where it is compiled
lanes.width = lambda dtype: 1
run_as_python(OPERATIONS, lambda name, function: function)
