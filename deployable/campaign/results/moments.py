"""The figure `moments`: the structure at some moments of the nominal run."""

from __future__ import annotations

from deployable.campaign.config.sections import Experiment
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder
from deployable.campaign.results.figures import save
from deployable.campaign.results.which import ids, nominal_row
from fpm.files.sealed import DamagedError


def draw_nominal(folder: Folder, count: int) -> None:
    """Draw `count` moments of the nominal run of a sampled campaign as `moments` into its folder of
    overviews. Raises `CampaignError` where the run cannot be made again.
    """
    with open_netcdf(folder.samples) as samples:
        experiment = Experiment.read(samples.config)
        row, mechanics = nominal_row(samples) or 0, samples.mechanics
        (name,) = ids(samples, [row])
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
