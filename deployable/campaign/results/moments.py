"""The figure `moments`: the structure at some moments of the nominal run."""

from __future__ import annotations

import json
from typing import Any

from deployable.campaign.config.sections import Experiment, from_data
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.plan.runs import ROLES
from deployable.campaign.results.figures import save
from deployable.campaign.results.linkage import draw, has_bars
from deployable.campaign.results.which import ids, nominal_row
from deployable.campaign.runs.batch import make_again
from deployable.campaign.runs.progress import Tell
from deployable.campaign.runs.store import open_store
from deployable.fpm.sealed import DamagedError


def draw_nominal(folder: Folder, keep: str, count: int, tell: Tell) -> None:
    """Draw `count` moments of the nominal run of a sampled campaign as `moments` into its folder of
    overviews.

    keep: what is kept of runs. Raises `CampaignError` where the run cannot be made again.
    """
    with open_netcdf(folder.samples) as samples:
        experiment = from_data(Experiment, json.loads(samples.config))
        row, mechanics = nominal_row(samples) or 0, samples.mechanics
        (name,) = ids(samples, [row])
    if has_bars(experiment, keep):
        save(_linkage(folder, count, tell), folder.overviews / "moments", bbox_inches="tight")
        return
    if experiment.scene_type.digest != mechanics:
        raise CampaignError(
            f"the structure or the mechanics have changed since {folder.path} was made, so that "
            "it cannot be drawn; run the campaign first"
        )
    from deployable.campaign.pictures.moments import draw_moments

    try:
        with open_netcdf(folder.motions / f"{name}.nc") as motion:
            figure = draw_moments(motion, count)
    except (FileNotFoundError, DamagedError):
        from deployable.campaign.report.motions import motion_of

        figure = draw_moments(motion_of(folder.path, row), count)
    save(figure, folder.overviews / "moments")


def _linkage(folder: Folder, count: int, tell: Tell) -> Any:
    """The figure of a linkage whose bars are known, from the trajectory of its nominal run."""
    made, kept = read_plan(folder.plan), folder.runs("trajectories")
    nominal = made.runs[made.runs.role == ROLES.index("nominal")]
    make_again(made, open_store("trajectories", kept, made.experiment), nominal, 1, tell)
    with open_netcdf(folder.samples) as samples:
        run = samples["run_id"][nominal_row(samples)]
    return draw(kept / f"{run}.nc", count)
