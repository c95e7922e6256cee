# Bounds of a deployable structure's responses over interval parameters.
#
#     snakemake -c2                                     the paper's campaign
#     snakemake -c2 --configfile config/three.yaml      another campaign

from snakemake.utils import min_version

min_version("8.11")


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: WORKFLOW.plan_rules
include: "workflow/rules/runs.smk"
include: "workflow/rules/bounds.smk"
include: "workflow/rules/answers.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/studies.smk"


rule all:
    default_target: True
    input:
        campaign_results(),


# What the page says first, and which file to open.
onsuccess:
    if not workflow.dag_settings.targets:
        print(WORKFLOW.last_words())
