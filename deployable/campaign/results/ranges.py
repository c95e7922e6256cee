"""Figures of quantities over one or two parameters, else of their width by parameter."""

import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.pictures.colours import BLUE, RED
from deployable.campaign.pictures.figure import make_figure
from deployable.campaign.results.figures import save
from deployable.campaign.results.fitted_runs import FittedRuns
from deployable.campaign.text.numbers import pretty

_LINE, _GRID = 401, 121
_WIDTH = 7.0  # of the figure, inches
_GREY = "0.75"


def draw_ranges(folder: Folder, target: str | Path) -> None:
    """Draw all quantities over the box of parameters as `ranges.png` and `.pdf`. folder:
    the campaign's results, which are read; target: folder of the files."""
    with open_netcdf(folder.quantities) as data:
        figure = ranges(data, FittedRuns.read(folder))
    save(figure, Path(target) / "ranges")


def ranges(data: Any, runs: FittedRuns) -> Any:
    """Make a matplotlib figure with one plot for each quantity: its value over one or two
    parameters, or where there are more the width of its interval by parameter. data: the open
    `quantities.nc`; runs: the fitted ones."""
    free = np.flatnonzero(data["box_upper"][:] > data["box_lower"][:])
    count = len(data["quantity"])
    columns = 1 if len(free) > 2 or count == 1 else 2
    rows = -(-count // columns)
    height = (0.6 + 0.22 * len(free)) if len(free) > 2 else 2.7
    figure = make_figure(figsize=(_WIDTH, rows * height + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    draw = {0: _line, 1: _line, 2: _map}.get(len(free), _bars)
    for q, ax in enumerate(axes):
        if q < count:
            draw(ax, data, q, runs, free)
            title = textwrap.fill(data["quantity_long_name"][q], 90 // columns)
            ax.set_title(title, fontsize=8)
            ax.tick_params(labelsize=7)
        else:
            ax.set_axis_off()
    return figure


def _label(data: Any, j: int) -> str:
    units = pretty(data["box_units"][j])
    return f"{data['parameter'][j]} ({units})"


def _values(data: Any, j: int, points: np.ndarray) -> np.ndarray:
    lower, upper = data["box_lower"][j], data["box_upper"][j]
    return lower + (points + 1) / 2 * (upper - lower)


def _line(ax: Any, data: Any, q: int, runs: FittedRuns, free: Any) -> None:
    """The quantity against the one parameter; grey where it does not happen."""
    j = int(free[0]) if len(free) else 0
    normalized, values = runs.points, runs.numbers[:, q]
    points = np.zeros((_LINE, normalized.shape[1]))
    points[:, j] = np.linspace(-1, 1, _LINE)
    curve = runs.surrogate(data, q).evaluate(points)
    x, mask = _values(data, j, points[:, j]), np.isfinite(values)
    ax.plot(x, curve, color=BLUE, lw=1.2)
    ax.plot(_values(data, j, normalized[mask, j]), values[mask], "o", color="black", ms=3)
    for side, colour in (("lower", BLUE), ("upper", RED)):
        if np.isfinite(data[side][q]):
            ax.axhline(data[side][q], color=colour, lw=0.8, ls=(0, (4, 2)))
    missing = ~np.isfinite(curve)
    if missing.any():
        ax.fill_between(x, 0, 1, where=missing, transform=ax.get_xaxis_transform(),
                        color="0.9", lw=0, label="does not happen")  # fmt: skip
        idle = _values(data, j, normalized[~mask, j])
        ax.plot(idle, np.full(len(idle), 0.03), "x", color=RED, ms=4,
                transform=ax.get_xaxis_transform(), label="runs without")  # fmt: skip
        ax.legend(fontsize=7, frameon=False)
    ax.set_xlabel(_label(data, j), fontsize=8)
    ax.set_ylabel(f"{data['quantity'][q]} ({pretty(data['quantity_units'][q])})", fontsize=8)


def _map(ax: Any, data: Any, q: int, runs: FittedRuns, free: Any) -> None:
    """The quantity over both parameters; grey where it does not happen."""
    i, j = map(int, free)
    normalized, values = runs.points, runs.numbers[:, q]
    line = np.linspace(-1, 1, _GRID)
    points = np.zeros((_GRID**2, normalized.shape[1]))
    points[:, i], points[:, j] = (grid.ravel() for grid in np.meshgrid(line, line))
    field = runs.surrogate(data, q).evaluate(points).reshape(_GRID, _GRID)
    x, y = _values(data, i, line), _values(data, j, line)
    if np.isfinite(field).any() and np.nanmax(field) > np.nanmin(field):
        contours = ax.contourf(x, y, field, 12, cmap="cividis")
        bar = ax.figure.colorbar(contours, ax=ax)
        bar.set_label(f"{data['quantity'][q]} ({pretty(data['quantity_units'][q])})", fontsize=8)
        bar.ax.tick_params(labelsize=7)
    if (missing := ~np.isfinite(field)).any():
        ax.contourf(x, y, missing, [0.5, 1.5], colors=["0.9"])
        ax.fill_between([], [], color="0.9", label="does not happen")
        ax.legend(fontsize=7, frameon=False)
    mask = np.isfinite(values)
    for kind, mark, colour in ((mask, "o", "white"), (~mask, "x", RED)):
        points = [_values(data, c, normalized[kind, c]) for c in (i, j)]
        ax.plot(*points, mark, color=colour, mec="black" if mark == "o" else colour, ms=3.5,
                clip_on=False)  # fmt: skip
    for bound, mark in (("argmin", "v"), ("argmax", "^")):
        point = data[bound][q]
        ax.plot(point[i], point[j], mark, color="white", mec="black", ms=7, clip_on=False)
    for line in ax.lines:  # on the border: their size would collapse the layout of many maps
        line.set_in_layout(False)
    ax.set_xlabel(_label(data, i), fontsize=8)
    ax.set_ylabel(_label(data, j), fontsize=8)


def _bars(ax: Any, data: Any, q: int, runs: FittedRuns, free: Any) -> None:
    """Width when one parameter varies alone; grey where that is not above the error."""
    names = [data["parameter"][j] for j in free]
    widths, share = data["alone"][q][free], data["share"][q][free]
    widths = np.where(np.isfinite(widths), widths, 0.0)
    ax.barh(names, widths, color=[BLUE if s > 0 else _GREY for s in share], height=0.6)
    for row, s in enumerate(share):
        text = f" {100 * s:.0f} %" if s > 0 else " not above the error"
        ax.text(widths[row], row, text, va="center", fontsize=7)
    ax.set_xlim(0, 1.45 * widths.max() or 1.0)
    ax.invert_yaxis()
    ax.set_xlabel(f"width alone ({pretty(data['quantity_units'][q])})", fontsize=8)
