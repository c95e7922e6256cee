"""Figures of quantities over one or two parameters, else of their width by parameter."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.pictures import make_figure
from deployable.campaign.pictures.colours import BLUE, RED
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.text.numbers import pretty

_LINE, _GRID = 401, 121
_WIDTH = 7.0  # of the figure, inches
_GREY = "0.75"


def ranges(results: QuantityResults, runs: FittedRuns, surrogates: Sequence[Any]) -> Any:
    """Make a matplotlib figure with one plot for each quantity: its value over one or two
    parameters, or where there are more the width of its interval by parameter."""
    parameters, count = results.parameters, len(results.rows)
    free = [j for j, p in enumerate(parameters) if p["upper"] > p["lower"]]
    columns = 1 if len(free) > 2 or count == 1 else 2
    rows = -(-count // columns)
    height = (0.6 + 0.22 * len(free)) if len(free) > 2 else 2.7
    figure = make_figure(figsize=(_WIDTH, rows * height + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    draw = {0: _Plot.draw_line, 1: _Plot.draw_line, 2: _Plot.draw_map}.get(
        len(free), _Plot.draw_bars
    )
    quantities = zip(results.rows, runs.numbers.T, surrogates, strict=True)
    for ax, (row, values, surrogate) in zip(axes, quantities, strict=False):
        values = values * row.get("scale", 1.0)
        draw(_Plot(row, parameters, free or [0], runs.points, values, surrogate), ax)
        ax.set_title(textwrap.fill(row["long_name"], 90 // columns), fontsize=8)
        ax.tick_params(labelsize=7)
    for ax in axes[count:]:
        ax.set_axis_off()
    return figure


class _Plot(NamedTuple):
    """A quantity, by its row in the summary, over parameters of indices `free`. points (R, k),
    values (R): of the fitted runs."""

    row: Mapping[str, Any]
    parameters: Sequence[Mapping[str, Any]]
    free: list[int]
    points: np.ndarray
    values: np.ndarray
    surrogate: Any

    def scale(self, j: int, coordinates: np.ndarray) -> np.ndarray:
        """Values of a parameter at coordinates from -1 to 1."""
        lower, upper = self.parameters[j]["lower"], self.parameters[j]["upper"]
        return lower + (coordinates + 1) / 2 * (upper - lower)

    def evaluate(self, points: np.ndarray) -> np.ndarray:
        """Values (N) of the fit at points (N, k), in the units of the row."""
        return self.surrogate.evaluate(points) * self.row.get("scale", 1.0)

    def draw_line(self, ax: Any) -> None:
        """The quantity against the one parameter; grey where it does not happen."""
        row, (j,) = self.row, self.free
        points = np.zeros((_LINE, len(self.parameters)))
        points[:, j] = np.linspace(-1, 1, _LINE)
        curve, mask = self.evaluate(points), np.isfinite(self.values)
        x, places = self.scale(j, points[:, j]), self.scale(j, self.points[:, j])
        ax.plot(x, curve, color=BLUE, lw=1.2)
        ax.plot(places[mask], self.values[mask], "o", color="black", ms=3)
        for side, colour in (("lower", BLUE), ("upper", RED)):
            if row[side] is not None:
                ax.axhline(row[side], color=colour, lw=0.8, ls=(0, (4, 2)))
        missing = ~np.isfinite(curve)
        if missing.any():
            ax.fill_between(x, 0, 1, where=missing, transform=ax.get_xaxis_transform(),
                            color="0.9", lw=0, label="does not happen")  # fmt: skip
            ax.plot(places[~mask], np.full(np.sum(~mask), 0.03), "x", color=RED, ms=4,
                    transform=ax.get_xaxis_transform(), label="runs without")  # fmt: skip
            ax.legend(fontsize=7, frameon=False)
        ax.set_xlabel(_label(self.parameters[j]), fontsize=8)
        ax.set_ylabel(_label(row), fontsize=8)

    def draw_map(self, ax: Any) -> None:
        """The quantity over both parameters; grey where it does not happen."""
        row, (i, j) = self.row, self.free
        line = np.linspace(-1, 1, _GRID)
        points = np.zeros((_GRID**2, len(self.parameters)))
        points[:, i], points[:, j] = (grid.ravel() for grid in np.meshgrid(line, line))
        field = self.evaluate(points).reshape(_GRID, _GRID)
        x, y = self.scale(i, line), self.scale(j, line)
        if np.isfinite(field).any() and np.nanmax(field) > np.nanmin(field):
            contours = ax.contourf(x, y, field, 12, cmap="cividis")
            bar = ax.figure.colorbar(contours, ax=ax)
            bar.set_label(_label(row), fontsize=8)
            bar.ax.tick_params(labelsize=7)
        if (missing := ~np.isfinite(field)).any():
            ax.contourf(x, y, missing, [0.5, 1.5], colors=["0.9"])
            ax.fill_between([], [], color="0.9", label="does not happen")
            ax.legend(fontsize=7, frameon=False)
        mask = np.isfinite(self.values)
        marks = (mask, "o", "white", "black"), (~mask, "x", RED, RED)
        for kind, mark, colour, edge in marks:
            places = [self.scale(c, self.points[kind, c]) for c in (i, j)]
            ax.plot(*places, mark, color=colour, mec=edge, ms=3.5, clip_on=False)
        for bound, mark in (("argmin", "v"), ("argmax", "^")):
            place = [row[bound][self.parameters[c]["name"]] for c in (i, j)]
            if None not in place:
                ax.plot(*place, mark, color="white", mec="black", ms=7, clip_on=False)
        for line in ax.lines:  # on the border: their size would collapse the layout of many maps
            line.set_in_layout(False)
        ax.set_xlabel(_label(self.parameters[i]), fontsize=8)
        ax.set_ylabel(_label(self.parameters[j]), fontsize=8)

    def draw_bars(self, ax: Any) -> None:
        """Width when one parameter varies alone; grey where that is not above the error."""
        names = [self.parameters[j]["name"] for j in self.free]
        widths, shares = (
            np.array([self.row["influence"][name][key] or 0.0 for name in names])
            for key in ("alone", "share")
        )
        ax.barh(names, widths, color=[BLUE if s > 0 else _GREY for s in shares], height=0.6)
        for place, share in enumerate(shares):
            text = f" {100 * share:.0f} %" if share > 0 else " not above the error"
            ax.text(widths[place], place, text, va="center", fontsize=7)
        ax.set_xlim(0, 1.45 * widths.max() or 1.0)
        ax.invert_yaxis()
        ax.set_xlabel(f"width alone ({pretty(self.row['units'])})", fontsize=8)


def _label(row: Mapping[str, Any]) -> str:
    return f"{row['name']} ({pretty(row['units'])})"
