"""Count the vector operations of a step: the kernels run as plain Python on counting numbers.

    NUMBA_DISABLE_JIT=1 python -m evidence.benchmark.operations [elements a link [steps]]

prints them as JSON, per step. A product that is added to something counts as one fused operation,
as the compiler makes it; of two products that are added, one is fused."""

import json
import sys
from collections import Counter

import numpy as np

from evidence.benchmark.kernel import stable
from evidence.benchmark.loop import Vector, run_as_python
from evidence.benchmark.scenes import linkages, runner

TALLY: Counter = Counter()
"""Operations by kind, and by (kind, part of the loop)."""

PART: list[str] = []
"""The part of the loop that is at work, outermost first."""


def note(kind: str, registers: int) -> None:
    TALLY[kind] += registers
    TALLY[kind, PART[0] if PART else "run"] += registers


class Lanes:
    """The lanes of one register, or of two, that count what is done with them."""

    __array_ufunc__ = None

    def __init__(self, value, product=False):
        self.value, self.product = value, product

    def _note(self, kind):
        note(kind, len(self.value) // 8)

    def _sum(self, right, value):
        lanes = Lanes(value)
        if self.product or (isinstance(right, Lanes) and right.product):
            lanes._note("fma")
            note("multiply", -(len(value) // 8))
            # The product is used up; if it is used again, it counts as computed before.
            (self if self.product else right).product = False
        else:
            lanes._note("add")
        return lanes

    def __add__(self, right):
        return self._sum(right, self.value + number(right))

    __radd__ = __add__

    def __sub__(self, right):
        return self._sum(right, self.value - number(right))

    def __rsub__(self, minuend):
        return self._sum(minuend, number(minuend) - self.value)

    def __mul__(self, right):
        if isinstance(right, Vector):
            return NotImplemented
        self._note("multiply")
        return Lanes(self.value * number(right), product=True)

    __rmul__ = __mul__

    def __truediv__(self, right):
        self._note("divide")
        return Lanes(self.value / number(right))

    def __rtruediv__(self, dividend):
        self._note("divide")
        return Lanes(number(dividend) / self.value)

    def __neg__(self):
        return Lanes(-self.value)  # folded into the operation that follows


def number(x):
    """The value of lanes or of a scalar."""
    return x.value if isinstance(x, Lanes) else x


def load(array, row, field):
    rows = row if isinstance(row, tuple) else (row,)
    note("load", len(rows))
    return Lanes(np.concatenate([array[r, field] for r in rows]))


def store(array, row, field, value):
    rows = row if isinstance(row, tuple) else (row,)
    note("store", len(rows))
    values = np.broadcast_to(number(value), (len(rows) * array.shape[2],))
    for k, r in enumerate(rows):
        array[r, field] = values[k * array.shape[2] : (k + 1) * array.shape[2]]


def sqrt(x):
    x._note("root")
    return Lanes(np.sqrt(x.value))


def where_negative(condition, x, y):
    condition._note("select")
    return Lanes(np.where(condition.value < 0, number(x), number(y)))


def any_negative(x):
    x._note("select")
    return bool((x.value < 0).any())


def floor(x):
    x._note("select")
    return Lanes(np.floor(x.value))


def absolute(x):
    x._note("select")
    return Lanes(np.abs(x.value))


COUNTS = (load, store, sqrt, where_negative, any_negative, floor, absolute)
OPERATIONS = {"vector": Vector, **{operation.__name__: operation for operation in COUNTS}}
"""What stands for the compiled operations of these names."""


def in_part(name: str, function):
    """The function, with what it does put down to the part `name` of the loop."""

    def run(*args):
        PART.append(name)
        try:
            return function(*args)
        finally:
            PART.pop()

    return run


NAMES = ("fma", "multiply", "add", "divide", "root", "select", "load", "store")


def count_operations(elements: int = 12, steps: int = 50) -> dict:
    """Operations per step of the linkage, and of its parts; the energy checks are included."""
    scenes = linkages(8, elements)
    step = stable(scenes)
    tallies = []
    for n in (steps, 2 * steps):
        TALLY.clear()
        runner(scenes, n, step)()
        tallies.append(Counter(TALLY))
    counts = {key: (tallies[1][key] - tallies[0][key]) / steps for key in tallies[1]}
    parts: dict[str, float] = {}
    for key, count in counts.items():
        if isinstance(key, tuple) and key[0] in ("fma", "multiply"):
            parts[key[1]] = parts.get(key[1], 0.0) + count
    parts = {name: parts[name] for name in sorted(parts, key=parts.get, reverse=True)}
    return {"operations": {name: counts.get(name, 0.0) for name in NAMES}, "multiplications": parts}


if __name__ == "__main__":
    run_as_python(OPERATIONS, in_part)
    print(json.dumps(count_operations(*map(int, sys.argv[1:]))))
