# What the rules share: the checked config and the helpers that turn it into files and parameters.

import os
import sys
from pathlib import Path
from shlex import quote

# Jobs use the interpreter that runs Snakemake, and the packages of the checkout that this file is
# of; without one, those that are installed. With `-P` no file of the campaign's folder stands for one
# of them.
ROOT = Path(str(workflow.current_basedir)).resolve().parents[1]
PACKAGES = [str(ROOT)] if (ROOT / "deployable").is_dir() else []
sys.path[:0] = PACKAGES

from deployable import other_fpm

if other := other_fpm():
    print(other, file=sys.stderr)
    sys.exit(1)

os.environ.update(
    PATH=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")]),
    PYTHONPATH=os.pathsep.join(filter(None, [*PACKAGES, os.environ.get("PYTHONPATH")])),
)

from deployable.campaign import stages
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import ROUND_FILES
from deployable.campaign.workflow import Workflow

# Snakemake formats the whole path of an environment, so that braces in it are to be doubled.
ENVIRONMENT = "../envs/campaign.yaml"
if "{" in str(ROOT) or "}" in str(ROOT):
    ENVIRONMENT = str(ROOT / "workflow" / "envs" / "campaign.yaml")
    ENVIRONMENT = ENVIRONMENT.replace("{", "{{").replace("}", "}}")

os.environ.setdefault(stages.CORES, str(os.cpu_count() or 1))
IS_MODULE = workflow.modifier.namespace is not None
# Whether jobs get the files that rules declare, and no others.
IS_APART = workflow.storage_settings.default_storage_provider is not None
ASKED = workflow.config_settings.configfiles

# A module has the config that it is given. Otherwise the files that were asked for, or what the
# including Snakefile calls CAMPAIGN, from its folder, or the paper's. Not `configfile:`, which would
# mix one campaign's intervals into another's and would let a key that is given twice pass.
try:
    if IS_MODULE and config:
        WORKFLOW = Workflow.from_module(config)
    else:
        usual = globals().get("CAMPAIGN", ROOT / "config" / "paper.yaml")
        WORKFLOW = Workflow.from_files(
            ASKED or [Path(workflow.basedir, usual)], workflow.config_settings.config
        )
except CampaignError as error:
    print(error, file=sys.stderr)
    sys.exit(1)


if "--report" in sys.argv and not ASKED and not IS_MODULE:
    if other := WORKFLOW.other_report():
        print(other, file=sys.stderr)
        sys.exit(1)

# Results tell what they were made from, and whether they are whole, wherever they come from.
STALE = WORKFLOW.stale() if workflow.is_main_process else {}
for reason in STALE.values():
    print(f"{reason}; it is made again", file=sys.stderr)


wildcard_constraints:
    campaign=WORKFLOW.name,
    stage=WORKFLOW.any_stage,
    batch=r"\d+",
    round=r"\d+",


def campaign_results():
    """The files that a campaign leaves for its reader."""
    return WORKFLOW.results()


def no_files(wildcards):
    """No input for the rules that begin; has the results made again that are stale.

    As `--forcerun` does, for which it is too late when the Snakefile is read.
    """
    workflow.dag.forcefiles.update(STALE)
    return []


def folder_of(wildcards, output):
    """The folder of a stage's results as its job sees it, with the prefix of a storage or module."""
    stage = wildcards.get("stage") or f"results/{wildcards.campaign}"
    if "round" in wildcards.keys():
        stage = f"{stage}/rounds/{wildcards.round}"
    path = str(output[0])
    return path[: path.rindex(f"{stage}/") + len(stage)]


def sections(stage):
    """What a stage needs of the config; with it as `params` a rule runs again when it changes."""
    return WORKFLOW.sections(stage)


def code(stage):
    """Digest of a stage's code; with it as `params` a rule runs again when it changes."""
    return WORKFLOW.code(stage)


def batch_count(wildcards):
    """Number of batches that the runs of a stage are shared among."""
    if not WORKFLOW.campaign.experiment.is_sought:
        return WORKFLOW.batch_count()
    number = wildcards.stage.rsplit("/", 1)[1]
    plan = checkpoints.plan_round.get(campaign=WORKFLOW.name, round=number).output[0]
    return WORKFLOW.batch_count(plan)


def job_minutes(wildcards, input):
    """Minutes to ask a queue for, for a batch of runs."""
    plan = str(input[0])
    there = Path(plan).exists() and plan not in STALE
    return WORKFLOW.minutes(batch_count(wildcards), plan if there else None)


def batch_files(name):
    """The files that a batch leaves beside its runs: its manifest, and its runs as one file."""
    return {"manifest": f"{name}.json"} | (
        {"bundle": f"{name}.tar"} if IS_APART else {}
    )


def batches(wildcards, kind="json"):
    """The manifests of all batches of a stage."""
    return [
        f"{wildcards.stage}/batches/{batch}.{kind}"
        for batch in range(batch_count(wildcards))
    ]


def bundles(wildcards):
    """The runs of all batches of a stage, where they are not in a folder that all jobs share."""
    return batches(wildcards, "tar") if IS_APART else []


def previous_round(wildcards):
    """The files of the round before, which decide about this one; none for the first."""
    before = WORKFLOW.folder.round(int(wildcards.round)).previous()
    return (
        [before.plan, before.samples, before.bounds] if before else no_files(wildcards)
    )


def last_round(wildcards):
    """The files of the last round, and its plan with the reason to stop."""
    number = 0
    while True:
        plan = checkpoints.plan_round.get(
            campaign=wildcards.campaign, round=number
        ).output[0]
        if WORKFLOW.is_last(plan):
            before = WORKFLOW.folder.round(number).previous()
            return [plan, *(before / name for name in ROUND_FILES[1:])]
        number += 1
