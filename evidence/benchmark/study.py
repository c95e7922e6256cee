"""The benchmark: its parts, and the machine."""

import os
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from evidence.benchmark import campaigns, kernel, overheads
from evidence.benchmark.peers import compare
from evidence.results import Report
from evidence.rows import Row, set_group

# Group, and the rows of one part; quick runs are n = 10 times as short.
_PARTS = {
    "cost": (kernel.GROUP, lambda n: kernel.cost(20_000 // n, 5)),
    "starting": (overheads.GROUP, lambda n: overheads.time_start(3)),
    "compiling": (overheads.GROUP, lambda n: overheads.time_compilation()),
    "campaign": (campaigns.GROUP, lambda n: campaigns.paper(repeats=3 if n == 1 else 1)),
    "exudyn": (compare.GROUP, lambda n: compare.exudyn(0.1, 3)),
}


def _measure(part: str, quick: bool) -> list[Row]:
    group, rows = _PARTS[part]
    return set_group(group, rows(10 if quick else 1))


PARTS = {part: lambda quick, part=part: _measure(part, quick) for part in _PARTS}


def report(parts: Mapping[str, Sequence[Row]]) -> Report:
    """All rows, and the machine that they were measured on."""
    rows = [row for part in parts.values() for row in part]
    facts = describe_machine()
    text = "\nMachine: " + ", ".join(f"{key}: {value}" for key, value in facts.items()) + ".\n"
    return Report(rows, {"machine": facts}, text)


def describe_machine() -> dict:
    """Processor, cores and versions."""
    import numba

    model, info = platform.processor() or platform.machine(), Path("/proc/cpuinfo")
    if info.exists():
        lines = info.read_text().splitlines()
        model = next((x.split(":", 1)[1].strip() for x in lines if "model name" in x), model)
    return {
        "processor": model,
        "cores": len(os.sched_getaffinity(0)),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }
