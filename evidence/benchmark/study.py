"""The benchmark: its parts, the machine, and a plot of what a sample and each element kind cost."""

from collections.abc import Mapping, Sequence

from evidence import plots
from evidence.benchmark import campaigns, kernel, kinds, machine, overheads
from evidence.benchmark.peers import compare, structures
from evidence.results import Report
from evidence.rows import Row, set_group

_STORES = ("trajectories", "responses", "extremes")

# Group, and the rows of one part; quick runs are n = 10 times as short.
_PARTS = {
    "cost": (kernel.GROUP, lambda n: kernel.cost(20_000 // n, 5)),
    "cores": (kernel.GROUP, lambda n: kernel.cores(20_000 // n, 8)),
    "recording": (kernel.GROUP, lambda n: kernel.recording(60_000 // n, 8)),
    "memory": (kernel.GROUP, lambda n: kernel.memory(10_000 // n)),
    "kinds": (kinds.GROUP, lambda n: kinds.kinds(20_000 // n, 8)),
    "machine": (machine.GROUP, lambda n: machine.peak(20_000 // n, 8)),
    "starting": (overheads.GROUP, lambda n: overheads.time_start(3)),
    "compiling": (overheads.GROUP, lambda n: overheads.time_compilation()),
    "surrogate": (overheads.GROUP, lambda n: overheads.surrogate(3)),
    "writing": (overheads.GROUP, lambda n: overheads.time_write(3)),
    "campaign": (campaigns.PAPER, lambda n: campaigns.paper()),
    "scan": (campaigns.SCAN, lambda n: campaigns.scans(1000 // n, 20.0, *_STORES)),
    "large_scan": (campaigns.LARGE, lambda n: campaigns.scans(10_000 // n, 10.0, *_STORES[1:])),
    "exudyn": (compare.GROUP, lambda n: compare.exudyn(0.1, 3)),
    "structures": (structures.GROUP, lambda n: structures.exudyn(3 if n == 1 else 1)),
    "elastica": (compare.GROUP, lambda n: compare.elastica(0.02, 3)),
}


def _measure(part: str, quick: bool) -> list[Row]:
    group, rows = _PARTS[part]
    return set_group(group, rows(10 if quick else 1))


PARTS = {part: lambda quick, part=part: _measure(part, quick) for part in _PARTS}


def report(parts: Mapping[str, Sequence[Row]]) -> Report:
    """All rows, and the machine that they were measured on."""
    rows = [row for part in parts.values() for row in part]
    facts = machine.describe()
    text = "\nMachine: " + ", ".join(f"{key}: {value}" for key, value in facts.items()) + ".\n"
    return Report(rows, {"machine": facts}, text, {"benchmark": draw(rows)})


PANELS = (
    (kinds.GROUP, "ns per step of 8 samples", "cost of a step of the same beams", "linear"),
    (compare.GROUP, compare.COST, "cpu time per simulated second and sample", "log"),
)


def draw(rows: Sequence[Row]):
    """Cost of each element kind, and of a sample, ours and the peers'."""
    figure, panels = plots.panels(2, 1, (8, 7))
    for axes, (group, unit, title, scale) in zip(panels, PANELS, strict=True):
        bars = [row for row in rows if (row.group, row.unit) == (group, unit)]
        bars = [row for row in bars if isinstance(row.value, float)]
        axes.barh([row.name for row in bars], [row.value for row in bars], color=plots.BLUE)
        axes.invert_yaxis()
        axes.set(title=title, xlabel=unit)
        if bars:
            axes.set_xscale(scale)
        else:
            axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center")
    return figure
