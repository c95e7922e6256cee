"""The machine's peak, measured in the same vector width, and what the time loop achieves of it."""

import json
import os
import platform
from functools import partial

import numpy as np

from evidence.benchmark.clock import best
from evidence.benchmark.kernel import stable
from evidence.benchmark.multiply_adds import IN_A_ROUND, MIXTURE, functions, operands
from evidence.benchmark.processes import python
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.rows import Row, at_most, info

GROUP = "How close to the machine's peak"

MULTIPLICATIONS = 220
"""At most, an element and step of the linkage at 12 elements a link."""

LATENCY = 4
"""Cycles of a multiply-add, on the processors of today with registers of 512 bits."""

AGAINST_FLOOR = {1: 1.25, 2: 1.6}
"""What a step may take of the time of its multiplications alone, by how many the processor does a
cycle: twice as fast ones leave half the time for all else."""


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
    words = "-m", "evidence.benchmark.operations", *argument
    return json.loads(python(*words, NUMBA_DISABLE_JIT="1"))


def times(steps: int, repeats: int, elements: int, rounds: int = 100_000) -> tuple[float, ...]:
    """Nanoseconds of a multiply-add among independent ones and after another (throughput, latency),
    of a round of the mixture, and of a step of eight linkages, without setting up; in turns."""
    scenes = linkages(8, elements)
    step, fewer = stable(scenes), steps // 10
    independent, dependent, mixture = functions()
    mixtures = max(1, rounds // 50)
    runs = {
        "independent": partial(independent, operands(), rounds),
        "dependent": partial(dependent, operands(), rounds),
        "mixture": partial(mixture, operands(), mixtures),
        "run": runner(scenes, steps, step),
        "fewer": runner(scenes, fewer, step),
    }
    best(runs, 1)
    ns = {name: 1e9 * seconds for name, seconds in best(runs, repeats).items()}
    period = (ns["run"] - ns["fewer"]) / (steps - fewer)
    throughput = ns["independent"] / rounds / IN_A_ROUND
    return throughput, ns["dependent"] / rounds, ns["mixture"] / mixtures, period


def peak(steps: int, repeats: int, elements: int = 12) -> list[Row]:
    """Peak rate, operations of a step, and the share of the peak that the loop reaches."""
    throughput, latency, mixture, step = times(steps, repeats, elements)
    tally = counts(elements)
    ops = tally["operations"]
    multiplies = ops["fma"] + ops["multiply"]
    flops = 8 * (2 * ops["fma"] + ops["multiply"] + ops["add"] + ops["divide"] + ops["root"])
    floor = multiplies * throughput
    # As many rounds of the mixture as do what a step does.
    arithmetic = sum(ops[name] for name in MIXTURE) / sum(MIXTURE.values()) * mixture
    count = beam_count(linkages(1, elements)[0])
    a_cycle = min(AGAINST_FLOOR, key=lambda n: abs(n - latency / throughput / LATENCY))
    shares = tally["multiplications"].items()
    percentages = [(name, 100 * n / multiplies) for name, n in shares]
    parts = ", ".join(f"{name} {x:.0f} %" for name, x in percentages if x > 0.5)
    detail = ", ".join(f"{value:.0f} {name}" for name, value in ops.items())
    return [
        info("vector multiply-add, throughput", throughput, "ns",
             f"8 lanes; {16 / throughput:.0f} GFlop/s"),
        info("vector multiply-add, latency", latency, "ns",
             f"{latency / throughput:.1f} must be under way at once for the peak"),
        info("vector operations of a step", sum(ops.values()), "per step", detail),
        info("arithmetic of the loop", flops / step, "GFlop/s",
             f"{100 * flops / step / (16 / throughput):.0f} % of the peak"),
        info("multiplications alone at the peak rate", floor, "ns per step",
             f"{floor / count / 8:.3g} ns per element, step and sample: no arrangement is faster"),
        at_most("multiplications", multiplies / count, MULTIPLICATIONS, unit="an element and step",
                note=f"{multiplies:.0f} a step: {parts}"),
        info("what a step takes", step, "ns per step",
             f"{100 * floor / step:.0f} % of the time the multipliers must be busy"),
        at_most("a step against its multiplications alone", step / floor, AGAINST_FLOOR[a_cycle],
                unit="x", note=f"this processor does {a_cycle} a cycle"),
        info("its arithmetic alone, also additions, quotients and roots", arithmetic, "ns per step",
             f"{arithmetic / floor:.2f} of its multiplications alone"),
        info("a step against its arithmetic alone", step / arithmetic, "x"),
    ]  # fmt: skip
