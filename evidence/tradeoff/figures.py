"""The plot of error against cost, and the front of what nothing beats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from evidence import plots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = {
    "tensor_roots": ("o", "tensor_roots (the paper's)"),
    "tensor_lobatto": ("s", "tensor_lobatto"),
    "smolyak": ("D", "smolyak"),
    "sobol": ("x", "plain scan"),
    "spline": ("P", "spline through all runs"),
}
COLOURS = (plots.ORANGE, plots.BLUE, plots.GREEN, plots.PURPLE, plots.SKY, plots.VERMILION)
REFERENCES = {"surrogate": "a scan of its own level", "total": "the finest level"}


def pareto(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points (cost, error) that no other one beats in both, by rising cost."""
    front: list[tuple[float, float]] = []
    for cost, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((cost, error))
    return front


def draw_pareto(case: dict) -> Figure:
    """Error against cpu time: a row for each response, the surrogate's error beside the total."""
    count = len(case["responses"])
    figure, axes = plots.panels(count, 2, (11, 4 * count))
    levels = dict.fromkeys(record["level"] for record in case["records"])
    colours = dict(zip(levels, COLOURS, strict=False))
    for i, name in enumerate(case["responses"]):
        for kind, axis in zip(REFERENCES, axes[2 * i : 2 * i + 2], strict=True):
            _draw_errors(axis, [r for r in case["records"] if kind in r], kind, i, colours)
            axis.set_title(f"{name}: bounds against {REFERENCES[kind]}", fontsize=10)
        axes[2 * i].set_ylabel("error, share of the width")
    _legend(figure, {_mark(record) for record in case["records"]}, colours)
    figure.suptitle(case["title"])
    return figure


def _mark(record: dict) -> str:
    """What a record is drawn as."""
    return "spline" if record["model"] == "spline" else record["method"]


def _draw_errors(axis: Axes, records: list[dict], kind: str, i: int, colours: dict) -> None:
    """The errors of one response, and the fronts.

    Levels are rivals only where all are judged by the same reference."""
    points: dict[str, list] = {}
    for record in records:
        error = record[kind][i]["all"]["hausdorff_integrated"]
        shape, colour = MARKS[_mark(record)][0], colours[record["level"]]
        axis.plot(record["cpu"], error, shape, color=colour, markersize=6)
        group = record["level"] if kind == "surrogate" else "all"
        points.setdefault(group, []).append((record["cpu"], error))
    for group, group_points in points.items():
        style = {"color": colours.get(group, "0.6"), "linewidth": 1, "zorder": 0}
        axis.step(*zip(*pareto(group_points), strict=True), where="post", **style)
    axis.set(xscale="log", yscale="log", xlabel="cpu time (s)")


def _legend(figure: Figure, marks: set[str], colours: dict) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color="k", marker=shape, linestyle="", label=label)
        for mark, (shape, label) in MARKS.items()
        if mark in marks
    ]
    handles += [Line2D([], [], color=c, linewidth=4, label=level) for level, c in colours.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9)
