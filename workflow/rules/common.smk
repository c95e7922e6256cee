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

os.environ.update(
    PATH=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")]),
    PYTHONPATH=os.pathsep.join(filter(None, [*PACKAGES, os.environ.get("PYTHONPATH")])),
)

from deployable.campaign.errors import CampaignError
from deployable.campaign.plan.jobs import CORES
from deployable.campaign.provenance import CONFIG, program_digest
from deployable.campaign.stages import STAGES
from deployable.campaign.stages.workflow import Workflow
from fpm.errors import did_you_mean, likely

# Snakemake formats the whole path of an environment, so that braces in it are to be doubled.
ENVIRONMENT = "../envs/campaign.yaml"
if "{" in str(ROOT) or "}" in str(ROOT):
    ENVIRONMENT = str(ROOT / "workflow" / "envs" / "campaign.yaml")
    ENVIRONMENT = ENVIRONMENT.replace("{", "{{").replace("}", "}}")

os.environ.setdefault(CORES, str(os.cpu_count() or 1))
# Whether jobs get the files that rules declare, and no others.
IS_APART = workflow.storage_settings.default_storage_provider is not None
CONFIG_FILES = workflow.config_settings.configfiles

# A module (workflow/Snakefile says that it is one) has the config that it is given. Otherwise the
# files that were asked for, or what the including Snakefile calls CAMPAIGN, from its folder, or the
# paper's. Not `configfile:`, which would mix one campaign's intervals into another's and would let a
# key that is given twice pass.
IS_MODULE = "MODULE" in globals() and bool(config)
try:
    if IS_MODULE:
        WORKFLOW = Workflow.from_module(config)
    else:
        usual = globals().get("CAMPAIGN", ROOT / "config" / "paper.yaml")
        WORKFLOW = Workflow.from_files(
            CONFIG_FILES or [Path(workflow.basedir, usual)],
            workflow.config_settings.config,
        )
except CampaignError as error:
    print(error, file=sys.stderr)
    sys.exit(1)


# Results tell what they were made from, and whether they are whole, wherever they come from.
STALE = WORKFLOW.stale() if workflow.is_main_process else {}
for reason in STALE.values():
    print(f"{reason}; it is made again", file=sys.stderr)
for text in WORKFLOW.describe_foreign_results():
    print(f"warning: {text}", file=sys.stderr)

# Snakemake says of a target that it does not know, not which one is meant.
TARGETS = [*STAGES, "all"]
if (ROOT / "evidence").is_dir():
    from evidence.registry import STUDIES

    TARGETS += STUDIES
for word in sys.argv[1:] if workflow.is_main_process else ():
    if word.isidentifier() and word not in TARGETS and likely(word, TARGETS):
        print(f"{word}: no such target{did_you_mean(word, TARGETS)}", file=sys.stderr)
if not IS_MODULE:
    os.environ[CONFIG] = WORKFLOW.config


# With these as `params` rules run again when the program, or what decides about runs, changes.
CODE = program_digest()
MECHANICS = WORKFLOW.campaign.experiment.mechanics
PROCESSES = WORKFLOW.campaign.jobs.processes


wildcard_constraints:
    stage=WORKFLOW.folder.path.as_posix(),
    batch=r"\d+",


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
    path = str(output[0])
    return path[: path.rindex(f"{wildcards.stage}/") + len(wildcards.stage)]


def call(stage, *more):
    """The command of a stage."""
    config = "--config {params.config:q} --log {log:q}"
    return " ".join(
        [f"python -P -m deployable {stage} {{params.folder:q}} {config}", *more]
    )


def asked_minutes(*arguments):
    """Minutes to ask a queue for; none where jobs run here, since the step takes 0.3 s to find."""
    return WORKFLOW.minutes(*arguments) if workflow.non_local_exec_or_dryrun else 1


def job_minutes(input):
    """Minutes to ask a queue for, for a batch of runs."""
    plan = str(input[0])
    has_plan = Path(plan).exists() and plan not in STALE
    return asked_minutes(WORKFLOW.batch_count(), plan if has_plan else None)


def minutes(wildcards, attempt):
    """Minutes to ask a queue for, for a job that may make all runs."""
    return attempt * asked_minutes()


def megabytes(wildcards, attempt):
    """Memory to ask a queue for."""
    return attempt * WORKFLOW.megabytes()


def batch_files(manifest):
    """The files that a batch leaves beside its runs: its manifest, and its runs as one file."""
    bundle = manifest.replace(".json", ".tar")
    return {"manifest": manifest} | ({"bundle": bundle} if IS_APART else {})


def batches(kind):
    """What all batches leave, of a kind: their manifests, or their runs where jobs share no folder."""
    count = WORKFLOW.batch_count()
    return [f"{{stage}}/batches/{batch}.{kind}" for batch in range(count)]
