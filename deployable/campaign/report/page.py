"""The page: one HTML file with style, script and data in it, which asks no network for anything."""

from __future__ import annotations

from pathlib import Path

from deployable.campaign.files import write_result
from deployable.campaign.report import words
from deployable.campaign.report.data import PageData
from deployable.campaign.report.failing import panels
from deployable.campaign.report.pack import compressed, packed
from deployable.campaign.report.still import still
from deployable.campaign.report.trust import trust
from deployable.campaign.results import answers, decisions
from deployable.campaign.results.budget import parts_text
from deployable.campaign.results.summary import kind_text
from deployable.campaign.results.units import pretty
from deployable.campaign.results.words import percent

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
    import jinja2

    units = {pretty(each.units) for each in (*data.responses, *data.parameters)} - {"1"}
    loader = jinja2.FileSystemLoader(_FOLDER)
    environment = jinja2.Environment(
        loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda v: words.unbroken(v, units) if type(v) is str else v,  # not what is `safe`
    )  # fmt: skip
    environment.filters.update(
        number=words.number,
        quantity=words.quantity,
        percent=percent,
        pretty=pretty,
        parts=parts_text,
        coded=lambda text: words.coded(text, units),
    )
    return environment.get_template("page.html").render(
        data=data,
        answers=data.answers,
        told=answers,
        units={parameter.name: parameter.units for parameter in data.parameters},
        decided=decisions,
        happens={row["name"]: row["happens"] for row in data.answers.get("quantities", ())},
        headline=words.headline(data),
        facts=words.facts(data),
        kind=kind_text(data.bounds_kind),
        meaning=words.kind_meaning(data.bounds_kind),
        cautions=words.of_all(data),
        beside=lambda response: words.beside(data, response),
        verdicts=[words.verdict(data, response) for response in data.responses],
        spread=words.spread,
        panels=panels(data),
        trust=trust(data),
        style=_text("style.css"),
        script="\n".join(_text(f"js/{name}.js") for name in SCRIPTS),
        still=still(data.moving[0].motion) if data.moving else "",
        library=compressed(_text("vendor/three.min.js").encode()),
        payload=packed(data),
    )


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
