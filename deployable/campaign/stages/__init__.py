"""The stages of a campaign, as a table: each takes files of its folder, and sections of the config,
to others.

`campaign.run` calls them one after another, `python -m deployable STAGE` one alone, for the rules
of the workflow.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, get_type_hints

from deployable.campaign.config.sections import (
    Campaign,
    Experiment,
    as_json,
    digest,
    from_data,
    trust,
)
from deployable.campaign.errors import CampaignError, of_files
from deployable.campaign.files import HISTORY, check_results, refuse_links, results_of
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import program_digest
from deployable.campaign.runs.progress import Tell
from fpm.errors import SceneError
from fpm.files.sealed import DamagedError, check, sweep

PLAN, SAMPLES, BOX = "plan.json", "samples.nc", "bounds.nc"
ANSWERS = "quantities.nc", "further.nc"

FRAMES = 401
"""Frames of the runs that move on a page, unless others are asked for."""


@dataclass(frozen=True)
class Stage:
    """A stage of a campaign: what it does, the sections of the config that it takes, and the
    results that it reads; threads: whether it makes runs that threads can share.

    Its module here has the name of the stage, and a function `work(folder, tell, **arguments)`. It
    is imported where the stage runs, so that a process loads what its own work needs.
    """

    name: str
    about: str
    sections: tuple[str, ...]
    takes: tuple[str, ...] = ()
    threads: bool = True

    def work(self, folder: Folder, tell: Tell, **arguments: Any) -> None:
        """Do the work of the stage, by its module."""
        import_module(f"{__name__}.{self.name}").work(folder, tell, **arguments)

    def run(self, folder: Folder, tell: Tell, **arguments: Any) -> None:
        """Do the work on a folder; its arguments are the sections, and those of the batch.

        Raises `CampaignError` for trouble with files, among them those that do not belong together.
        """
        sections = {name: arguments[name] for name in self.sections}
        try:
            refuse_links(folder.whole)
            for place in folder.stage_folders:
                sweep(place)
            facts = {"basis": self.basis(sections), **plan_of(folder, self.takes)}
            with results_of(facts):
                self.work(folder, tell, **arguments)
        except SceneError as error:  # of the structure that the results name
            place = HISTORY[-1] if HISTORY else folder.path
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


def plan_of(folder: Folder, names: Sequence[str]) -> dict[str, str]:
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
        Stage("plan", "Choose the runs of a campaign and the time step that serves them all.",
              ("experiment",), threads=False),
        Stage("rounds", "Make runs in rounds until an accuracy is met or its budget is spent.",
              ("experiment", "bounds", "verify", "jobs")),
        Stage("simulate", "Simulate one batch of the planned runs, except those that are there.",
              ("jobs",), (PLAN,)),
        Stage("bounds", "Gather the responses of all runs, fit the surrogate, take its bounds.",
              ("bounds", "verify", "jobs"), (PLAN,)),
        Stage("answers", "Find intervals of quantities, what meets the requirements, the choice.",
              ("requirements", "choose", "published", "review", "verify", "jobs"),
              (PLAN, SAMPLES, BOX)),
        Stage("figures", "Draw responses with their bounds, and what parameters contribute.",
              ("error",), (PLAN, BOX, "sensitivities.nc"), threads=False),
        Stage("page", "Make the page, with the motion of some runs and moments of the nominal one.",
              ("figures",), (SAMPLES, BOX, "sensitivities.nc", "summary.json"), threads=False),
    )
}  # fmt: skip


def drawings(experiment: Experiment) -> list[str]:
    """Names of the figures of the whole campaign that `figures` draws."""
    several = len(experiment.intervals) > 1 and experiment.design.order is not None
    return ["sensitivities"] * several + ["ranges"] * bool(experiment.quantities)
