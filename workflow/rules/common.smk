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
    stage=f"results/{CAMPAIGN.name}",
    batch=r"\d+",


def campaign_results():
    """The files that a campaign leaves for its reader."""
    return CAMPAIGN.results()


def sections(*names):
    """Sections of the config as JSON; a rule that has them as `params` runs again when they change."""
    return CAMPAIGN.sections_json(*names)


def batches(wildcards):
    """The manifests of all batches of runs."""
    return [
        f"{wildcards.stage}/batches/{batch}.json"
        for batch in range(CAMPAIGN.batch_count())
    ]
