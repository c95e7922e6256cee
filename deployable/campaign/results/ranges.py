"""A picture of every quantity: over the box where it has one or two parameters, else what each
parameter contributes."""

from __future__ import annotations

import json
import textwrap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.pictures.colours import BLUE, RED
from deployable.campaign.results.figures import save
from deployable.campaign.results.which import fitted_rows, margins_of_samples
from deployable.campaign.text.numbers import pretty

_LINE, _GRID = 401, 121
_GREY = "0.75"


def draw_ranges(folder: Folder, place: str | Path) -> None:
    """Draw `ranges.png`, `.pdf` and `.svg` into `place`."""
    with open_netcdf(folder.quantities) as found:
        figure = ranges(found, runs_of(folder))
    save(figure, Path(place) / "ranges")


def ranges(found: Any, seen: Seen, width: float = 7.0) -> Any:
    """A figure of the open `quantities.nc`, with the runs; width in inches."""
    from matplotlib.figure import Figure

    free = np.flatnonzero(found["box_upper"][:] > found["box_lower"][:])
    count = len(found["quantity"])
    columns = 1 if len(free) > 2 or count == 1 else 2
    rows = -(-count // columns)
    height = (0.6 + 0.22 * len(free)) if len(free) > 2 else 2.7
    figure = Figure(figsize=(width, rows * height + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    draw = {0: _line, 1: _line, 2: _map}.get(len(free), _bars)
    for q, ax in enumerate(axes):
        if q < count:
            draw(ax, found, q, seen, free)
            title = textwrap.fill(found["quantity_long_name"][q], 90 // columns)
            ax.set_title(title, fontsize=8)
            ax.tick_params(labelsize=7)
        else:
            ax.set_axis_off()
    return figure


class Seen(NamedTuple):
    """Unit points (R, k) of runs, their numbers (R, q) and by how much they have these (R, q)."""

    unit: np.ndarray
    numbers: np.ndarray
    margins: np.ndarray

    def surrogate(self, found: Any, q: int) -> Any:
        """What `quantities.nc` was made with: the surrogate of the same runs, no lower than what is
        possible."""
        from deployable.intervals.scalars import fit_scalar

        end = json.loads(found.config)["solver"]["duration"]
        least = float(found["least"][q])
        latest = end if found["is_time"][q] else None
        least = least if np.isfinite(least) else None
        return fit_scalar(self.unit, self.numbers[:, q], latest, least, self.margins[:, q])


def runs_of(folder: Folder) -> Seen:
    """The runs fitted to, the further ones too."""
    with open_netcdf(folder.samples) as file:
        numbers = file["quantities"][:]
        rows = fitted_rows(numbers)
        experiment = Experiment.read(file.config)
        margins = margins_of_samples(experiment, file, rows)
        parts = [(file["normalized"][:][rows], numbers[rows], margins)]
    with open_netcdf(folder.further) as file:
        parts.append(tuple(file[name][:] for name in ("normalized", "quantities", "margin")))
    return Seen(*map(np.concatenate, zip(*parts, strict=True)))


def _label(found: Any, j: int) -> str:
    units = pretty(found["box_units"][j])
    return f"{found['parameter'][j]} ({units})"


def _values(found: Any, j: int, unit: np.ndarray) -> np.ndarray:
    lower, upper = found["box_lower"][j], found["box_upper"][j]
    return lower + (unit + 1) / 2 * (upper - lower)


def _line(ax: Any, found: Any, q: int, seen: Seen, free: Any) -> None:
    """The quantity against the one parameter; grey where it does not happen."""
    j = int(free[0]) if len(free) else 0
    unit, values = seen.unit, seen.numbers[:, q]
    points = np.zeros((_LINE, unit.shape[1]))
    points[:, j] = np.linspace(-1, 1, _LINE)
    curve = seen.surrogate(found, q).evaluate(points)
    x, there = _values(found, j, points[:, j]), np.isfinite(values)
    ax.plot(x, curve, color=BLUE, lw=1.2)
    ax.plot(_values(found, j, unit[there, j]), values[there], "o", color="black", ms=3)
    for side, colour in (("lower", BLUE), ("upper", RED)):
        if np.isfinite(found[side][q]):
            ax.axhline(found[side][q], color=colour, lw=0.8, ls=(0, (4, 2)))
    missing = ~np.isfinite(curve)
    if missing.any():
        ax.fill_between(x, 0, 1, where=missing, transform=ax.get_xaxis_transform(),
                        color="0.9", lw=0, label="does not happen")  # fmt: skip
        without = _values(found, j, unit[~there, j])
        ax.plot(without, np.full(len(without), 0.03), "x", color=RED, ms=4,
                transform=ax.get_xaxis_transform(), label="runs without")  # fmt: skip
        ax.legend(fontsize=7, frameon=False)
    ax.set_xlabel(_label(found, j), fontsize=8)
    ax.set_ylabel(f"{found['quantity'][q]} ({pretty(found['quantity_units'][q])})", fontsize=8)


def _map(ax: Any, found: Any, q: int, seen: Seen, free: Any) -> None:
    """The quantity over both parameters; hatched where it does not happen."""
    i, j = map(int, free)
    unit, values = seen.unit, seen.numbers[:, q]
    line = np.linspace(-1, 1, _GRID)
    points = np.zeros((_GRID**2, unit.shape[1]))
    points[:, i], points[:, j] = (grid.ravel() for grid in np.meshgrid(line, line))
    field = seen.surrogate(found, q).evaluate(points).reshape(_GRID, _GRID)
    x, y = _values(found, i, line), _values(found, j, line)
    if np.isfinite(field).any() and np.nanmax(field) > np.nanmin(field):
        drawn = ax.contourf(x, y, field, 12, cmap="cividis")
        bar = ax.figure.colorbar(drawn, ax=ax)
        bar.set_label(f"{found['quantity'][q]} ({pretty(found['quantity_units'][q])})", fontsize=8)
        bar.ax.tick_params(labelsize=7)
    if (missing := ~np.isfinite(field)).any():
        ax.contourf(x, y, missing, [0.5, 1.5], colors=["0.9"], hatches=["///"])
    there = np.isfinite(values)
    for kind, mark, colour in ((there, "o", "white"), (~there, "x", RED)):
        places = [_values(found, c, unit[kind, c]) for c in (i, j)]
        ax.plot(*places, mark, color=colour, mec="black" if mark == "o" else colour, ms=3.5,
                clip_on=False)  # fmt: skip
    for which, mark in (("argmin", "v"), ("argmax", "^")):
        place = found[which][q]
        ax.plot(place[i], place[j], mark, color="white", mec="black", ms=7, clip_on=False)
    for line in ax.lines:  # on the border: their size would collapse the layout of many maps
        line.set_in_layout(False)
    ax.set_xlabel(_label(found, i), fontsize=8)
    ax.set_ylabel(_label(found, j), fontsize=8)


def _bars(ax: Any, found: Any, q: int, seen: Seen, free: Any) -> None:
    """Width when one parameter varies alone; grey where that is not above the error."""
    names = [found["parameter"][j] for j in free]
    alone, share = found["alone"][q][free], found["share"][q][free]
    alone = np.where(np.isfinite(alone), alone, 0.0)
    ax.barh(names, alone, color=[BLUE if s > 0 else _GREY for s in share], height=0.6)
    for row, s in enumerate(share):
        text = f" {100 * s:.0f} %" if s > 0 else " not told apart from the error"
        ax.text(alone[row], row, text, va="center", fontsize=7)
    ax.set_xlim(0, 1.45 * alone.max() or 1.0)
    ax.invert_yaxis()
    ax.set_xlabel(f"width alone ({pretty(found['quantity_units'][q])})", fontsize=8)
