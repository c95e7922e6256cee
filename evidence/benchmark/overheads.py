"""What surrounds the arithmetic: imports, the cache of compiled code, compiling."""

import json
import tempfile
from pathlib import Path

import numpy as np

import fpm
from evidence.benchmark.processes import import_seconds, python
from evidence.benchmark.scenes import linkages
from evidence.rows import Row, at_most, info

GROUP = "Around the arithmetic"

START = """
import json, time
start = time.perf_counter()
import fpm
imported = time.perf_counter()
import numba
numba_time = time.perf_counter() - imported
from deployable.campaign.config.sections import scene_type
scene = scene_type("bennett").build()
built = time.perf_counter()
fpm.warm_up(scene)
print(json.dumps([imported - start, numba_time, time.perf_counter() - built]))
"""

COMPILE = """
import json, sys, time
import fpm
from deployable.campaign.config.sections import scene_type
scene = scene_type(sys.argv[1]).build()
start = time.perf_counter()
fpm.warm_up(scene)
print(json.dumps(time.perf_counter() - start))
"""

ORDER = ("bennett", "boom", "telescope", "solar_array", "tensegrity")
"""Structures whose kinds of element are compiled one after the other, into a cache that is empty
at first; then a mix of them that was not there before."""


def time_start(repeats: int) -> list[Row]:
    """Import of fpm, of numba, and loading the compiled kernels, in fresh processes."""
    fpm.warm_up(linkages(1)[0])
    times = [json.loads(python("-c", START)) for _ in range(repeats)]
    package, numba, kernels = np.min(times, axis=0)
    return [
        at_most("import fpm", package, 0.5, unit="s"),
        info("import numba, when first simulating", float(numba), "s"),
        info("loading the compiled kernels from the cache", float(kernels), "s"),
    ]


def time_compilation(order: tuple[str, ...] = ORDER) -> list[Row]:
    """Compile structures, each in a process of its own; against one that imports six libraries."""
    with tempfile.TemporaryDirectory() as folder:
        first_times = {}
        for name in order:
            cache = Path(folder, name)
            first_times[name] = float(python("-c", COMPILE, name, NUMBA_CACHE_DIR=str(cache)))
        later_times = {
            name: float(python("-c", COMPILE, name, NUMBA_CACHE_DIR=folder)) for name in order
        }
        mix_time = float(python("-c", COMPILE, "latch", NUMBA_CACHE_DIR=folder))
    unit = import_seconds()
    rows = [info("a process that imports six libraries", unit, "s")]
    for name, seconds in first_times.items():
        note = f"{seconds / unit:.1f} times as long; after those above {later_times[name]:.1f} s"
        rows.append(info(f"compiling {name} from an empty cache", seconds, "s", note))
    note = f"{mix_time / unit:.1f} times that process"
    return [*rows, info("a new mix of kinds that are compiled: latch", mix_time, "s", note)]
