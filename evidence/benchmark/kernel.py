"""The time loop: cost per element, step and sample; lanes, cores, recording and memory."""

import json
import os
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.multiply_adds import functions, operands
from evidence.benchmark.processes import python
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.rows import Row, at_least, at_most, info, skip_row

GROUP = "Kernel: the paper's linkage"
UNIT = "ns per element, step and sample"
LANES = 8

MEMORY = """
import json, sys
from pathlib import Path
import fpm
from evidence.benchmark.scenes import linkages, runner
instants, steps, samples, step = json.loads(sys.argv[1])
run = runner(linkages(samples), steps, step, instants)
runner(linkages(samples), 2, step)()
def read(key):
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(key))
Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
before = read("VmRSS")
run()
print(read("VmHWM") - before, before)
"""


def stable(scenes: list[fpm.Scene]) -> float:
    """A step (s) that suits all the scenes, found from the first."""
    return 0.85 * fpm.find_stable_step(scenes[0]).step


def cost(steps: int, repeats: int, samples: int = 32, meshes=(8, 12, 16, 32)) -> list[Row]:
    """A batch and a single sample on several meshes, and their ratio."""
    runs, units = {}, {}
    for elements in meshes:
        scenes = linkages(samples, elements)
        step = stable(scenes)
        for name, group in ((f"batch {elements}", scenes), (f"single {elements}", scenes[:1])):
            runs[name] = runner(group, steps, step)
            units[name] = beam_count(scenes[0]) * steps * len(group)
    runs["set-up"] = runner(linkages(samples, meshes[0]), 1, stable(linkages(1, meshes[0])))
    seconds = best(runs, repeats)
    costs = {name: 1e9 * seconds[name] / units[name] for name in units}
    setup = 1e3 * seconds["set-up"] / samples
    rows = [info("setting up a run and handing it back", setup, "ms per sample")]
    for elements in meshes:
        batch, single = costs[f"batch {elements}"], costs[f"single {elements}"]
        label = f"{elements} elements a link" + (" (default)" if elements == 12 else "")
        all_elements = batch * elements / (elements + 2)
        note = f"{all_elements:.3g} with the virtual beams counted as elements"
        rows.append(at_most(f"batch of {samples}, {label}", batch, 6.0, note=note, unit=UNIT))
        note = "one sample fills one lane of eight, and costs as much as eight"
        name, unit = f"single sample, {label}", "ns per element and step"
        rows.append(at_most(name, single, 40.0, note=note, unit=unit))
        name = f"lanes against one sample, {label}"
        rows.append(at_least(name, single / batch, 5.0, unit="x"))
    return rows


def cores(steps: int, repeats: int, samples: int = 16) -> list[Row]:
    """Two batches one after the other against two at once, in threads; wall time.

    The same with multiply-adds in registers, which no program can do better, tells what the machine
    has to give at that time."""
    name, unit = "two cores against one", "x"
    if len(os.sched_getaffinity(0)) < 2:
        return [skip_row(name, "needs a machine with two cores", unit)]
    scenes = linkages(samples)
    batch = runner(scenes, steps, stable(scenes))
    independent, *_ = functions()
    bare = [partial(independent, operands(), 3000 * steps) for _ in range(2)]
    bare[0]()
    with ThreadPoolExecutor(2) as pool:

        def time_parallel(pair):
            for future in [pool.submit(run) for run in pair]:
                future.result()

        def time_alternately(pair):
            for run in pair:
                run()

        runs = {}
        for case, pair in (("batch", (batch, batch)), ("bare", bare)):
            runs[f"{case} together"] = partial(time_parallel, pair)
            runs[f"{case} in turn"] = partial(time_alternately, pair)
        seconds = best(runs, repeats, time.perf_counter)
    ratio, gain = (seconds[f"{k} in turn"] / seconds[f"{k} together"] for k in ("batch", "bare"))
    note = f"two threads; multiply-adds in registers gain {gain:.2f} x at the same time"
    return [at_least(name, ratio, 1.8, note=note, unit=unit)]


def recording(steps: int, repeats: int, instants: int = 2001) -> list[Row]:
    """The same steps with many instants recorded and with two."""
    scenes = linkages(LANES)
    steps = max(1, round(steps / (instants - 1))) * (instants - 1)
    step = stable(scenes)
    runs = {str(n): runner(scenes, steps, step, n) for n in (2, instants)}
    seconds = best(runs, repeats)
    extra = 100 * (seconds[str(instants)] / seconds["2"] - 1)
    name = f"recording {instants - 1} instants in {steps} steps against 2"
    return [at_most(name, extra, 5.0, unit="% more")]


def memory(steps: int, times: int = 10, instants: int = 2001) -> list[Row]:
    """Peak memory of runs of different length and of different numbers of instants."""
    name = f"memory of a run of {times} times as many steps, the same {instants} instants"
    if not os.path.exists("/proc/self/clear_refs"):
        return [skip_row(name, "needs Linux (/proc/self/clear_refs)", "MiB more")]
    step = stable(linkages(1))
    steps = max(1, round(steps / (instants - 1))) * (instants - 1)
    short, _ = _measure_growth(instants, steps, step)
    long, base = _measure_growth(instants, times * steps, step)
    dense, _ = _measure_growth(times * (instants - 1) + 1, times * steps, step)
    note = f"{short / 1024:.1f} MiB for 8 samples, on top of {base / 1024:.0f} MiB of the process"
    item_bytes = 1024 * (dense - long) / ((times - 1) * (instants - 1) * LANES)
    return [
        at_most(name, (long - short) / 1024, 1.0, note=note, unit="MiB more"),
        info("memory for what is recorded", item_bytes, "bytes per instant and sample"),
    ]


def _measure_growth(instants: int, steps: int, step: float) -> tuple[int, int]:
    """By how much a run raises its process's peak memory, and what that was at first (KiB)."""
    task = json.dumps([instants, steps, LANES, step])
    growth, base = map(int, python("-c", MEMORY, task).split())
    return growth, base
