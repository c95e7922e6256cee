"""The runs of a campaign, and their time step."""

from typing import Any

from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan, write_plan
from deployable.campaign.runs.progress import Notify, report_seconds


def work(folder: Folder, notify: Notify, experiment: Any) -> None:
    """Do the work of the stage `plan`: choose a campaign's runs and their time step."""
    warn(notify, experiment)
    with report_seconds(f"{experiment.name}: choosing the runs and their time step", notify):
        plan = make_plan(experiment)
    write_plan(plan, folder.plan)
    step, limit = plan.time.step, plan.time.step_limit
    notify(
        f"{experiment.name}: {len(plan.unique_runs)} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {plan.time.limiting_element})"
    )


def warn(notify: Notify, experiment: Any) -> None:
    """Tell, by calls of `notify` with texts, what is likely wrong in an experiment's structure."""
    for text in experiment.warnings:
        notify(f"{experiment.name}: warning: {text}")
