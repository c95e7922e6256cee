"""The stages of a campaign, as a table: each takes files of its folder, and sections of the config,
to others. `campaign.run` calls them one after another, `python -m deployable STAGE` one alone."""

import json
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, get_type_hints

from deployable.campaign.config.sections import Campaign, Experiment, digest, from_data
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import check_results, read_json, results_of
from deployable.campaign.folder import MOST_PANELS, PICTURES, Folder
from deployable.campaign.plan.plan import errors_of_results, read_plan
from deployable.campaign.provenance import program_digest
from deployable.campaign.runs.progress import LOGGER, Notify
from fpm.errors import SceneError
from fpm.files.seals import DamagedError, remove_temporary

PLAN, SAMPLES, BOUNDS = "plan.json", "samples.nc", "bounds.nc"
DESIGN_BOUNDS, SENSITIVITIES = "design_bounds.nc", "sensitivities.nc"
BOUNDS_FILES = SAMPLES, "surrogate.nc", DESIGN_BOUNDS, SENSITIVITIES
ANSWERS = "quantities.nc", "refinement.nc"

FRAMES = 401  # frames of the runs that move on a page, unless others are asked for

OPTIONS = {
    "batch": {"type": int, "default": 0, "help": "number of the batch, from 0"},
    "batches": {"type": int, "default": 1, "help": "number of batches"},
    "processes": {"type": int, "default": 1, "help": "number of worker processes (%(default)s)"},
    "threads": {"type": int, "default": 1, "help": "number of threads (%(default)s)"},
    "bundle": {"type": Path, "help": "file for the runs, if no folder is shared"},
    "bundles": {"nargs": "*", "type": Path, "default": [], "help": "runs, as files"},
    "since": {"choices": ("plan", "simulate"), "help": "first of the stages before to be run too"},
    "frames": {"type": int, "default": FRAMES,
               "help": "frames of the runs that move, evenly spread (%(default)s)"},
}  # fmt: skip
"""What commands of stages may be told beside the config, as `argparse` takes it."""


@dataclass(frozen=True)
class Stage:
    """A stage of a campaign: `name` (of its command and module, whose function `work` is imported
    when it runs) and `text` (a sentence). sections: names of the config sections that it depends
    on; takes: names of result files that it reads; leaves: function of a campaign that names those
    it writes, `{batch}` for the number of a batch; options: keys of `OPTIONS`; is_adaptive: True if
    only campaigns with an `accuracy` have it, False: only others; draws: whether it only shows."""

    name: str
    text: str
    sections: tuple[str, ...]
    takes: tuple[str, ...]
    leaves: Callable[[Campaign], Sequence[str]]
    options: tuple[str, ...] = ()
    is_adaptive: bool | None = None
    draws: bool = False

    def work(self, folder: Folder, notify: Notify, **arguments: Any) -> None:
        """Do the work of the stage; only `run` has seals of its files say what they are of."""
        import_module(f"{__name__}.{self.name}").work(folder, notify, **arguments)

    def run(self, folder: Folder, notify: Notify, **arguments: Any) -> None:
        """Do the work of the stage in a folder of results, and seal the files that it writes with
        what they are made of. notify: called with each message; arguments: its sections and options
        by name. Raises `CampaignError` for trouble with files, also files of several plans."""
        sections, start = {name: arguments[name] for name in self.sections}, time.monotonic()
        try:
            with errors_of_results(folder):
                for place in folder.stage_folders:
                    remove_temporary(place)
                facts = {"basis": self.basis(sections), **check_results(folder, self.takes)}
                with results_of(facts):
                    self.work(folder, notify, **arguments)
            if LOGGER.isEnabledFor(logging.DEBUG):
                notify(f"{folder.path}: stage {self.name} took {time.monotonic() - start:.2f} s")
        except SceneError as error:  # of the structure that the results name
            raise CampaignError(f"{folder.path}: {error}; run the campaign again") from error

    def basis(self, sections: Mapping[str, Any]) -> str:
        """Return a digest of what the stage's results depend on apart from the files that it reads:
        program, structure and `sections` of the config, by name."""
        mechanics = [s.mechanics for s in sections.values() if isinstance(s, Experiment)]
        return digest([program_digest(), sections, mechanics])

    def inputs(self, campaign: Campaign) -> list[str]:
        """List the names of all result files that the stage may read."""
        shown_files = [PLAN, *BOUNDS_FILES, *_list_answers(campaign)] if self.draws else []
        return list(dict.fromkeys([*self.takes, *shown_files]))

    def sections_in(self, config: str, folder: Folder | None = None) -> dict[str, Any]:
        """Return the config sections that the stage depends on, by name. config: path of a YAML
        file, or the JSON of the sections that the workflow passes; folder: of the results, which
        tells the case, None for a campaign without cases. Raises `CampaignError`."""
        if not config.lstrip().startswith("{"):  # jobs of the workflow load no checks of a config
            check = import_module("deployable.campaign.config.check")
            campaign = check.load_config([config])
            if campaign.cases and self.name != "cases":
                names = {case.name: case for case in campaign.case_campaigns.values()}
                if folder is None or folder.whole.name not in names:
                    allowed = ", ".join(f"{campaign.name}/{name}" for name in names)
                    raise CampaignError(f"{folder and folder.whole} is not the folder of a case of "
                                        f"{config}; allowed: {allowed}")  # fmt: skip
                campaign = names[folder.whole.name]
            if folder is not None and self.takes and folder.plan.exists():
                text, experiment = "", campaign.experiment
                with suppress(DamagedError):  # which the stage refuses when it reads the file
                    if read_json(folder.plan).get("structure") != experiment.scene_type.digest:
                        text = f"the structure of {config} has changed since {folder.path} was made"
                        text = f"{text}: run it again"
                    if _identity(read_plan(folder.plan).experiment) != _identity(experiment):
                        text = f"the results in {folder.path} belong to another config than"
                        text = f"{text} {config}: name theirs, or run that one again"
                if text:
                    raise CampaignError(f"{text}")
            return self.sections_of(campaign)
        try:
            data, kinds = json.loads(config), get_type_hints(Campaign)
            return {name: from_data(kinds[name], data[name]) for name in self.sections}
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            text = f"--config is no JSON of the sections that the stage needs: {error!r}"
            raise CampaignError(text) from None

    def sections_of(self, campaign: Campaign) -> dict[str, Any]:
        """Return the config sections of a campaign that the stage depends on, by name."""
        return {name: getattr(campaign, name) for name in self.sections}


def _identity(experiment: Experiment) -> list[Any]:
    """What of an experiment decides its results, and rounds do not change."""
    scene, solver, is_adaptive = experiment.scene, experiment.solver, experiment.is_adaptive
    settings = (solver.duration, solver.instants) if is_adaptive else (solver, scene.parameters)
    parts = experiment.name, experiment.intervals, experiment.responses, experiment.quantities
    return [*settings, *parts]


def drawings(experiment: Experiment) -> list[str]:
    """List the names of the figures of a whole campaign that the stage `figures` draws."""
    has_panels = 1 < len(experiment.responses) <= MOST_PANELS
    has_contributions = len(experiment.intervals) > 1 and experiment.design.order is not None
    names = ["responses"] * has_panels + ["sensitivities"] * has_contributions
    return names + ["ranges"] * bool(experiment.quantities)


def _list_answers(campaign: Campaign) -> list[str]:
    """List the files that sum up a campaign and answer its questions."""
    names = ["summary.json", "summary.md", BOUNDS]
    names += ANSWERS * bool(campaign.experiment.quantities)
    names += ["requirements.json"] * bool(campaign.requirements)
    names += ["choice.json"] * bool(campaign.choose.parameters)
    return names + ["measured.json"] * bool(campaign.measured)


def _figures(campaign: Campaign) -> list[str]:
    overviews = (f"campaign/{name}" for name in drawings(campaign.experiment))
    names = *campaign.experiment.responses, *overviews
    return [f"figures/{name}.{kind}" for name in names for kind in PICTURES]


STAGES = {
    stage.name: stage
    for stage in (
        Stage("rounds", "Make runs in rounds until an accuracy is met or its budget is spent.",
              ("experiment", "bounds", "verify", "jobs"), (), lambda _: (PLAN, *BOUNDS_FILES),
              ("threads",), is_adaptive=True),
        Stage("plan", "Choose the runs of a campaign and the time step that serves them all.",
              ("experiment",), (), lambda _: (PLAN,), is_adaptive=False),
        Stage("simulate", "Simulate one batch of the planned runs, except those that are there.",
              ("jobs",), (PLAN,), lambda _: ("batches/{batch}.json",),
              ("batch", "batches", "processes", "threads", "bundle"), is_adaptive=False),
        Stage("bounds", "Gather the responses of all runs, fit the surrogate, take its bounds.",
              ("bounds", "verify", "jobs"), (PLAN,), lambda _: BOUNDS_FILES,
              ("threads", "bundles", "since"),
              is_adaptive=False),
        Stage("answers", "Find intervals of quantities, what meets the requirements, the choice.",
              ("requirements", "choose", "published", "review", "verify", "jobs", "measured"),
              (PLAN, SAMPLES, DESIGN_BOUNDS), _list_answers, ("threads",)),
        Stage("figures", "Draw responses with their bounds, and what parameters contribute.",
              (), (PLAN, BOUNDS, SENSITIVITIES), _figures, draws=True),
        Stage("page", "Make the page, with the motion of some runs and moments of the nominal one.",
              (), (SAMPLES, BOUNDS, SENSITIVITIES, "summary.json"),
              lambda _: ("report.html", *(f"figures/campaign/moments.{x}" for x in PICTURES)),
              ("frames",), draws=True),
        Stage("cases", "Compare the cases of a campaign, from their summaries.",
              ("cases",), (), lambda _: ("cases.json", "summary.md", "report.html")),
    )
}  # fmt: skip


def stages_of(campaign: Campaign) -> list[Stage]:
    """Return the stages of a campaign in the order in which they run; of one with cases only
    `cases`, which compares them: each case is a campaign with stages of its own."""
    if campaign.cases:
        return [STAGES["cases"]]
    kinds = (None, campaign.experiment.is_adaptive)
    return [s for s in STAGES.values() if s.is_adaptive in kinds and s.name != "cases"]
