"""What surrounds the arithmetic: imports, cache, surrogate and bounds, writing."""

import json
import tempfile
import time
from pathlib import Path

import numpy as np

import fpm
from deployable.campaign.config.sections import scene_type
from evidence.benchmark.clock import best
from evidence.benchmark.processes import python
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

SIX = """
import json, time
start = time.perf_counter()
import numpy, numba, xarray, netCDF4, matplotlib, snakemake
print(json.dumps(time.perf_counter() - start))
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
    times = []
    for _ in range(repeats):
        times.append(json.loads(python("-c", START)))
    package, numba, kernels = np.min(times, axis=0)
    return [
        at_most("import fpm", package, 0.5, unit="s"),
        info("import numba, when first simulating", float(numba), "s"),
        info("loading the compiled kernels from the cache", float(kernels), "s"),
    ]


def time_compilation() -> list[Row]:
    """Compile structures, each in a process of its own; against one that imports six libraries."""
    with tempfile.TemporaryDirectory() as folder:
        first_times = {}
        for name in ORDER:
            cache = Path(folder, name)
            first_times[name] = json.loads(python("-c", COMPILE, name, NUMBA_CACHE_DIR=str(cache)))
        later_times = {
            name: json.loads(python("-c", COMPILE, name, NUMBA_CACHE_DIR=folder)) for name in ORDER
        }
        mix_time = json.loads(python("-c", COMPILE, "latch", NUMBA_CACHE_DIR=folder))
        unit = min(json.loads(python("-c", SIX)) for _ in range(3))
    rows = [info("a process that imports six libraries", unit, "s")]
    for name in ORDER:
        seconds = first_times[name]
        note = f"{seconds / unit:.1f} times as long; after those above {later_times[name]:.1f} s"
        rows.append(info(f"compiling {name} from an empty cache", seconds, "s", note))
    note = f"{mix_time / unit:.1f} times that process"
    return [*rows, info("a new mix of kinds that are compiled: latch", mix_time, "s", note)]


def surrogate(repeats: int, order: int = 9, instants: int = 2000, responses: int = 10) -> list[Row]:
    """Fit and range of many instants and responses, in one dimension."""
    from deployable.intervals import find_surrogate_range, fit, make_design

    design = make_design("tensor_roots", 1, order)
    time_axis, lines = np.linspace(0, 1, instants), np.arange(1, responses + 1)
    x = design.points[:, :1, None]
    values = np.sin(lines * (1 + x) * time_axis[:, None]) + np.abs(x - 0.3 * time_axis[:, None])
    work = {"both": lambda: find_surrogate_range(fit(design, values))}
    seconds = best(work, repeats, time.perf_counter)
    name = f"surrogate and bounds, {instants} instants x {responses} responses, order {order}"
    return [at_most(name, seconds["both"], 1.0, unit="s")]


def time_write(repeats: int, instants: int = 2001, runs: int = 8) -> list[Row]:
    """Making the dataset of a run and writing it as netCDF, against simulating it."""
    import xarray  # noqa: F401 - its import is not part of the writing

    scenes = linkages(runs)
    kind = scene_type("bennett")
    response = fpm.responses.parse("BD", {"distance": ["B", "D"]}, kind.sample)
    outcomes = fpm.simulate(scenes, duration=0.01 * (instants - 1) / 2000, instants=instants)
    datasets = [outcome.dataset([response]) for outcome in outcomes]
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{k}.nc" for k in range(runs)]

        def write():
            for dataset, path in zip(datasets, paths, strict=True):
                fpm.trajectory.write(dataset, path)

        def prepare():
            for outcome in outcomes:
                outcome.dataset([response])

        seconds = best({"prepare": prepare, "write": write}, repeats)
        size = paths[0].stat().st_size / 1024
    note = f"{instants} instants, {size:.0f} KiB"
    return [
        info("dataset of a trajectory", 1e3 * seconds["prepare"] / runs, "ms per run"),
        info("writing a trajectory", 1e3 * seconds["write"] / runs, "ms per run", note),
    ]
