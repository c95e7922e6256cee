# Runs and bounds in one job, of a campaign of one batch; with an `accuracy` in rounds, until the error
# is small enough or the budget is spent: each round decides about the next. Runs that were made are
# found again.

if WORKFLOW.campaign.experiment.is_adaptive:
    STAGE_NAMES, OPTION = ["rounds"], ""
else:
    STAGE_NAMES, OPTION = ["plan", "simulate", "bounds"], "--since plan"


rule bounds:
    input:
        no_files,
    output:
        [
            path.replace("{batch}", "0")
            for x in STAGE_NAMES
            for path in WORKFLOW.outputs(x)
        ],
    log:
        "{stage}/logs/bounds.log",
    conda:
        ENVIRONMENT
    threads: max(PROCESSES, workflow.cores or 1)
    resources:
        runtime=minutes,
        mem_mb=megabytes,
    params:
        folder=folder_of,
        config=WORKFLOW.sections(*STAGE_NAMES),
        code=CODE,
        mechanics=MECHANICS,
    message:
        "Making the runs and taking their bounds"
    shell:
        call(STAGE_NAMES[-1], OPTION, "--threads {threads}")
