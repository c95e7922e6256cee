"""Samples, surrogate and bounds of the runs."""

from functools import partial
from typing import Any

from deployable.campaign.answers.discretization import check_bounds
from deployable.campaign.folder import Folder
from deployable.campaign.plan.decide import COMPONENTS
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.bounds import analyse
from deployable.campaign.runs.progress import Notify, report_seconds
from deployable.campaign.runs.store import unpack
from deployable.campaign.samples.samples import gather


def work(
    folder: Folder, notify: Notify, bounds: Any, verify: Any, jobs: Any, threads: int = 1,
    bundles: Any = (),
) -> None:  # fmt: skip
    """Do the work of the stage `bounds`: write `samples.nc`, `surrogate.nc`, `design_bounds.nc`,
    with errors by mesh and step if `verify` or the plan asks, and `sensitivities.nc`. bundles: tar
    files of runs to be extracted first. Raises `CampaignError` for others, and if runs fail."""
    unpack(bundles, folder.runs(jobs.keep))
    plan = read_plan(folder.plan)
    name = plan.experiment.name
    with report_seconds(f"{name}: gathering the runs", notify):
        gather(plan, jobs, folder.runs(jobs.keep), folder.samples, notify)
    components = COMPONENTS if verify.discretization else ()
    if plan.experiment.is_adaptive:
        components = plan.adaptive.check
    add_errors = partial(
        check_bounds, folder, jobs=jobs, notify=notify, threads=threads, components=components
    )
    with report_seconds(f"{name}: fitting the surrogate and searching its bounds", notify):
        analyse(folder, bounds, add_errors if components else None)
