"""Summary of a campaign: `summary.json` for programs and `summary.md` for people."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results import review as sheet
from deployable.campaign.results.display import shown_facts
from deployable.campaign.results.facts import facts_of
from deployable.campaign.results.mechanism import mechanism_of
from deployable.campaign.results.templates import summary_text


def summarise(
    folder: Folder, published: Mapping[str, float], answers: Iterable[str] = (),
    review: str | None = None, **sections: Any,
) -> str:  # fmt: skip
    """Write `summary.json` and `summary.md` into a campaign's folder, and return the latter's text.
    published, answers: as in `facts_of`; review: standard of the review sheet, None: not written;
    sections: further ones of the config that decide the results."""
    facts, experiment = facts_of(folder, published, answers), read_plan(folder.plan).experiment
    if review:
        facts["mechanism"] = mechanism_of(folder, facts["quantities"])
        rows = sheet.rows_of(facts, experiment, review)
        facts["review"] = {
            "title": sheet.edition_of(review),
            "head": sheet.head_of(facts, rows, review),
            "heads": sheet.HEADS,
            "rows": rows,
            "budgets": sheet.budgets_of(facts),
        }
        write_result(folder / "review.csv", sheet.as_csv(rows, review))
        write_result(folder / "review.md", summary_text(facts, "review.md.jinja"))
    facts["config"] = {"published": published, "review": review, **sections}
    text = summary_text(shown_facts(facts, experiment))
    write_result(folder / "summary.json", json.dumps(facts, indent=2, default=asdict) + "\n")
    write_result(folder / "summary.md", text)
    return text
