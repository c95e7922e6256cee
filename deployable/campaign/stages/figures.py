"""Figures of bounds and of contributions."""

from deployable.campaign.files import check_results
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.display import shown_bounds, shown_quantities
from deployable.campaign.results.figures import envelope, save, shares
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.results.ranges import ranges
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.runs.progress import Notify, report_seconds
from deployable.campaign.stages import ANSWERS, PLAN, SAMPLES, drawings


def work(folder: Folder, notify: Notify) -> None:
    """Do the work of the stage `figures`: draw each response with its bounds, all of them in
    panels, the influence of each parameter, and the range of each quantity."""
    experiment = read_plan(folder.plan).experiment
    names = drawings(experiment)
    if "ranges" in names:
        check_results(folder, (PLAN, SAMPLES, *ANSWERS))
        _ = experiment.quantity_list  # refused before anything is drawn, if the structure is
    with report_seconds(f"{experiment.name}: drawing figures", notify):
        bounds = shown_bounds(read_bounds(folder), experiment.display)
        for response in bounds.responses:
            save(envelope([response]), folder.figures / response.name)
        if "responses" in names:
            figure = envelope(bounds.responses)
            save(figure, folder.overviews / "responses")
        if "sensitivities" in names:
            save(shares(bounds), folder.overviews / "sensitivities")
        if "ranges" in names:
            runs, results = FittedRuns.read(folder), QuantityResults.read(folder)
            fits = runs.surrogates(experiment)
            figure = ranges(shown_quantities(results, experiment), runs, fits)
            save(figure, folder.overviews / "ranges")
