"""The study of scaling: masts of 1 to 100 units beside the linkage."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np

from evidence.results import Report, table
from evidence.rows import Row, at_most, info
from evidence.scaling import masts
from evidence.scaling.masts import Size

MOST_GROWTH = 1.25
"""Exponent of the cost in the size, from 10 units on: 1 is linear; caches add to it."""

MIN_UNITS = 10

MOST_BALANCE = 1e-4
"""Imbalance as a share of the largest kinetic energy: a twentieth of what campaigns allow."""

MOST_GAP, MOST_TILT = 1e-11, 1e-9
"""Of joints, m and rad: what the linkage keeps as a rule (fpm/elements/joints/hinge_arrays.py)."""


def measure_all(quick: bool = False) -> list[Size]:
    """Run all sizes."""
    return masts.measure((1, 10, 20), 1000, 1) if quick else masts.measure()


PARTS = {"sizes": measure_all}


def report(parts: Mapping[str, list[Size]]) -> Report:
    """What the study claims, and all sizes as a table."""
    sizes = parts["sizes"]
    text = "\n## Sizes\n\n" + sizes_table(sizes)
    return Report(mast_rows(sizes), {"sizes": [asdict(size) for size in sizes]}, text)


def growth(sizes: Sequence[Size]) -> float:
    """The exponent of the cost of a step in the number of units, from FROM on."""
    large = [size for size in sizes if size.units >= MIN_UNITS]
    logs = np.log([(size.units, size.cost) for size in large])
    return float(np.polyfit(*logs.T, 1)[0])


def mast_rows(sizes: Sequence[Size]) -> list[Row]:
    """How the cost grows, and that nothing else does."""
    linkage, *rest = sizes
    largest = rest[-1]
    name = f"exponent of the cost of a step, {MIN_UNITS} to {largest.units} units"
    costs = [1e9 * s.cost / s.elements / masts.LANES for s in (linkage, largest)]
    note = f"{costs[1]:.3g} ns an element and sample at the end, the linkage {costs[0]:.3g}"
    rows = [at_most(name, growth(sizes), MOST_GROWTH, "1 is linear", note)]
    for field, limit, unit in (
        ("balance", MOST_BALANCE, ""), ("gap", MOST_GAP, "m"), ("tilt", MOST_TILT, "rad")
    ):  # fmt: skip
        worst = max(getattr(size, field) for size in rest)
        note = f"the linkage: {getattr(linkage, field):.2g}"
        rows.append(at_most(f"largest {field} of a mast", worst, limit, "required", note, unit))
    steps = [size.step for size in rest]
    rows.append(at_most("longest step over shortest", max(steps) / min(steps), 1.001,
                        "the same elements"))  # fmt: skip
    note = f"the linkage: {1e3 * linkage.build_time:.3g} ms"
    rows.append(info(f"building {largest.units} units, and their stable step",
                     1e3 * largest.build_time, "ms", note))  # fmt: skip
    return rows


def sizes_table(sizes: Sequence[Size]) -> str:
    """All sizes as a table."""
    header = ["units", "elements", "joints", "step (s)", "µs a step of 8 samples"]
    header += ["ns an element and sample", "building (ms)", "balance", "gap (m)", "tilt (rad)"]
    rows = [
        [
            size.units or "the linkage", size.elements, size.joints, size.step, 1e6 * size.cost,
            1e9 * size.cost / size.elements / masts.LANES, 1e3 * size.build_time, size.balance,
            size.gap, size.tilt,
        ]
        for size in sizes
    ]  # fmt: skip
    return table(header, rows)
