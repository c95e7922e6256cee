"""The plot of the benchmark: cost of a sample, ours and the peers', and of each element kind."""

import os
from collections.abc import Sequence
from pathlib import Path

from benchmark import kinds, peers
from benchmark.rows import Row


def costs(rows: Sequence[Row], folder: str | os.PathLike) -> None:
    """benchmark.png in `folder`."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    panels = (
        (kinds.GROUP, "ns per step of 8 samples", "cost of a step of the same beams", False),
        (peers.GROUP, peers.COST, "cpu time per simulated second and sample", True),
    )
    figure, axes = pyplot.subplots(2, 1, figsize=(8, 7), layout="constrained")
    for axis, (group, unit, title, logarithmic) in zip(axes, panels, strict=True):
        shown = [
            row
            for row in rows
            if row.group == group and row.unit == unit and isinstance(row.value, float)
        ]
        names = [row.name for row in shown]
        axis.barh(names, [row.value for row in shown], color="#0072b2")
        axis.invert_yaxis()
        axis.set(title=title, xlabel=unit.replace("cpu s", "s (log scale)"))
        if logarithmic and shown:
            axis.set_xscale("log")
        if not shown:
            axis.text(0.5, 0.5, "not measured", transform=axis.transAxes, ha="center")
    figure.savefig(Path(folder) / "benchmark.png", dpi=150)
    pyplot.close(figure)
