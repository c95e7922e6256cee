"""The stages of a campaign: each takes files of its folder, and sections of the config, to others.

`campaign.run` calls them one after another, `python -m deployable STAGE` one alone, for the rules
of the workflow. Imports stay inside, so that a stage loads what it needs and no more.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Any, get_type_hints

from deployable.campaign.config.sections import Campaign, Experiment, as_json, digest, from_data
from deployable.campaign.errors import CampaignError, of_files
from deployable.campaign.files import results_of
from deployable.campaign.folder import Folder
from deployable.campaign.runs.progress import Tell
from deployable.campaign.stopping import import_ahead
from fpm.sealed import DamagedError, check, sweep


def plan(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Choose the runs of a campaign and the time step that serves them all."""
    from deployable.campaign.plan.make import make_plan
    from deployable.campaign.plan.plan import write_plan

    made = make_plan(experiment)
    write_plan(made, folder.plan)
    step, limit = made.time.step, made.time.step_limit
    tell(
        f"{experiment.name}: {len(made.unique_runs())} runs, step {step:.4g} s "
        f"({step / limit:.0%} of the limit, set by {made.time.limiting_element})"
    )


def plan_round(folder: Folder, tell: Tell, experiment: Any) -> None:
    """Choose the runs of the next round towards an accuracy, or say why it ends."""
    from deployable.campaign.plan.accuracy import first_plan, next_plan
    from deployable.campaign.plan.plan import read_plan, write_plan

    if before := folder.previous():
        made = next_plan(experiment, read_plan(before.plan), before.samples, before.bounds)
        tell(f"{experiment.name}: {made.adaptive.rounds[-1].reason}")
    else:
        made = first_plan(experiment)
    write_plan(made, folder.plan)
    if not made.is_finished:
        tell(f"{experiment.name}: {len(made.unique_runs())} runs")


def simulate(
    folder: Folder,
    tell: Tell,
    jobs: Any,
    batch: int = 0,
    batches: int = 1,
    threads: int = 1,
    processes: int = 1,
    bundle: Any = None,
    ahead: Sequence[str] = (),
) -> None:
    """Simulate one batch of the planned runs, except those that are there already.

    ahead: modules that are imported meanwhile.
    """
    from deployable.campaign.plan.plan import read_plan
    from deployable.campaign.runs.batch import run_batch
    from deployable.campaign.runs.bundle import pack

    made = read_plan(folder.plan)
    store, manifest = folder.runs(jobs.keep), folder.batch(batch)
    run_batch(made, batch, batches, jobs, store, manifest, tell, threads, processes, ahead)
    if bundle:
        pack(store, bundle)


def gather(folder: Folder, tell: Tell, jobs: Any, bundles: Any = ()) -> None:
    """Gather the responses of all runs into samples.nc."""
    from deployable.campaign.plan.plan import read_plan
    from deployable.campaign.results.kept_extremes import gather as gather_extremes
    from deployable.campaign.results.samples import gather
    from deployable.campaign.runs.bundle import unpack

    unpack(bundles, folder.runs(jobs.keep))
    collect = gather_extremes if jobs.keep == "extremes" else gather
    collect(read_plan(folder.plan), jobs, folder.runs(jobs.keep), folder.samples, tell)


def bounds(
    folder: Folder, tell: Tell, bounds: Any, verify: Any, jobs: Any, threads: int = 1
) -> None:
    """Fit the surrogate to samples.nc, take its bounds, and tell which parameter matters.

    What mesh and step add to the error is told too, where that is asked for.
    """
    from deployable.campaign.answers.finer import check_bounds, finer_parts
    from deployable.campaign.plan.plan import read_plan
    from deployable.campaign.results.bounds import analyse

    parts = finer_parts(read_plan(folder.plan), verify)
    if not parts:
        analyse(folder, bounds)
        return

    def more(found: Any) -> Any:
        return check_bounds(folder, found, jobs, tell, threads, parts)

    analyse(folder, bounds, more)


def quantities(
    folder: Folder, tell: Tell, requirements: Any, verify: Any, jobs: Any, threads: int = 1
) -> None:
    """Find the intervals of the quantities, with further runs at their ends, and where
    requirements are decided."""
    from deployable.campaign.answers.quantities import answer

    answer(folder, requirements, verify, jobs, tell, threads)


def requirements(folder: Folder, tell: Tell, requirements: Any, jobs: Any) -> None:
    """Tell what of the box meets the requirements, and where they fail."""
    from deployable.campaign.answers.requirements import answer

    answer(folder, requirements, jobs, tell)


def choice(
    folder: Folder,
    tell: Tell,
    choose: Any,
    requirements: Any,
    verify: Any,
    jobs: Any,
    threads: int = 1,
) -> None:
    """Find the nominal values that are best in the worst case."""
    from deployable.campaign.answers.choice import answer

    answer(folder, choose, requirements, verify, jobs, tell, threads)


def envelopes(folder: Folder, tell: Tell, error: Any) -> None:
    """Draw each response with its bounds and the nominal run."""
    from deployable.campaign.results.figures import draw_envelopes

    draw_envelopes(folder.bounds, error.shade_above, folder.figures)


def ranges(folder: Folder, tell: Tell) -> None:
    """Draw each quantity over the box, or what each parameter contributes to it."""
    from deployable.campaign.results.ranges import draw_ranges

    draw_ranges(folder, folder.overviews)


def alternatives(folder: Folder, tell: Tell) -> None:
    """Draw the choices that were tried."""
    from deployable.campaign.results.alternatives import draw_alternatives

    draw_alternatives(folder, folder.overviews)


def sensitivities(folder: Folder, tell: Tell) -> None:
    """Draw which parameter widens the bounds, and when."""
    from deployable.campaign.results.figures import draw_sensitivities

    draw_sensitivities(folder.sensitivities, folder.overviews)


def moments(folder: Folder, tell: Tell, figures: Any) -> None:
    """Draw the structure at some moments of the nominal run."""
    from deployable.campaign.results.moments import draw_nominal

    draw_nominal(folder, figures.moments)


def summary(
    folder: Folder, tell: Tell, published: dict[str, float], requirements: Any, choose: Any
) -> None:
    """Write the headline numbers as JSON and as a table for people."""
    from deployable.campaign.results.summary import summarise

    tell(summarise(folder, published, bool(requirements), bool(choose.parameters)))


def report(
    folder: Folder, tell: Tell, frames: int = 401, moved: Callable[[], None] = lambda: None
) -> None:
    """Make the page that shows and tells everything, with the motion of some runs.

    moved: is called as soon as these motions are there.
    """
    from deployable.campaign.report import from_results, make_motions, write_page

    if frames < 2:
        raise CampaignError(f"--frames {frames}: allowed: 2 and more")
    # What turns frames into quaternions is imported while the runs are integrated.
    import_ahead("scipy.spatial.transform")
    if not make_motions(folder.path, frames):
        tell("no run is made again: the structure or the mechanics have changed since")
    moved()
    write_page(from_results(folder.path), folder.report)
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
            for place in folder.written:
                sweep(place)
            facts = {"basis": self.basis(sections), **self._plan(folder)}
            with results_of(facts):
                self.work(folder, tell, **arguments)
        except (OSError, RuntimeError) as error:
            told = of_files(error, folder.path)
            if told is None:
                raise
            raise told from error

    def basis(self, sections: Mapping[str, Any]) -> str:
        """Digest of what the stage's results depend on beside the files that it takes."""
        mechanics = [s.scene_type.digest for s in sections.values() if isinstance(s, Experiment)]
        return digest([program_digest(), json.loads(as_json(**sections)), mechanics])

    def _plan(self, folder: Folder) -> dict[str, str]:
        """The plan that all files that the stage takes are of, as a fact for its results."""
        found = {name: check(folder / name, name).get("plan") for name in self.takes}
        for name, plan in found.items():
            if plan != (first := next(iter(found.values()))):
                told = f"it is of plan {plan}, {next(iter(found))} of {first}"
                raise DamagedError(folder / name, told)
        return {"plan": next(iter(found.values()))} if found else {}

    def typed(self, data: dict) -> dict[str, Any]:
        """The stage's sections from plain data."""
        kinds = get_type_hints(Campaign)
        return {name: from_data(kinds[name], data[name]) for name in self.sections}

    def sections_of(self, campaign: Campaign) -> dict[str, Any]:
        """The stage's sections of a campaign."""
        return {name: getattr(campaign, name) for name in self.sections}


@cache
def program_digest() -> str:
    """Digest of the program, which comments and formatting do not change: all results are of it.

    Runs are of the mechanics alone, by their names.
    """
    from fpm.sources import syntax_digest

    here = Path(__file__).parents[1]
    files = (path for room in (here, here.parent / "fpm") for path in room.rglob("*"))
    return syntax_digest(
        p for p in files if p.suffix in CODE and not {"shipped", "__pycache__"} & {*p.parts}
    )


CODE = (".py", ".html", ".jinja", ".css", ".js", ".yaml", ".json")
"""Files of the program that decide about results, by how they end."""

UNCOUNTED = {"shipped", "__pycache__"}
"""Folders of what does not: workflow and campaigns that are shipped with it, compiled code."""

_PLAN, _SAMPLES, _BOX = "nodes.json", "samples.nc", "bounds.nc"

STAGES = {
    stage.name: stage
    for stage in (
        Stage(plan, ("experiment",)),
        Stage(plan_round, ("experiment",)),
        Stage(simulate, ("jobs",), (_PLAN,)),
        Stage(gather, ("jobs",), (_PLAN,)),
        Stage(bounds, ("bounds", "verify", "jobs"), (_PLAN, _SAMPLES)),
        Stage(quantities, ("requirements", "verify", "jobs"), (_PLAN, _SAMPLES)),
        Stage(requirements, ("requirements", "jobs"), (_PLAN, _SAMPLES, "further.nc")),
        Stage(choice, ("choose", "requirements", "verify", "jobs"), (_PLAN,)),
        Stage(envelopes, ("error",), (_BOX,)),
        Stage(sensitivities, (), ("sensitivities.nc",)),
        Stage(ranges, (), (_SAMPLES, "quantities.nc", "further.nc")),
        Stage(alternatives, (), ("choice.json",)),
        Stage(moments, ("figures",), (_PLAN, _SAMPLES)),
        Stage(summary, ("published", "requirements", "choose"), (_PLAN, _SAMPLES, _BOX)),
        Stage(report, (), (_SAMPLES, _BOX, "sensitivities.nc", "summary.json")),
    )
}


CORES = "DEPLOYABLE_INTERVALS_CORES"
"""Environment variable with the cores of the machine on which a workflow was started: jobs on other
machines must find as many batches."""


def batch_count(campaign: Campaign, runs: int) -> int:
    """Number of batches that runs are shared among."""
    if campaign.jobs.minutes:
        from deployable.campaign.plan.jobs import runs_in_job

        return -(-runs // runs_in_job(campaign))
    if campaign.jobs.nodes_per_job != "auto":
        return -(-runs // campaign.jobs.nodes_per_job)
    cores = int(os.environ.get(CORES, 0)) or os.cpu_count() or 1
    count = min(-(-runs // 512), max(8, cores, min(-(-runs // 4096), 64)))
    # As many for each core, so that none waits for the last job of another.
    return count - count % cores if count > cores else count


def answers(campaign: Campaign) -> list[str]:
    """The stages that answer what is asked of quantities, in their order."""
    asked = campaign.experiment.quantities, campaign.requirements, campaign.choose.parameters
    stages = ("quantities", "requirements", "choice")
    return [stage for stage, wanted in zip(stages, asked, strict=True) if wanted]


def drawings(campaign: Campaign) -> list[str]:
    """The stages that draw something of the campaign."""
    experiment = campaign.experiment
    several = len(experiment.intervals) > 1 and experiment.design.order is not None
    asked = bool(experiment.quantities)
    chosen = bool(campaign.choose.parameters)
    others = ["sensitivities"] * several + ["ranges"] * asked + ["alternatives"] * chosen
    return ["envelopes", "moments", *others]
