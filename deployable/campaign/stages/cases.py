"""What the cases of a campaign answer together."""

import json
from typing import Any

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.report.page import render_cases
from deployable.campaign.results.cases import cases_facts
from deployable.campaign.results.templates import summary_text
from deployable.campaign.runs.progress import Notify


def work(folder: Folder, notify: Notify, cases: Any) -> None:
    """Compare the cases of a campaign, whose results are in folders below `folder`: writes
    `cases.json`, `summary.md` and the page. Raises `CampaignError` where there are none."""
    if not cases:
        raise CampaignError("cases: there are none in the config; allowed: a campaign with `cases`")
    facts = cases_facts(folder, cases)
    write_result(folder / "cases.json", json.dumps(facts, indent=2) + "\n")
    facts = cases_facts(folder, cases, is_shown=True)
    write_result(folder / "summary.md", summary_text(facts, "cases.md.jinja"))
    write_result(folder.report, render_cases(facts))
