# What the rules share: the checked config and the helpers that turn it into files and parameters.

import os
import sys
from pathlib import Path

# Jobs use the interpreter that runs Snakemake, and find the packages of this checkout.
os.environ.update(
    PATH=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")]),
    PYTHONPATH=os.pathsep.join(
        filter(None, [str(workflow.basedir), os.environ.get("PYTHONPATH")])
    ),
)
sys.path.insert(0, str(workflow.basedir))

from campaign.errors import CampaignError
from campaign.folder import ROUND_FILES
from campaign.workflow import Workflow

# Not `configfile:`, which would mix the paper's intervals into another campaign's and would let
# a key that is given twice pass.
try:
    WORKFLOW = Workflow.from_files(
        workflow.config_settings.configfiles
        or [f"{workflow.basedir}/config/paper.yaml"],
        workflow.config_settings.config,
    )
except CampaignError as error:
    print(error, file=sys.stderr)
    sys.exit(1)


if "--report" in sys.argv and not workflow.config_settings.configfiles:
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


def sections(stage):
    """What a stage needs of the config; with it as `params` a rule runs again when it changes."""
    return WORKFLOW.sections(stage)


def code(stage):
    """Digest of a stage's code; with it as `params` a rule runs again when it changes."""
    return WORKFLOW.code(stage)


def batch_count(wildcards):
    """Number of batches that the runs of a stage are shared among."""
    if not WORKFLOW.campaign.is_adaptive:
        return WORKFLOW.batch_count()
    number = wildcards.stage.rsplit("/", 1)[1]
    plan = checkpoints.plan_round.get(campaign=WORKFLOW.name, round=number).output[0]
    return WORKFLOW.batch_count(plan)


def batches(wildcards):
    """The manifests of all batches of a stage."""
    return [
        f"{wildcards.stage}/batches/{batch}.json"
        for batch in range(batch_count(wildcards))
    ]


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
