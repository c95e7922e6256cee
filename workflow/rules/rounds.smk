# `accuracy`: rounds of runs until the error is small enough or the budget is spent, in one job: each
# round decides about the next. Runs that were made are found again.


rule rounds:
    input:
        no_files,
    output:
        WORKFLOW.outputs("rounds"),
    log:
        "{stage}/logs/rounds.log",
    conda:
        ENVIRONMENT
    threads: max(PROCESSES, workflow.cores or 1)
    resources:
        runtime=minutes,
        mem_mb=megabytes,
    params:
        folder=folder_of,
        config=WORKFLOW.sections("rounds"),
        code=CODE,
        mechanics=MECHANICS,
    message:
        "Making runs until the accuracy is met"
    shell:
        call("rounds", "--threads {threads}")
