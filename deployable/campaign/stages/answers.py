"""What a campaign asks for."""

from contextlib import AbstractContextManager
from typing import Any

from deployable.campaign.answers import choice, quantities
from deployable.campaign.answers import measured as tests
from deployable.campaign.answers import requirements as limits
from deployable.campaign.answers.evaluations import FurtherRuns
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.bounds import include_runs
from deployable.campaign.results.summary import summarise
from deployable.campaign.runs.progress import Notify, report_seconds


def work(
    folder: Folder, notify: Notify, requirements: Any, choose: Any, published: Any, review: Any,
    verify: Any, jobs: Any, measured: Any, threads: int = 1,
) -> None:  # fmt: skip
    """Do the work of the stage `answers`: bound quantities, assess requirements, find the best
    choice, with the runs that this takes, and write the results, the bounds of responses with these
    runs, and the summary. Arguments are sections of the config, and `threads` that simulate."""
    experiment = read_plan(folder.plan).experiment

    def step(text: str) -> AbstractContextManager[None]:
        return report_seconds(f"{experiment.name}: {text}", notify)

    answers, further_runs = [], FurtherRuns(experiment)
    if experiment.quantities:
        with step("searching the bounds of quantities"):
            quantities.answer(folder, requirements, verify, jobs, notify, threads, further_runs)
    if requirements:
        answers.append("requirements")
        with step("finding what meets the requirements"):
            limits.answer(folder, requirements, jobs, notify)
    if choose.parameters:
        answers.append("choice")
        with step("choosing"):
            choice.answer(folder, choose, requirements, verify, jobs, notify, threads, further_runs)
    if measured:
        answers.append("measured")
        with step("finding what explains the measured curves"):
            tests.answer(
                folder, measured, requirements, verify, jobs, notify, threads, further_runs
            )
    with step("writing the answers"):
        include_runs(folder, further_runs)
        sections = {"choose": choose, "verify": verify, "measured": measured}
        summarise(folder, published, answers, review, **sections)
    notify(f"answers: {folder / 'summary.md'}")
