# All of a campaign but the rule that asks for it, which each Snakefile has itself: an included one
# would not be the default.

import threading

from snakemake.utils import min_version

min_version("9.15")


report: "../report/workflow.rst"


include: "common.smk"


if WORKFLOW.cases:

    include: "cases.smk"

else:

    include: "bounds.smk" if WORKFLOW.is_one_job() else "plan.smk"
    include: "answers.smk"
    include: "report.smk"


# The answer, and which file to open. Snakemake's timers, at which it would look whether more jobs may
# start, would hold its end up for a second.
onsuccess:
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()
    if not workflow.dag_settings.targets:
        print("", *WORKFLOW.answer(), sep="\n")
