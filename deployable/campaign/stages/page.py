"""The page of a campaign."""

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import check_results, open_netcdf, read_json
from deployable.campaign.folder import Folder
from deployable.campaign.pictures.drawing import draw_moments
from deployable.campaign.report import from_results, make_motions, write_page
from deployable.campaign.results.figures import save
from deployable.campaign.runs.progress import Notify, report_seconds
from deployable.campaign.stages import ANSWERS, FRAMES, SAMPLES


def work(folder: Folder, notify: Notify, frames: int = FRAMES) -> None:
    """Do the work of the stage `page`: write the page (`report.html`) with moving pictures of some
    runs, of `frames` each, and draw some moments of the nominal run. Raises `CampaignError` for
    less than 2 frames, `DamagedError` for results that have changed since they were written."""
    if frames < 2:
        raise CampaignError(f"--frames {frames}: allowed: 2 and more")
    if read_json(folder / "summary.json")["quantities"]:
        check_results(folder, (SAMPLES, *ANSWERS))
    check_results(folder, (SAMPLES, "surrogate.nc"))
    name = folder.whole.name
    with report_seconds(f"{name}: making runs again that move on the page", notify):
        nominal, *_ = make_motions(folder.path, frames)
    with report_seconds(f"{name}: making the page", notify):
        write_page(from_results(folder.path), folder.report)
        with open_netcdf(nominal) as motion:
            save(draw_moments(motion), folder.overviews / "moments")
