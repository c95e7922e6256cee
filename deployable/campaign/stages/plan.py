"""The runs of a campaign, and their time step."""

from __future__ import annotations

from typing import Any

from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan, write_plan
from deployable.campaign.runs.progress import Tell


def work(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Do the work of the stage `plan`: choose the runs of a campaign and their common time step,
    and write `plan.json` into `folder`. tell: called with each message; experiment: all settings
    that decide the runs."""
    warn(tell, experiment)
    plan = make_plan(experiment)
    write_plan(plan, folder.plan)
    step, limit = plan.time.step, plan.time.step_limit
    tell(
        f"{experiment.name}: {len(plan.unique_runs())} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {plan.time.limiting_element})"
    )


def warn(tell: Tell, experiment: Any) -> None:
    """Tell, by calls of `tell` with texts, what is likely wrong in an experiment's structure."""
    for text in experiment.warnings:
        tell(f"{experiment.name}: warning: {text}")
