# All of a campaign but the rule that asks for it, which each Snakefile has itself: an included one
# would not be the default.

import threading

from snakemake.utils import min_version

min_version("9.15")


report: "../report/workflow.rst"


include: "common.smk"
include: WORKFLOW.plan_rules
include: "runs.smk"
include: "bounds.smk"
include: "answers.smk"
include: "report.smk"


# What the page says first, and which file to open. Snakemake would end a second after its last job
# has begun, when the timer of its limit of jobs a second runs out: nothing is left to be limited.
onsuccess:
    for thread in threading.enumerate():
        if (
            isinstance(thread, threading.Timer)
            and "snakemake." in thread.function.__module__
        ):
            thread.cancel()
    if not workflow.dag_settings.targets:
        print(WORKFLOW.last_words())
