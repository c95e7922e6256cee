"""The machine's peak, measured in the same vector width, and what the time loop achieves of it."""

import json
import os
import platform

import numpy as np

from evidence.benchmark.clock import best
from evidence.benchmark.kernel import stable
from evidence.benchmark.multiply_adds import unit_times
from evidence.benchmark.processes import python
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.rows import Row, told

GROUP = "How close to the machine's peak"


def describe() -> dict:
    """Processor, cores and versions."""
    import numba

    model = platform.processor() or platform.machine()
    if os.path.exists("/proc/cpuinfo"):
        with open("/proc/cpuinfo") as file:
            names = [line.split(":", 1)[1].strip() for line in file if "model name" in line]
        model = names[0] if names else model
    return {
        "processor": model,
        "cores": len(os.sched_getaffinity(0)),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def counts(elements: int = 12, steps: int = 50) -> dict:
    """Vector operations of a step of the linkage (operations.py), counted in another process."""
    argument = (str(elements), str(steps))
    return json.loads(
        python("-m", "evidence.benchmark.operations", *argument, NUMBA_DISABLE_JIT="1")
    )


def peak(steps: int, repeats: int, elements: int = 12) -> list[Row]:
    """Peak rate, operations of a step, and the share of the peak that the loop reaches."""
    scenes = linkages(8, elements)
    throughput, latency = unit_times()
    seconds = best({"run": runner(scenes, steps, stable(scenes))}, repeats)["run"]
    step = 1e9 * seconds / steps
    counted = counts(elements)
    ops = counted["operations"]
    multiplies = ops["fma"] + ops["multiply"]
    flops = 8 * (2 * ops["fma"] + ops["multiply"] + ops["add"] + ops["divide"] + ops["root"])
    floor = multiplies * throughput
    per = beam_count(scenes[0])
    shares = counted["multiplications"].items()
    parts = ", ".join(
        f"{name} {100 * n / multiplies:.0f} %" for name, n in shares if n > 0.005 * multiplies
    )
    detail = ", ".join(f"{value:.0f} {name}" for name, value in ops.items())
    return [
        told("vector multiply-add, throughput", throughput, "ns",
             f"8 lanes; {16 / throughput:.0f} GFlop/s"),
        told("vector multiply-add, latency", latency, "ns",
             f"{latency / throughput:.1f} must be under way at once for the peak"),
        told("vector operations of a step", sum(ops.values()), "per step", detail),
        told("arithmetic of the loop", flops / step, "GFlop/s",
             f"{100 * flops / step / (16 / throughput):.0f} % of the peak"),
        told("multiplications alone at the peak rate", floor, "ns per step",
             f"{floor / per / 8:.3g} ns per element, step and sample: no arrangement is faster"),
        told("where the multiplications are", multiplies, "per step", parts),
        told("what a step takes", step, "ns per step",
             f"{100 * floor / step:.0f} % of the time the multipliers must be busy"),
    ]  # fmt: skip
