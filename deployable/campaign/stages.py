"""The stages of a campaign: each takes files of its folder, and sections of the config, to others.

`campaign.run` calls them one after another, `python -m deployable STAGE` one alone, for the rules
of the workflow.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from inspect import signature
from typing import Any, get_type_hints

from deployable.campaign.answers import choice as best
from deployable.campaign.answers import quantities as intervals
from deployable.campaign.answers import requirements as limits
from deployable.campaign.answers.finer import check_bounds, finer_parts
from deployable.campaign.config.sections import (
    Campaign,
    Experiment,
    as_json,
    digest,
    from_data,
    trust,
)
from deployable.campaign.errors import CampaignError, of_files
from deployable.campaign.files import OPENED, check_results, read_json, refuse_links, results_of
from deployable.campaign.folder import ROUND_FILES, Folder
from deployable.campaign.plan.accuracy import first_plan, next_plan
from deployable.campaign.plan.estimate import runs_in_job
from deployable.campaign.plan.plan import make_plan, read_plan, write_plan
from deployable.campaign.provenance import program_digest
from deployable.campaign.report import from_results, make_motions, write_page
from deployable.campaign.results.bounds import analyse
from deployable.campaign.results.figures import draw_envelopes, draw_nominal, draw_sensitivities
from deployable.campaign.results.kept_extremes import gather as gather_extremes
from deployable.campaign.results.ranges import draw_ranges
from deployable.campaign.results.samples import gather
from deployable.campaign.results.summary import summarise
from deployable.campaign.runs.batch import run_batch
from deployable.campaign.runs.progress import Tell
from deployable.campaign.runs.store import pack, unpack
from fpm.errors import SceneError
from fpm.files.sealed import DamagedError, check, sweep


def plan(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Choose the runs of a campaign and the time step that serves them all."""
    _warn(tell, experiment)
    made = make_plan(experiment)
    write_plan(made, folder.plan)
    step, limit = made.time.step, made.time.step_limit
    tell(
        f"{experiment.name}: {len(made.unique_runs())} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {made.time.limiting_element})"
    )


def _warn(tell: Tell, experiment: Any) -> None:
    for text in experiment.warnings:
        tell(f"{experiment.name}: warning: {text}")


def rounds(
    folder: Folder, tell: Tell, experiment: Any, bounds: Any, verify: Any, jobs: Any,
    threads: int = 1,
) -> None:  # fmt: skip
    """Make runs in rounds until an accuracy is met or its budget is spent; the last round's results
    are the campaign's."""
    number = 0
    while not _plan_round(place := folder.round(number), tell, experiment):
        with results_of(_plan_of(place, (_PLAN,))):
            simulate(place, tell, jobs, threads=threads)
            _bounds(place, tell, bounds, verify, jobs, threads)
        number += 1
    last = [place.plan, *(place.previous() / name for name in ROUND_FILES[1:])]
    for path in last:
        shutil.copy(path, folder.path)


def _plan_round(folder: Folder, tell: Tell, experiment: Any) -> bool:
    """Choose the runs of the next round towards an accuracy; whether there is to be none."""
    if before := folder.previous():
        made = next_plan(experiment, read_plan(before.plan), before.samples, before.bounds)
        tell(f"{experiment.name}: {made.adaptive.rounds[-1].reason}")
    else:
        _warn(tell, experiment)
        made = first_plan(experiment)
    write_plan(made, folder.plan)
    if not made.is_finished:
        tell(f"{experiment.name}: {len(made.unique_runs())} runs")
    return made.is_finished


def simulate(
    folder: Folder, tell: Tell, jobs: Any, batch: int = 0, batches: int = 1, threads: int = 1,
    processes: int = 1, bundle: Any = None,
) -> None:  # fmt: skip
    """Simulate one batch of the planned runs, except those that are there already."""
    made = read_plan(folder.plan)
    store, manifest = folder.runs(jobs.keep), folder.batch(batch)
    run_batch(made, batch, batches, jobs, store, manifest, tell, threads, processes)
    if bundle:
        pack(store, bundle)


def bounds(
    folder: Folder, tell: Tell, bounds: Any, verify: Any, jobs: Any, threads: int = 1,
    bundles: Any = (),
) -> None:  # fmt: skip
    """Gather the responses of all runs, fit the surrogate, take its bounds, and find which
    parameter matters; what mesh and step add to the error, where that is to be known."""
    unpack(bundles, folder.runs(jobs.keep))
    _bounds(folder, tell, bounds, verify, jobs, threads)


def _bounds(folder: Folder, tell: Tell, bounds: Any, verify: Any, jobs: Any, threads: int) -> None:

    made = read_plan(folder.plan)
    collect = gather_extremes if jobs.keep == "extremes" else gather
    collect(made, jobs, folder.runs(jobs.keep), folder.samples, tell)
    parts = finer_parts(made, verify)

    def more(found: Any) -> Any:
        return check_bounds(folder, found, jobs, tell, threads, parts) if parts else found

    analyse(folder, bounds, more)


def answers(
    folder: Folder, tell: Tell, requirements: Any, choose: Any, published: Any, review: Any,
    verify: Any, jobs: Any, threads: int = 1,
) -> None:  # fmt: skip
    """Find the intervals of the quantities, what of the box meets the requirements, and the best
    choice, with the runs that decide them; sum everything up."""
    if read_plan(folder.plan).experiment.quantities:
        intervals.answer(folder, requirements, verify, jobs, tell, threads)
    if requirements:
        limits.answer(folder, requirements, jobs, tell)
    if choose.parameters:
        best.answer(folder, choose, requirements, verify, jobs, tell, threads)
    tell(summarise(folder, published, bool(requirements), bool(choose.parameters), review))


def figures(folder: Folder, tell: Tell, error: Any) -> None:
    """Draw each response with its bounds, what each parameter contributes, and each quantity over
    the box."""
    experiment = read_plan(folder.plan).experiment
    wanted = drawings(experiment)
    if "ranges" in wanted:
        check_results(folder, (_PLAN, _SAMPLES, *_ANSWERS))
        _ = experiment.numbers  # refused before anything is drawn, if the structure is
    draw_envelopes(folder.bounds, error.shade_above, folder.figures)
    if "sensitivities" in wanted:
        draw_sensitivities(folder.sensitivities, folder.overviews)
    if "ranges" in wanted:
        draw_ranges(folder, folder.overviews)


def page(folder: Folder, tell: Tell, figures: Any, frames: int = 401) -> None:
    """Make the page that shows and tells everything, with the motion of some runs, and draw some
    moments of the nominal one."""
    if frames < 2:
        raise CampaignError(f"--frames {frames}: allowed: 2 and more")
    if read_json(folder / "summary.json")["quantities"]:
        check_results(folder, (_SAMPLES, *_ANSWERS))
    check_results(folder, (_SAMPLES, "surrogate.nc"))
    if not make_motions(folder.path, frames):
        tell("no run is made again: the structure or the mechanics have changed since")
    write_page(from_results(folder.path), folder.report)
    draw_nominal(folder, figures.moments)
    tell(f"Open {folder.report}")


@dataclass(frozen=True)
class Stage:
    """A stage: its function, the sections of the config that it takes, and the results it reads."""

    work: Callable[..., None]
    sections: tuple[str, ...]
    takes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the stage and of its rule."""
        return self.work.__name__

    @property
    def has_threads(self) -> bool:
        """Whether it makes runs that threads can share."""
        return "threads" in signature(self.work).parameters

    def run(self, folder: Folder, tell: Tell, **arguments: Any) -> None:
        """Do the work on a folder; its arguments are the sections, and those of the batch.

        Raises `CampaignError` for trouble with files, among them those that do not belong together.
        """
        sections = {name: arguments[name] for name in self.sections}
        try:
            refuse_links(folder.whole)
            for place in folder.written:
                sweep(place)
            facts = {"basis": self.basis(sections), **_plan_of(folder, self.takes)}
            with results_of(facts):
                self.work(folder, tell, **arguments)
        except SceneError as error:  # of the structure that the results name
            place = OPENED[-1] if OPENED else folder.path
            raise CampaignError(f"{place}: {error}; run the campaign again") from error
        except (OSError, RuntimeError) as error:
            told = of_files(error, folder.path)
            if told is None:
                raise
            raise told from error

    def basis(self, sections: Mapping[str, Any]) -> str:
        """Digest of what the stage's results depend on beside the files that it takes."""
        mechanics = [s.mechanics for s in sections.values() if isinstance(s, Experiment)]
        return digest([program_digest(), json.loads(as_json(**sections)), mechanics])

    def typed(self, data: dict) -> dict[str, Any]:
        """The stage's sections from plain data of a user's config, and the `structure` that it
        names."""
        trust(data.get("structure") or "")
        kinds = get_type_hints(Campaign)
        return {name: from_data(kinds[name], data[name]) for name in self.sections}

    def sections_of(self, campaign: Campaign) -> dict[str, Any]:
        """The stage's sections of a campaign."""
        return {name: getattr(campaign, name) for name in self.sections}


_PLAN, _SAMPLES, _BOX = "plan.json", "samples.nc", "bounds.nc"
_ANSWERS = "quantities.nc", "further.nc"


def _plan_of(folder: Folder, names: Sequence[str]) -> dict[str, str]:
    """The plan that all these files are of, as a fact for results that are made from them."""
    check_results(folder, names)
    found = {name: check(folder / name, name).get("plan") for name in names}
    for name, plan in found.items():
        if plan != (first := next(iter(found.values()))):
            raise DamagedError(
                folder / name, f"it is of plan {plan}, {next(iter(found))} of {first}"
            )
    return {"plan": next(iter(found.values()))} if found else {}


STAGES = {
    stage.name: stage
    for stage in (
        Stage(plan, ("experiment",)),
        Stage(rounds, ("experiment", "bounds", "verify", "jobs")),
        Stage(simulate, ("jobs",), (_PLAN,)),
        Stage(bounds, ("bounds", "verify", "jobs"), (_PLAN,)),
        Stage(
            answers,
            ("requirements", "choose", "published", "review", "verify", "jobs"),
            (_PLAN, _SAMPLES, _BOX),
        ),
        Stage(figures, ("error",), (_PLAN, _BOX, "sensitivities.nc")),
        Stage(page, ("figures",), (_SAMPLES, _BOX, "sensitivities.nc", "summary.json")),
    )
}


CORES = "DEPLOYABLE_INTERVALS_CORES"
"""Environment variable with the cores of the machine on which a workflow was started: jobs on other
machines must find as many batches."""


def batch_count(campaign: Campaign, runs: int) -> int:
    """Number of batches that runs are shared among."""
    if campaign.jobs.minutes:
        return -(-runs // runs_in_job(campaign))
    if campaign.jobs.nodes_per_job != "auto":
        return -(-runs // campaign.jobs.nodes_per_job)
    cores = int(os.environ.get(CORES, 0)) or os.cpu_count() or 1
    count = min(-(-runs // 512), max(8, cores, min(-(-runs // 4096), 64)))
    # As many for each core, so that none waits for the last job of another.
    return count - count % cores if count > cores else count


def drawings(experiment: Experiment) -> list[str]:
    """Names of the figures of the whole campaign that `figures` draws."""
    several = len(experiment.intervals) > 1 and experiment.design.order is not None
    return ["sensitivities"] * several + ["ranges"] * bool(experiment.quantities)
