"""A whole campaign: in one call, or as the Snakefile asks (files, batches, dependencies)."""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from deployable.campaign.config.check import check_config, load_config
from deployable.campaign.config.loader import restore_types
from deployable.campaign.config.sections import Campaign, as_json, count_runs
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import open_dataset, read_json, results_of
from deployable.campaign.folder import Folder
from deployable.campaign.plan.jobs import batch_count, job_megabytes, job_minutes
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.runs.batch import spread
from deployable.campaign.runs.progress import MessagePrinter, Notify
from deployable.campaign.stages import STAGES, Stage, stages_of
from fpm.files.seals import DamagedError, check, unseal


class Workflow:
    """What the Snakefile asks of a campaign (its checked config): files, batches and resources.
    results: folder of all campaigns' results. Cheap to make, as every call of Snakemake does it."""

    def __init__(self, campaign: Campaign, results: str | Path = "results"):
        self.campaign, self.name = campaign, campaign.name
        self.folder = Folder(Path(results, campaign.name))
        self.cases = {
            name: Workflow(case, self.folder.path) for name, case in campaign.case_campaigns.items()
        }
        self.config = ", ".join(os.path.relpath(path, results) for path in campaign.sources)
        self.damage: dict[str, DamagedError] = {}  # of what `stale` found
        self.foreign_configs: set[str] = set()  # configs whose results `stale` found

    @classmethod
    def from_files(cls, paths: Sequence[str | Path], overrides: Mapping | None = None) -> Workflow:
        """Make the workflow of the config in YAML files; later files win over earlier ones, and
        `overrides` (Snakemake's `--config`; None: nothing) over all. Raises `ConfigError`."""
        folder = Path.cwd()  # messages have paths as users write them
        paths = [p.relative_to(folder) if p.is_relative_to(folder) else p for p in map(Path, paths)]
        return cls(load_config(paths, restore_types(overrides or {})))

    @classmethod
    def from_module(cls, config: Mapping) -> Workflow:
        """Make the workflow of the `config` that another Snakemake workflow passes to this one, its
        module; paths in it are relative to the working folder. A `Workflow` in
        `config["workflow"]`, as of a case, is returned itself. Raises `ConfigError`."""
        if isinstance(config.get("workflow"), cls):
            return config["workflow"]
        return cls(load_config([], restore_types(config), "the config of the module"))

    def sections(self, *stages: str) -> str:
        """Write the config sections that stages, by name, depend on, as JSON for their command."""
        names = {name for stage in stages for name in STAGES[stage].sections}
        return as_json(**{name: getattr(self.campaign, name) for name in sorted(names)})

    @cache  # noqa: B019 - there is one campaign in a process
    def batch_count(self) -> int:
        """Return into how many batches the runs are divided, each simulated by a job of its own."""
        return batch_count(self.campaign, count_runs(self.campaign.experiment))

    def is_one_job(self) -> bool:
        """Return whether one job makes the runs and takes their bounds: in rounds, or of a campaign
        of one batch that is not divided among processes."""
        is_single = self.batch_count() == 1 and self.campaign.jobs.processes == 1
        return self.campaign.experiment.is_adaptive or is_single

    @cache  # noqa: B019
    def minutes(self, batches: int = 1, plan_path: str | None = None) -> int:
        """Return the minutes of wall-clock time to ask a queue for, for a job of one of `batches`
        equal parts of the runs. plan_path: path of their `plan.json`, None before there is one."""
        runs = -(-count_runs(self.campaign.experiment) // batches)
        return job_minutes(self.campaign, runs, read_plan(plan_path).time if plan_path else None)

    @cache  # noqa: B019
    def megabytes(self) -> int:
        """Return the megabytes of memory to ask a queue for, for one job."""
        return job_megabytes(self.campaign)

    def stale(self) -> dict[str, str]:
        """Return the paths of results that must be made again, with the reasons: damaged, or made
        from another config, program or plan; damage is noted in `damage`, too. Seals tell this
        wherever files were made, while Snakemake knows only what it made here itself."""
        folder, plan = self.folder, None
        reasons: dict[str, str] = {}

        def read_seal(path: Path, result: Path) -> dict[str, str] | None:
            try:
                return check(path, path.name)
            except DamagedError as error:
                self.damage[str(path)] = error
                reasons[str(result)] = str(error)
                return None

        for path in sorted(folder.motions.glob("*.nc")):  # which the page makes again
            read_seal(path, folder.report)
        for stage in stages_of(self.campaign):
            paths = [path for path in self.files_of(stage) if path.exists()]
            basis = stage.basis(stage.sections_of(self.campaign)) if paths else ""
            for path in paths:
                if (facts := read_seal(path, path)) is None:
                    continue
                plan = plan or facts.get("plan")
                is_stale = (facts.get("basis"), facts.get("plan")) != (basis, plan)
                if is_stale:
                    reasons[str(path)] = f"{path} was made from something else"
                if is_stale or self.cases:  # which may differ in what they share
                    self.foreign_configs |= {facts.get("config", "")} - {"", self.config}
        return reasons

    def describe_foreign_results(self) -> Iterator[str]:
        """Warn in sentences that results of other configs, as `stale` found, will be replaced."""
        place = self.folder.path.parent
        for config in sorted(self.foreign_configs) if self.config else ():
            paths = [Path(os.path.relpath(place / name)) for name in config.split(", ")]
            if all(path.exists() for path in paths):  # else it was renamed
                yield (
                    f"the results in {self.folder.path} belong to another config, "
                    f"{', '.join(map(str, paths))}, and will be replaced: to keep them, give one "
                    "of the configs another name (`campaign`)"
                )

    def list_stages(self, is_incomplete: bool, figures: bool = True) -> list[str]:
        """List the names of the stages that `run` would do by the results that are there.
        is_incomplete: whether runs are to be simulated; figures: whether it draws."""
        stale = self.stale()
        names: list[str] = []
        for stage in stages_of(self.campaign):
            is_done = not is_incomplete if stage.name == "simulate" else self.is_whole(stage, stale)
            if (figures or not stage.draws) and (names or not is_done):
                names.append(stage.name)
        return names

    def is_whole(self, stage: Stage, stale: Mapping[str, str]) -> bool:
        """Return whether all files that a stage writes are there, and none is `stale`."""
        return all(path.exists() and str(path) not in stale for path in self.files_of(stage))

    def files_of(self, stage: Stage) -> list[Path]:
        """List the paths of the files that a stage writes; of batches only those that exist."""
        names = stage.leaves(self.campaign)
        if any("{batch}" in name for name in names):
            return sorted(self.folder.path.glob("batches/*.json"))
        return [self.folder / name for name in names]

    def inputs(self, stage: str) -> list[str]:
        """List patterns of the files that a stage, by name, reads, for its Snakemake rule:
        `{stage}/<name>`, where the wildcard `{stage}` stands for the folder of results."""
        return [f"{{stage}}/{name}" for name in STAGES[stage].inputs(self.campaign)]

    def outputs(self, stage: str, *kinds: str) -> list[str]:
        """List patterns of the files that a stage writes, for its rule with the wildcard `{stage}`,
        a folder. kinds: endings of wanted names; without any, all."""
        names = STAGES[stage].leaves(self.campaign)
        return [f"{{stage}}/{name}" for name in names if name.endswith(kinds or "")]

    def results(self) -> list[str]:
        """Return paths of the files to read: summary, figures and page; with cases also theirs."""
        if self.cases:
            files = map(str, self.files_of(STAGES["cases"]))
            return [*files, *(path for case in self.cases.values() for path in case.results())]
        last = [stage for stage in stages_of(self.campaign) if stage.draws]
        names = ["summary.json", "summary.md", *(n for s in last for n in s.leaves(self.campaign))]
        return [str(self.folder / name) for name in names]

    def answer(self, figures: bool = True) -> list[str]:
        """Return the campaign's answer, `summary.md` up to its first section, and a text that tells
        to open the page, if there is one that `figures` made; [] without a summary."""
        summary, report = self.folder / "summary.md", self.folder.report
        if not summary.exists():
            return []
        text = unseal(summary).decode().partition("\n## ")[0].strip() + "\n"
        return [text, *([f"Open {report}"] if figures and report.exists() else [])]


def run(
    config: str | Path | Mapping | Campaign,
    results: str | Path = "results",
    figures: bool = True,
    notify: Notify | None = None,
) -> Any:
    """Run a campaign and return the bounds of its responses over the parameter box.

    Results are written into `results`/<campaign>, those of a case into a folder there. Runs that
    are there already are not simulated again, and a stage is left out whose results are there and
    were made of the present config and program; damaged results are named in a message and made
    again. Linear algebra has one thread meanwhile, so that the bounds equal those of the Snakemake
    workflow to the last bit. Raises `ConfigError`, before anything is written, with everything that
    is wrong in the config, and `CampaignError` if runs fail.

    Parameters
    ----------
    config
        Path of a YAML file, its content as a mapping, or a checked `Campaign`.
    results
        Folder of all campaigns' results; made where it is missing.
    figures
        False: neither figures nor motions nor the page are made.
    notify
        Called with each message of progress, a text; None: messages go to standard error.

    Returns
    -------
    xarray.Dataset
        The content of `bounds.nc` in memory, as `intervals.bounds_dataset` describes it, which
        `bounds.plot()` draws; with cases a dict of it by the name of the case."""
    import scipy.linalg  # noqa: F401  # its library can be limited once it is loaded
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        campaign = config if isinstance(config, Campaign) else check_config(config)
        workflow = complete(campaign, results, figures, notify)
    bounds = {name: _load(case) for name, case in workflow.cases.items()}
    return bounds or _load(workflow)


def _load(workflow: Workflow) -> Any:
    from deployable.campaign.results.envelopes import Envelopes  # draws, unlike the stages

    with open_dataset(workflow.folder.bounds) as data:
        data.load()
    display = json.dumps(asdict(workflow.campaign.experiment.display))
    return Envelopes(data.data_vars, data.coords, data.attrs | {"display": display})


def complete(
    campaign: Campaign, results: str | Path, figures: bool = True, notify: Notify | None = None
) -> Workflow:
    """Make the results of a campaign that are missing or not of its config, as `run` does, which
    has the same arguments and errors, in a process whose linear algebra has one thread; returns the
    workflow, which knows where they are."""
    notify, workflow = notify or MessagePrinter(sys.stderr), Workflow(campaign, results)
    stale = workflow.stale()
    for text in workflow.describe_foreign_results():
        notify(f"warning: {text}")
    with results_of({"config": workflow.config}):
        for name, case in workflow.cases.items():
            notify(f"Case {name}")
            try:
                _run(case, case.stale(), figures, notify)
            except CampaignError as error:
                raise CampaignError(f"case {name}: {error}") from error
        _run(workflow, stale, figures, notify)
    return workflow


def _run(workflow: Workflow, stale: Mapping[str, str], figures: bool, notify: Notify) -> None:
    folder, campaign, is_remade = workflow.folder, workflow.campaign, bool(workflow.cases)
    drawing_paths = {folder.figures, folder.motions, folder.report}
    for error in workflow.damage.values():
        if figures or drawing_paths.isdisjoint([error.path, *error.path.parents]):
            notify(f"{error}; it is made again")
    stages = stages_of(campaign)
    for stage in (stage for stage in stages if not stage.draws):
        if stage.name == "simulate":
            batches = batch_count(campaign, len(read_plan(folder.plan).runs))
            for batch in range(batches):
                _stage(stage, campaign, folder, notify, batch=batch, batches=batches)
                is_remade |= bool(read_json(folder.batch(batch))["simulated"])
        elif is_remade or not workflow.is_whole(stage, stale):
            _stage(stage, campaign, folder, notify)
            is_remade = True
    last = [
        (stage, campaign, folder, notify) for stage in stages
        if figures and stage.draws and (is_remade or not workflow.is_whole(stage, stale))
    ]  # fmt: skip
    # Side by side, but where messages would be lost in other processes, or threads run, which these
    # would not have.
    is_alone = isinstance(notify, MessagePrinter) and threading.active_count() == 1
    list(spread(_stage, last, (os.cpu_count() or 1) if is_alone else 1))
    for text in workflow.answer(figures):
        notify(text)


def _stage(
    stage: Stage, campaign: Campaign, folder: Folder, notify: Notify, **options: Any
) -> None:
    if "threads" in stage.options:
        options["threads"] = os.cpu_count() or 1
    stage.run(folder, notify, **stage.sections_of(campaign), **options)
