"""How the studies draw: one palette, figures without a global state, files that do not vary."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from deployable.campaign.files import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from evidence.rows import Row

# Okabe and Ito's colours, which colour-blind readers can tell apart.
BLUE, VERMILION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, YELLOW, BLACK, GREY = "#E69F00", "#56B4E9", "#F0E442", "#000000", "#888888"
COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK, GREY)
MARKERS = "osD^vP*X"
LEAST = 1e-6
"""Where the axis of shares of a tolerance starts; what is less stands there."""


def panels(
    rows: int = 1, columns: int = 1, size: tuple[float, float] = (6.4, 4.2), **options: Any
) -> tuple[Figure, list[Axes]]:
    """A figure of `size` inches and its axes, row by row; options as `Figure.subplots` takes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for panel in axes.flat:
        panel.grid(color="0.9", linewidth=0.5)
        panel.set_axisbelow(True)
    return figure, list(axes.flat)


class Chart:
    """A plot of a few curves; axis labels carry the units.

    Computed lines are solid, with markers if they have few points; references are dashed."""

    def __init__(
        self, title: str, x_label: str, y_label: str, logarithmic: bool = False, equal: bool = False
    ):
        self.title = title
        self.figure, (self.axes,) = panels()
        self.axes.set(title=title, xlabel=x_label, ylabel=y_label)
        if logarithmic:
            self.axes.set(xscale="log", yscale="log")
        if equal:
            self.axes.set_aspect("equal", adjustable="datalim")

    def curve(self, x: Sequence, y: Sequence, label: str, reference: bool = False) -> None:
        """Add a line; x, y (n,)."""
        i = len(self.axes.lines)
        marker = MARKERS[i % len(MARKERS)] if len(x) <= 50 else None
        style = {"color": COLOURS[i % len(COLOURS)], "marker": marker, "zorder": 2}
        if reference:
            style = {"color": "#444444", "linestyle": "--", "zorder": 3}
        self.axes.plot(x, y, label=label, linewidth=1.2, markersize=4, **style)
        self.axes.legend(fontsize="small")

    @property
    def name(self) -> str:
        """Name of the plot's files."""
        return "-".join(re.findall(r"\w+", self.title.lower().replace("°", " degree")))


def draw_utilization(axes: Axes, rows: Sequence[Row], labels: Sequence[str]) -> None:
    """How much of its allowance each row takes, at the height of its label.

    Dots passed, large crosses failed; small crosses at the left are clear refusals."""
    places = {label: i for i, label in enumerate(dict.fromkeys(labels))}
    for row, label in zip(rows, labels, strict=True):
        if isinstance(row.value, str):
            x, style = LEAST, {"marker": "x", "color": ORANGE, "markersize": 4}
        elif row.is_failed:
            x = max(row.utilization, LEAST) if row.utilization > 0 else 10.0
            style = {"marker": "X", "color": VERMILION, "markersize": 9}
        elif math.isnan(row.utilization):
            continue
        else:
            x, style = max(row.utilization, LEAST), {"marker": "o", "color": BLUE, "markersize": 4}
        axes.plot(x, places[label], alpha=0.6, linestyle="", **style)
    axes.axvline(1.0, color="#444444", linestyle="--", linewidth=1)
    axes.set(xscale="log", xlabel="error / what is allowed (x: refused)")
    axes.set_yticks(range(len(places)), list(places))
    axes.margins(y=0.01)
    axes.invert_yaxis()


def save(figure: Figure, path: Path) -> None:
    """Write a figure as `path`.png and .pdf, without a date: equal data give equal files."""
    for kind, metadata in (("png", {"Software": None}), ("pdf", {"CreationDate": None})):
        with whole_file(path.with_name(f"{path.name}.{kind}")) as temporary:
            figure.savefig(temporary, dpi=150, metadata=metadata)
