"""The runs of a campaign, and their time step."""

from __future__ import annotations

from typing import Any

from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan, write_plan
from deployable.campaign.runs.progress import Tell


def work(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Choose the runs of a campaign and the time step that serves them all."""
    warn(tell, experiment)
    plan = make_plan(experiment)
    write_plan(plan, folder.plan)
    step, limit = plan.time.step, plan.time.step_limit
    tell(
        f"{experiment.name}: {len(plan.unique_runs())} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {plan.time.limiting_element})"
    )


def warn(tell: Tell, experiment: Any) -> None:
    """Tell what seems wrong with a campaign."""
    for text in experiment.warnings:
        tell(f"{experiment.name}: warning: {text}")
