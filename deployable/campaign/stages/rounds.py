"""Runs in rounds towards an accuracy."""

import shutil
from typing import Any

from deployable.campaign.files import check_results, results_of
from deployable.campaign.folder import Folder
from deployable.campaign.plan.accuracy import extend_plan, start_plan
from deployable.campaign.plan.plan import read_plan, write_plan
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.results.run_samples import open_samples
from deployable.campaign.runs.progress import Notify
from deployable.campaign.stages import BOUNDS_FILES, PLAN, simulate
from deployable.campaign.stages.bounds import bound
from deployable.campaign.stages.plan import warn


def work(
    folder: Folder, notify: Notify, experiment: Any, bounds: Any, verify: Any, jobs: Any,
    threads: int = 1,
) -> None:  # fmt: skip
    """Do the work of the stage `rounds`: simulate in rounds until an accuracy is met or its budget
    is spent, and leave plan, samples and bounds of the last round in `folder`."""
    number = 0
    while not _plan_round(place := folder.round(number), notify, experiment):
        with results_of(check_results(place, (PLAN,))):
            simulate.work(place, notify, jobs, threads=threads)
            bound(place, notify, bounds, verify, jobs, threads)
        number += 1
    previous: Any = place.previous()
    last = [place.plan, *(previous / name for name in BOUNDS_FILES)]
    for path in last:
        shutil.copy(path, folder.path)


def _plan_round(folder: Folder, notify: Notify, experiment: Any) -> bool:
    """Choose the runs of the next round towards an accuracy; whether there is to be none."""
    if previous := folder.previous():
        with open_samples(previous) as samples:
            bounds = read_bounds(previous, of_design=True)
            plan = extend_plan(experiment, read_plan(previous.plan), samples, bounds)
        notify(f"{experiment.name}: {plan.adaptive.rounds[-1].reason}")
    else:
        warn(notify, experiment)
        plan = start_plan(experiment)
    write_plan(plan, folder.plan)
    if not plan.is_finished:
        notify(f"{experiment.name}: {len(plan.unique_runs)} runs")
    return plan.is_finished
