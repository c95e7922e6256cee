"""Figures for a journal: one column wide, with TrueType fonts, as PDF, SVG and PNG."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from deployable.campaign.files import whole_file
from deployable.campaign.folder import MOST_PANELS
from deployable.campaign.results.figures import DATELESS, envelope, save, shares
from deployable.campaign.results.response_bounds import read_bounds

if TYPE_CHECKING:
    from deployable.campaign.export.selection import SelectedRun

COLUMN, PAGE = 90 / 25.4, 190 / 25.4
"""Widths of a column and of two, inches: what most journals set."""

DPI = 600

SHADE_ABOVE = 0.1  # the config's default of `error.shade_above`, which results do not tell

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
    from deployable.campaign.pictures.moments import draw_moments

    yield f"{run.name}-moments", draw_moments(run.motion(frames), width=PAGE)
    if not run.folder:
        return
    bounds = read_bounds(run.folder)
    for response in bounds.responses:
        yield response.name, envelope([response], SHADE_ABOVE, width=COLUMN)
    if 1 < len(bounds.responses) <= MOST_PANELS:
        yield f"{run.name}-responses", envelope(bounds.responses, SHADE_ABOVE, width=COLUMN)
    if bounds.responses[0].widths is not None and len(bounds.parameters) > 1:
        yield f"{run.name}-sensitivities", shares(bounds, PAGE)
