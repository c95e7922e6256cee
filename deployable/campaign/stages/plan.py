"""The runs of a campaign, and their time step."""

from __future__ import annotations

from typing import Any

from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan, write_plan
from deployable.campaign.runs.progress import Tell


def work(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Choose the runs of a campaign and the time step of all of them, and write `plan.json`. tell:
    called with each message; experiment: of the config."""
    warn(tell, experiment)
    plan = make_plan(experiment)
    write_plan(plan, folder.plan)
    step, limit = plan.time.step, plan.time.step_limit
    tell(
        f"{experiment.name}: {len(plan.unique_runs())} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {plan.time.limiting_element})"
    )


def warn(tell: Tell, experiment: Any) -> None:
    """Report what seems wrong with the structure of an experiment, by calls of `tell` with
    texts."""
    for text in experiment.warnings:
        tell(f"{experiment.name}: warning: {text}")
