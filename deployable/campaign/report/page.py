"""The page: one HTML file with style, script and data in it, which asks no network for anything."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.campaign.files import write_result
from deployable.campaign.pictures.moments import telling_moments
from deployable.campaign.pictures.paint import limits_of, visible_faces
from deployable.campaign.pictures.solid import solid_of_motion
from deployable.campaign.pictures.view import View
from deployable.campaign.report.data import PageData
from deployable.campaign.report.failing_region import lines, panels, prices
from deployable.campaign.report.pack import compress, pack_data
from deployable.campaign.results.templates import environment
from deployable.campaign.text.numbers import pretty

if TYPE_CHECKING:
    import xarray

_FOLDER = Path(__file__).parent

SCRIPTS = (
    "data", "clock", "scene", "viewer", "stills", "axes", "chart", "charts", "what", "tables",
    "main",
)  # fmt: skip
"""The page's script, in the order in which its files are put together."""

_MOMENTS = 3
_WIDE = 300  # units of the drawing, of each moment


def write_page(data: PageData, path: str | Path) -> None:
    """Write a campaign's page to `path` as one HTML file, which loads nothing from the network,
    whole or not at all. data: all that it shows (`report.read.from_results`)."""
    write_result(path, render(data))


def render(data: PageData) -> str:
    """Render the campaign's page as the text of one HTML file; data: `report.read.from_results`."""
    units = {pretty(response.units) for response in data.responses}
    units |= {pretty(parameter["units"]) for parameter in data.parameters}
    return (
        environment(units - {"1"}, html=True)
        .get_template("page.html")
        .render(
            data=data,
            facts=data.facts,
            shares={response.name: response.shares for response in data.responses},
            panels=panels(data),
            lines=lines(data),
            prices=prices(data.facts),
            style=_text("style.css"),
            script="\n".join(_text(f"js/{name}.js") for name in SCRIPTS),
            still=still_picture(data.moving[0].motion) if data.moving else "",
            library=compress(_text("vendor/three.min.js").encode()),
            payload=pack_data(data),
        )
    )


def render_cases(facts: Mapping[str, Any]) -> str:
    """The page of all cases, with links to the pages of each; facts: as of `cases_facts`."""
    units = {pretty(row["units"]) for row in facts["quantities"]} - {"1"}
    template = environment(units, html=True).get_template("cases.html")
    return template.render(facts=facts, style=_text("style.css"))


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")


def still_picture(motion: xarray.Dataset) -> str:
    """Draw three moments of a whole motion side by side as an SVG element, for browsers that show
    no motion: start, middle, and the first closure of a contact, or else the end."""
    frames, view = telling_moments(motion, _MOMENTS), View()
    solid = solid_of_motion(motion, frames)
    low, high = limits_of(solid.places, view, margin=0.03)
    zoom = _WIDE / max(high - low)
    parts = []
    for moment in range(_MOMENTS):
        start = np.array([_WIDE * (moment + 0.5) - zoom * (low[0] + high[0]) / 2, zoom * high[1]])
        faces, colours = visible_faces(solid, moment, view)
        lines = (solid.cable_points[moment] @ view.page.T)[solid.cables.stretches]
        for corners, colour in zip(faces, np.rint(255 * colours).astype(int), strict=True):
            fill = bytes(colour.tolist()).hex()
            parts.append(f'<path fill="#{fill}" d="{_path(corners, start, zoom)}Z"/>')
        parts += [f'<path class="cable" d="{_path(line, start, zoom)}"/>' for line in lines]
    tall = zoom * (high - low)[1]
    return f'<svg viewBox="0 0 {_MOMENTS * _WIDE} {tall:.0f}">{"".join(parts)}</svg>'


def _path(places: np.ndarray, start: np.ndarray, zoom: float) -> str:
    """Places (p, 2), m upwards, as a path downwards."""
    points = start + zoom * places * [1, -1]
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
