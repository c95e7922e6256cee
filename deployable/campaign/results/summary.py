"""What is said of a campaign: `summary.json` for programs and `summary.md` for people."""

from __future__ import annotations

import json
from collections.abc import Mapping

from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.results.facts import facts_of
from deployable.campaign.text.templates import summary_text


def summarise(
    folder: Folder, published: Mapping[str, float], requirements: bool = False, choice: bool = False
) -> str:
    """Write both and return the text; `published` are largest differences by response.

    requirements, choice: whether the campaign has them.
    """
    facts = facts_of(folder, published, requirements, choice)
    text = summary_text(facts)
    write_result(folder / "summary.json", json.dumps(facts, indent=2) + "\n")
    write_result(folder / "summary.md", text)
    return text
