# `accuracy`: rounds of runs until the error is small enough or the budget is spent.
# Each round has a plan of its own; the rules for runs and bounds serve rounds as they serve others.


checkpoint plan_round:
    input:
        previous_round,
    output:
        "results/{campaign}/rounds/{round}/nodes.json",
    log:
        "results/{campaign}/rounds/{round}/logs/plan.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("plan_round"),
        code=code("plan_round"),
        mechanics=WORKFLOW.mechanics,
    message:
        "Choosing the runs of round {wildcards.round}"
    shell:
        "python -P -m deployable plan_round {params.folder:q} --config {params.config:q} --log {log:q}"


rule settle:
    input:
        last_round,
    output:
        [f"results/{{campaign}}/{name}" for name in ROUND_FILES],
    log:
        "results/{campaign}/logs/settle.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
    message:
        "Taking the last round's results"
    shell:
        "cp {input:q} {params.folder:q} 2> {log:q}"
