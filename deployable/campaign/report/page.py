"""The page: one HTML file with style, script and data in it, which asks no network for anything."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from deployable.campaign.files import write_result
from deployable.campaign.pictures import to_png
from deployable.campaign.pictures.drawing import draw_moments
from deployable.campaign.report.failing_region import panels, prices
from deployable.campaign.report.pack import compress, pack_data
from deployable.campaign.report.read import PageData
from deployable.campaign.results.templates import environment
from deployable.campaign.text.numbers import pretty

_FOLDER = Path(__file__).parent

SCRIPTS = (
    "data", "clock", "scene", "viewer", "stills", "axes", "chart", "charts", "what", "main",
)  # fmt: skip
"""The page's script, in the order in which its files are put together."""


def write_page(data: PageData, path: str | Path) -> None:
    """Write a campaign's page to `path` as one HTML file, which loads nothing from the network,
    whole or not at all. data: all that it shows (`report.read.from_results`)."""
    write_result(path, render(data))


def render(data: PageData) -> str:
    """Render the campaign's page as the text of one HTML file; data: `report.read.from_results`."""
    units = {pretty(response.units) for response in data.responses}
    units |= {pretty(parameter["units"]) for parameter in data.parameters}
    motion = next(iter(data.moving.values()), None)  # drawn for browsers that show none
    poster = "" if motion is None else b64encode(to_png(draw_moments(motion, 3))).decode()
    return (
        environment(units - {"1"}, html=True)
        .get_template("page.html")
        .render(
            data=data,
            facts=data.facts,
            panels=panels(data),
            prices=prices(data.facts),
            style=_text("style.css"),
            script="\n".join(_text(f"js/{name}.js") for name in SCRIPTS),
            poster=poster,
            library=compress(_text("vendor/three.min.js").encode()),
            payload=pack_data(data),
        )
    )


def render_cases(facts: Mapping[str, Any], figures: Iterable[Any] = ()) -> str:
    """The page of all cases, with links to the pages of each; facts: as of `cases_facts`; figures:
    of the curves that these have, if any."""
    units = {pretty(row["units"]) for row in facts["quantities"]} - {"1"}
    template = environment(units, html=True).get_template("cases.html")
    pictures = [b64encode(to_png(figure)).decode() for figure in figures]
    return template.render(facts=facts, style=_text("style.css"), pictures=pictures)


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
