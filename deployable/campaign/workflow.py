"""What the Snakefile asks of a campaign: its files, its batches, and what each rule depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from deployable.campaign.config.check import load_config
from deployable.campaign.config.design import count_runs
from deployable.campaign.config.loader import retyped
from deployable.campaign.config.sections import Campaign, as_json
from deployable.campaign.folder import PICTURES, Folder
from deployable.campaign.stages import (
    STAGES,
    answers,
    batch_count,
    drawings,
    program_digest,
)
from fpm.sealed import DamagedError, check


class Workflow:
    """A campaign with the names of its files.

    Importing and making one is cheap, since every call of Snakemake does it.
    """

    def __init__(self, campaign: Campaign, results: str | Path = "results"):
        self.campaign, self.name = campaign, campaign.name
        self.folder = Folder(Path(results, campaign.name))
        self.damaged: dict[str, DamagedError] = {}  # of what `stale` found

    @classmethod
    def from_files(cls, paths: Sequence[str | Path], overrides: Mapping | None = None) -> Workflow:
        """The campaign of YAML files, later ones and `overrides` (of `--config`) winning.

        Raises `ConfigError`.
        """
        return cls(load_config([_relative(path) for path in paths], retyped(overrides or {})))

    @classmethod
    def from_module(cls, config: Mapping) -> Workflow:
        """The campaign that a workflow gives to this one, its module; paths in it are relative to
        the working folder.

        Raises `ConfigError`.
        """
        return cls(load_config([], retyped(config), "the config of the module"))

    def sections(self, stage: str) -> str:
        """The sections of the config that a stage depends on, as JSON."""
        return as_json(**STAGES[stage].sections_of(self.campaign))

    def code(self, stage: str) -> str:
        """The digest of the code that a stage runs."""
        return program_digest()

    @property
    def mechanics(self) -> str:
        """Digest of the mechanics and of the structure; another one makes other runs."""
        return self.campaign.experiment.scene_type.digest

    @property
    def plan_rules(self) -> str:
        """The rules that plan the runs: all at once, or in rounds."""
        return f"{'rounds' if self.campaign.experiment.is_sought else 'plan'}.smk"

    @property
    def any_stage(self) -> str:
        """Pattern of the folders of the campaign and of its rounds."""
        return rf"results/{self.name}(/rounds/\d+)?"

    @property
    def run_stage(self) -> str:
        """Pattern of the folders in which runs are made: the campaign's, or those of its rounds."""
        rounds = r"/rounds/\d+" if self.campaign.experiment.is_sought else ""
        return f"results/{self.name}{rounds}"

    @cache  # noqa: B019 - there is one campaign in a process
    def batch_count(self, plan_path: str | None = None) -> int:
        """Number of jobs that the runs are shared among, those of a plan or of the config."""
        from deployable.campaign.plan.plan import read_plan

        runs = len(read_plan(plan_path).runs) if plan_path else count_runs(self.campaign.experiment)
        return batch_count(self.campaign, runs)

    @property
    def processes(self) -> int:
        """Cores that a job with runs shall have."""
        return self.campaign.jobs.processes

    @cache  # noqa: B019
    def minutes(self, batches: int = 1, plan_path: str | None = None) -> int:
        """Minutes to ask a queue for: for one of so many jobs that the runs are shared among.

        plan_path: the plan of these runs, if it is there.
        """
        from deployable.campaign.plan.jobs import job_minutes
        from deployable.campaign.plan.plan import read_step

        runs = -(-count_runs(self.campaign.experiment) // batches)
        return job_minutes(self.campaign, runs, read_step(plan_path) if plan_path else None)

    @cache  # noqa: B019
    def megabytes(self) -> int:
        """Memory to ask a queue for."""
        from deployable.campaign.plan.jobs import job_megabytes

        return job_megabytes(self.campaign)

    def is_last(self, plan_path: str) -> bool:
        """Whether a round's plan says that the rounds are over."""
        from deployable.campaign.plan.plan import read_plan

        return read_plan(plan_path).is_finished

    def stale(self) -> dict[str, str]:
        """Results that are there and must be made again, with the reason: damaged or of something
        else.

        Snakemake knows what it made here itself; the files know it wherever they were made.
        """
        found: dict[str, str] = {}
        if not self.campaign.experiment.is_sought:
            self._stale_in(self.folder, "plan", found)
            return found
        self._stale_in(self.folder, "plan_round", found, rounds=False)
        number = 0
        while (place := self.folder.round(number)).plan.exists():
            self._stale_in(place, "plan_round", found, figures=False)
            if str(place.plan) in found or self.is_last(str(place.plan)):
                break  # what comes after is made again, or of no more use
            number += 1
        return found

    def _stale_in(
        self, folder: Folder, plan: str, found: dict[str, str], rounds=True, figures=True
    ) -> None:
        """Add the stale results in the folder of a campaign or of a round."""
        files = {plan: [folder.plan], "gather": [folder.samples]}
        files["bounds"] = [folder.bounds, folder.surrogate, folder.sensitivities]
        if figures:
            known = _answer_files(folder)
            files |= {name: known[name] for name in answers(self.campaign)}
        if rounds:
            files["simulate"] = sorted(folder.path.glob("batches/*.json"))
        if figures:
            for name in drawings(self.campaign):
                responses = folder.pictures(self.campaign.experiment.responses)
                drawn = responses if name == "envelopes" else folder.overview(name)
                files[name] = list(map(Path, drawn))
            files["summary"] = [folder / f"summary.{kind}" for kind in ("json", "md")]
            files["report"] = [folder.report]
            self._damaged_motions(folder, found)
        of = None
        for stage, paths in files.items():
            there = [path for path in paths if path.exists()]
            basis = there and STAGES[stage].basis(STAGES[stage].sections_of(self.campaign))
            for path in there:
                try:
                    facts = check(path, path.name)
                except DamagedError as error:
                    self.damaged[str(path)] = error
                    found[str(path)] = str(error)
                    continue
                of = of or facts.get("plan")
                if (facts.get("basis"), facts.get("plan")) != (basis, of):
                    found[str(path)] = f"{path} was made from something else"

    def _damaged_motions(self, folder: Folder, found: dict[str, str]) -> None:
        """Have the page made again, and with it motions that are damaged."""
        for path in sorted(folder.motions.glob("*.nc")):
            try:
                check(path, path.name)
            except DamagedError as error:
                self.damaged[str(path)] = error
                found[str(folder.report)] = str(error)

    def envelope_figures(self, stage: str, *kinds: str) -> list[str]:
        """The figures of the responses, of some kinds or of all."""
        return Folder(stage).pictures(self.campaign.experiment.responses, kinds or PICTURES)

    def answers(self, stage: str) -> list[str]:
        """The files that answer what is asked of quantities, if anything is."""
        files = _answer_files(Folder(stage))
        return [str(path) for name in answers(self.campaign) for path in files[name]]

    def overview(self, stage: str, name: str) -> list[str]:
        """The files of a figure of the whole campaign."""
        return Folder(stage).overview(name)

    def results(self) -> list[str]:
        """The files that a campaign leaves for its reader."""
        stages = drawings(self.campaign)[1:]
        others = [path for stage in stages for path in self.folder.overview(stage)]
        summary = [str(self.folder / f"summary.{kind}") for kind in ("json", "md")]
        figures = self.envelope_figures(str(self.folder.path)) + others
        return [*figures, *summary, str(self.folder.report)]

    def other_report(self, results: Path = Path("results")) -> str:
        """What to say where the campaign of `--report` was not asked for and is not the last one
        that was run; nothing where it is."""
        reports = {path.parent.name: path.stat().st_mtime for path in results.glob("*/report.html")}
        last = max(reports, key=reports.get, default=self.name)
        if last == self.name:
            return ""
        return (
            f"--report without --configfile is about the campaign {self.name}, but {last} was the "
            f"last one that was run; add --configfile with the config of the one that is meant"
        )

    def last_words(self) -> str:
        """What was told when the page was made: the answer, and which file to open; nothing where
        the log is kept elsewhere."""
        log = self.folder / "logs/report.log"
        return log.read_text(encoding="utf-8").strip() if log.exists() else ""


def _answer_files(folder: Folder) -> dict[str, list[Path]]:
    """The files of each stage that answers what is asked of quantities."""
    return {
        "quantities": [folder.quantities, folder.further],
        "requirements": [folder.requirements],
        "choice": [folder.choice],
    }


def _relative(path: str | Path) -> Path:
    """The path as the user would write it, for messages."""
    path = Path(path)
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
