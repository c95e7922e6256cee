"""Tables as CSV: curves of a run; bounds, runs, quantities of a campaign. Headings have units.

Figures for a journal: one column wide, with TrueType fonts, as PDF, SVG and PNG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.campaign.files import csv_text, whole_file, write_text
from deployable.campaign.folder import MOST_PANELS, Folder
from deployable.campaign.pictures.drawing import draw_moments
from deployable.campaign.results.display import shown_bounds, shown_quantities, shown_table
from deployable.campaign.results.figures import DATELESS, envelope, save, shares
from deployable.campaign.results.quantity_results import QuantityResults
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.results.run_samples import open_samples

if TYPE_CHECKING:
    from deployable.campaign.export.selection import SelectedRun

_INTERVAL = ("lower", "nominal", "upper", "error", "happens")
_BOUNDS = ("lower", "upper", "nominal", "error")


def write_tables(run: SelectedRun, folder: Path, frames: int) -> list[Path]:
    """Simulate a run, and write its curves as `<run.name>.csv` into `folder`, for a run of results
    also `bounds.csv`, `runs.csv` and `quantities.csv`; returns the paths."""
    tables = {f"{run.name}.csv": _columns(tabulate_curves(run.outcome(), run.responses))}
    if run.folder:
        bounds = read_bounds(run.folder)
        columns = {"time (s)": bounds.time}
        for row in bounds.responses:
            curves = {f"{row.name}_{key} ({row.units})": getattr(row, key) for key in _BOUNDS}
            columns |= {name: curve for name, curve in curves.items() if curve is not None}
        tables["bounds.csv"] = _columns(columns)
        tables["runs.csv"] = tabulate_runs(run.folder)
        if run.folder.quantities.exists():
            tables["quantities.csv"] = tabulate_quantities(run.folder)
    for name, rows in tables.items():
        write_text(folder / name, csv_text(shown_table(rows, run.display)))
    return [folder / name for name in tables]


def tabulate_curves(outcome: Any, responses: Sequence[Any] = ()) -> dict[str, np.ndarray]:
    """Collect the curves of a run (`fpm.Outcome`) as columns (T) by heading with unit: time,
    responses, positions and velocities of named points, openings of joints, energies."""
    columns = {"time (s)": outcome.time}
    columns |= {f"{r.name} ({r.unit})": r.evaluate(outcome) for r in responses}
    for name, tracks in outcome.points.items():
        for prefix, unit, track in zip(("", "velocity "), ("m", "m s-1"), tracks, strict=True):
            for axis, values in zip("xyz", track.T, strict=True):
                columns[f"{prefix}{axis} of {name} ({unit})"] = values
    units = {hinge.name: "m" if hinge.slides else "rad" for hinge in outcome.scene.hinges}
    columns |= {f"opening of {n} ({units[n]})": values for n, values in outcome.openings.items()}
    columns |= {f"{name} energy (J)": values for name, values in outcome.energies.items()}
    return columns


def tabulate_runs(folder: Folder) -> list[list]:
    """Make the table of a campaign's runs, headings first: id, role, parameters, quantities."""
    with open_samples(folder) as samples:
        experiment, table = samples.experiment, samples.table
        fields = samples.ids(), samples.roles, table.values.tolist(), table.numbers
    parameters = experiment.scene_type.parameters
    units = {name: parameters[name].unit for name in experiment.intervals}
    units |= {quantity.name: quantity.unit for quantity in experiment.quantity_list}
    rows = [["run", "role", *(f"{name} ({unit})" for name, unit in units.items())]]
    for name, role, place, numbers in zip(*fields, strict=True):
        cells = (value if np.isfinite(value) else "" for value in numbers.tolist())
        rows.append([name, role, *place, *cells])
    return rows


def tabulate_quantities(folder: Folder) -> list[list]:
    """Make the table of a campaign's quantities, headings first: name, units, interval, nominal
    value, error, fraction of the box in which it occurs, and the parameters at both ends."""
    with open_samples(folder) as samples:
        results = shown_quantities(QuantityResults.read(folder), samples.experiment)
    headings = [f"{p['name']} ({p['units']})" for p in results.parameters]
    ends = [f"{name} at the {side} end" for side in ("lower", "upper") for name in headings]
    rows = [["quantity", "units", *_INTERVAL, *ends]]
    for row in results.rows:
        places = [*row["argmin"].values(), *row["argmax"].values()]
        numbers = [*(row[key] for key in _INTERVAL), *places]
        cells = ("" if number is None else number for number in numbers)
        rows.append([row["name"], row["units"], *cells])
    return rows


def _columns(arrays: Mapping[str, np.ndarray]) -> list[list]:
    columns = [np.asarray(values).tolist() for values in arrays.values()]
    return [list(arrays), *map(list, zip(*columns, strict=True))]


COLUMN, PAGE = 90 / 25.4, 190 / 25.4
"""Widths of a column and of two, inches: what most journals set."""

DPI = 600

_STYLE: Any = {
    "font.size": 8, "axes.labelsize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6,
}  # fmt: skip


def write_figures(run: SelectedRun, folder: Path, frames: int) -> list[Path]:
    """Simulate a run and write figures of it as PDF, SVG and PNG into `folder`, at the width of a
    journal's columns; returns the paths of the PDF files. They show the structure at moments of its
    motion, chosen from `frames` of them, and for a run of a campaign's results each response with
    its bounds, several in panels too, and what each parameter contributes."""
    from matplotlib import rc_context

    paths = []
    with rc_context(_STYLE):
        for name, figure in _figures(run, frames):
            save(figure, folder / name, DATELESS, DPI, whole_file)
            paths.append(folder / f"{name}.pdf")
    return paths


def _figures(run: SelectedRun, frames: int) -> Iterator[tuple[str, Any]]:
    yield f"{run.name}-moments", draw_moments(run.motion(frames), width=PAGE)
    if not run.folder:
        return
    bounds = shown_bounds(read_bounds(run.folder), run.display)
    for response in bounds.responses:
        yield response.name, envelope([response], width=COLUMN)
    if 1 < len(bounds.responses) <= MOST_PANELS:
        yield f"{run.name}-responses", envelope(bounds.responses, width=COLUMN)
    if bounds.responses[0].widths is not None and len(bounds.parameters) > 1:
        yield f"{run.name}-sensitivities", shares(bounds, PAGE)
