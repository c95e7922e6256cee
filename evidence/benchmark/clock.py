"""Timing on a machine that does other things as well: in turns, and the best of several."""

import time
from collections.abc import Callable, Mapping


def best(
    functions: Mapping[str, Callable[[], object]],
    repeats: int,
    clock: Callable[[], float] = time.process_time,
) -> dict[str, float]:
    """Least seconds of each function over `repeats` rounds; in a round every one runs once."""
    least = dict.fromkeys(functions, float("inf"))
    for _ in range(repeats):
        for name, function in functions.items():
            start = clock()
            function()
            least[name] = min(least[name], clock() - start)
    return least
