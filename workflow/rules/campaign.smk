# All of a campaign but the rule that asks for it, which each Snakefile has itself: an included one
# would not be the default.

from snakemake.utils import min_version

min_version("9.15")


report: "../report/workflow.rst"


include: "common.smk"


if WORKFLOW.cases:

    include: "cases.smk"

else:

    include: "rounds.smk" if WORKFLOW.campaign.experiment.is_sought else "plan.smk"
    include: "answers.smk"
    include: "report.smk"


# Which file to open.
onsuccess:
    if not workflow.dag_settings.targets:
        print(WORKFLOW.last_log())
