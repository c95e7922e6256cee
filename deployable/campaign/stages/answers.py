"""What a campaign asks for, and its summary, for programs (`.json`) and for people (`.md`)."""

import json
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict
from typing import Any

from deployable.campaign.answers import choice, limits, quantities
from deployable.campaign.answers import measured as tests
from deployable.campaign.answers.evaluations import FurtherRuns, ModelEvaluator
from deployable.campaign.files import write_result
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results import review as sheet
from deployable.campaign.results.bounds import include_runs
from deployable.campaign.results.display import shown_facts
from deployable.campaign.results.facts import facts_of
from deployable.campaign.results.mechanism import mechanism_of
from deployable.campaign.results.templates import summary_text
from deployable.campaign.runs.progress import Notify, report_seconds


def work(
    folder: Folder, notify: Notify, requirements: Any, choose: Any, published: Any, review: Any,
    verify: Any, jobs: Any, measured: Any, threads: int = 1,
) -> None:  # fmt: skip
    """Do the work of the stage `answers`: bound quantities, assess requirements, find the best
    choice, with the runs that this takes, and write the results, the bounds of responses with these
    runs, and the summary. Arguments are sections of the config, and `threads` that simulate."""
    experiment = (plan := read_plan(folder.plan)).experiment
    further_runs = FurtherRuns(experiment)
    context = folder, jobs, notify, threads, further_runs

    def step(text: str) -> AbstractContextManager[None]:
        return report_seconds(f"{experiment.name}: {text}", notify)

    answers = []
    if experiment.quantities:
        with step("searching the bounds of quantities"):
            quantities.answer(ModelEvaluator.from_folder(*context), requirements, verify)
    if requirements:
        answers.append("requirements")
        with step("finding what meets the requirements"):
            limits.answer(ModelEvaluator.from_folder(*context, refinements=True), requirements)
    if choose.parameters:
        answers.append("choice")
        with step("choosing"):
            choice.answer(ModelEvaluator(plan, *context), choose, requirements, verify)
    if measured:
        answers.append("measured")
        with step("finding what explains the measured curves"):
            tests.answer(ModelEvaluator.from_folder(*context), measured, requirements, verify)
    with step("writing the answers"):
        include_runs(folder, further_runs)
        sections = {"choose": choose, "verify": verify, "measured": measured}
        summarise(folder, published, answers, review, **sections)
    notify(f"answers: {folder / 'summary.md'}")


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
            "budgets": [*sheet.budgets_of(facts)],
        }
        write_result(folder / "review.csv", sheet.as_csv(rows, review))
        write_result(folder / "review.md", summary_text(facts, "review.md.jinja"))
    facts["config"] = {"published": published, "review": review, **sections}
    text = summary_text(shown_facts(facts, experiment))
    write_result(folder / "summary.json", json.dumps(facts, indent=2, default=asdict) + "\n")
    write_result(folder / "summary.md", text)
    return text
