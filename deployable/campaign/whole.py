"""A whole campaign in one call, without Snakemake, into the same files."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from deployable.campaign.config.check import check_config, load_config
from deployable.campaign.config.sections import Campaign
from deployable.campaign.files import open_dataset
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.runs.progress import Tell, Teller
from deployable.campaign.stages import STAGES, batch_count
from deployable.campaign.workflow import Workflow
from fpm.files.sealed import DamagedError


def run(
    config: str | Path | Mapping | Campaign,
    results: str | Path = "results",
    figures: bool = True,
    tell: Tell | None = None,
) -> Any:
    """Run a campaign into `results`/<campaign> and return its bounds, an `xarray.Dataset`.

    `config` is the name of a YAML file, or what one holds. Runs that are there already are not
    simulated again; everything else is made anew, and what was damaged is named. `tell` gets
    messages of progress, which are printed if nothing is said. Bounds are the workflow's to the
    last bit with `OMP_NUM_THREADS=1`; threads of linear algebra round otherwise.
    Raises `ConfigError` before anything is written, `CampaignError` when runs fail.
    """
    tell = tell or Teller(sys.stderr)
    campaign = _campaign(config)
    folder = Folder(Path(results, campaign.name))
    for error in _damaged_in(campaign, results, figures):
        tell(f"{error}; it is made again")
    if campaign.experiment.is_sought:
        _stage("rounds", campaign, folder, tell)
    else:
        _stage("plan", campaign, folder, tell)
        batches = batch_count(campaign, len(read_plan(folder.plan).runs))
        for batch in range(batches):
            _stage("simulate", campaign, folder, tell, batch=batch, batches=batches)
        _stage("bounds", campaign, folder, tell)
    for name in ("answers", *["figures", "page"] * figures):
        _stage(name, campaign, folder, tell)
    return _open(folder.bounds)


def _open(path: Path) -> Any:
    with open_dataset(path) as data:
        return data.load()


def _campaign(config: str | Path | Mapping | Campaign) -> Campaign:
    if isinstance(config, Campaign):
        return config
    return check_config(config) if isinstance(config, Mapping) else load_config([config])


def _damaged_in(campaign: Campaign, results: str | Path, figures: bool) -> list[DamagedError]:
    """Results of a campaign that are there, not as they were written, and made again."""
    workflow = Workflow(campaign, results)
    workflow.stale()
    folder = workflow.folder
    drawn = {folder.figures, folder.motions, folder.report}
    errors = workflow.damaged.values()
    return [e for e in errors if figures or drawn.isdisjoint([e.path, *e.path.parents])]


def _stage(name: str, campaign: Campaign, folder: Folder, tell: Tell, **more: Any) -> None:
    stage = STAGES[name]
    if stage.has_threads:
        more["threads"] = os.cpu_count() or 1
    stage.run(folder, tell, **stage.sections_of(campaign), **more)
