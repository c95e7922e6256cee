"""The page: one HTML file with style, script and data in it, which asks no network for anything."""

from __future__ import annotations

from pathlib import Path

from deployable.campaign.files import write_result
from deployable.campaign.report.data import PageData
from deployable.campaign.report.failing import panels
from deployable.campaign.report.pack import compressed, packed
from deployable.campaign.report.still import still
from deployable.campaign.text.numbers import pretty
from deployable.campaign.text.templates import environment

_FOLDER = Path(__file__).parent

SCRIPTS = (
    "data", "clock", "scene", "viewer", "stills", "axes", "chart", "charts", "tables", "main",
)  # fmt: skip
"""The page's script, in the order in which its files are put together."""


def write_page(data: PageData, path: str | Path) -> None:
    """Write the page of a campaign as one HTML file, whole or not at all."""
    write_result(path, render(data))


def render(data: PageData) -> str:
    """The page as text."""
    units = {pretty(each.units) for each in data.responses}
    units |= {pretty(parameter["units"]) for parameter in data.parameters}
    return (
        environment(units - {"1"}, html=True)
        .get_template("page.html")
        .render(
            data=data,
            facts=data.facts,
            shares={response.name: response.shares for response in data.responses},
            panels=panels(data),
            style=_text("style.css"),
            script="\n".join(_text(f"js/{name}.js") for name in SCRIPTS),
            still=still(data.moving[0].motion) if data.moving else "",
            library=compressed(_text("vendor/three.min.js").encode()),
            payload=packed(data),
        )
    )


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
