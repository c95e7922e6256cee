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
from deployable.campaign.stages import bounds as bounds_stage
from deployable.campaign.stages.plan import warn


def work(
    folder: Folder, notify: Notify, experiment: Any, bounds: Any, verify: Any, jobs: Any,
    threads: int = 1,
) -> None:  # fmt: skip
    """Do the work of the stage `rounds`: simulate in rounds until an accuracy is met or its budget
    is spent, and leave plan, samples and bounds of the last round in `folder`."""
    warn(notify, experiment)
    place, plan = folder.round(number := 0), start_plan(experiment)
    while True:
        write_plan(plan, place.plan)
        if plan.adaptive.met is not None:  # nothing follows
            break
        notify(f"{experiment.name}: {len(plan.unique_runs)} runs")
        with results_of(check_results(place, (PLAN,))):
            simulate.work(place, notify, jobs, threads=threads)
            bounds_stage.work(place, notify, bounds, verify, jobs, threads)
        with open_samples(place) as samples:
            results = read_bounds(place, of_design=True)
            plan = extend_plan(experiment, read_plan(place.plan), samples, results)
        notify(f"{experiment.name}: {plan.adaptive.rounds[-1].reason}")
        previous, place = place, folder.round(number := number + 1)
    for path in (place.plan, *(previous / name for name in BOUNDS_FILES)):
        shutil.copy(path, folder.path)
