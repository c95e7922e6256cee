# What the rules share: the checked config and the helpers that turn it into files and parameters.

import json
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
from campaign.workflow import Campaign

# Not `configfile:`, which would mix the paper's intervals into another campaign's and would let
# a key that is given twice pass.
try:
    CAMPAIGN = Campaign.from_files(
        workflow.config_settings.configfiles
        or [f"{workflow.basedir}/config/paper.yaml"],
        workflow.config_settings.config,
    )
except CampaignError as error:
    print(error, file=sys.stderr)
    sys.exit(1)


wildcard_constraints:
    campaign=CAMPAIGN.name,
    stage=CAMPAIGN.any_stage,
    batch=r"\d+",
    round=r"\d+",


# What a round leaves; in an adaptive campaign the last round's become the campaign's.
ROUND_FILES = [
    "nodes.json",
    "samples.nc",
    "surrogate.nc",
    "bounds.nc",
    "sensitivities.nc",
]


def campaign_results():
    """The files that a campaign leaves for its reader."""
    return CAMPAIGN.results()


def sections(*names):
    """Sections of the config as JSON; a rule with them as `params` runs again when they change."""
    return CAMPAIGN.sections_json(*names)


def batch_count(wildcards):
    """Number of batches that the runs of a stage are shared among."""
    if not CAMPAIGN.is_adaptive:
        return CAMPAIGN.batch_count()
    number = wildcards.stage.rsplit("/", 1)[1]
    plan = checkpoints.plan_round.get(campaign=CAMPAIGN.name, round=number).output[0]
    return CAMPAIGN.batch_count(plan)


def batches(wildcards):
    """The manifests of all batches of a stage."""
    return [
        f"{wildcards.stage}/batches/{batch}.json"
        for batch in range(batch_count(wildcards))
    ]


def previous_round(wildcards):
    """The files of the round before, which decide about this one; none for the first."""
    number = int(wildcards.round)
    folder = f"results/{wildcards.campaign}/rounds/{number - 1}"
    names = ["nodes.json", "samples.nc", "bounds.nc"]
    return [f"{folder}/{name}" for name in names] if number else []


def last_round(wildcards):
    """The files of the last round, and its plan with the reason to stop."""
    number = 0
    while True:
        plan = checkpoints.plan_round.get(
            campaign=wildcards.campaign, round=number
        ).output[0]
        if CAMPAIGN.is_last(plan):
            folder = f"results/{wildcards.campaign}/rounds/{number - 1}"
            return [plan, *(f"{folder}/{name}" for name in ROUND_FILES[1:])]
        number += 1
