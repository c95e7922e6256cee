"""The page that compares the cases of a campaign."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from deployable.campaign.results.templates import environment
from deployable.campaign.text.numbers import pretty


def render_cases(facts: Mapping[str, Any]) -> str:
    """The page of all cases, with links to the pages of each; facts: as of `cases_facts`."""
    units = {pretty(row["units"]) for row in facts["quantities"]} - {"1"}
    style = (Path(__file__).parent / "style.css").read_text(encoding="utf-8")
    return environment(units, html=True).get_template("cases.html").render(facts=facts, style=style)
