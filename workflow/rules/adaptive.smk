# `order: auto`: rounds of runs until the error meets the tolerance or the budget is spent.
# Each round has a plan of its own; the rules for runs and bounds serve rounds as they serve others.


checkpoint plan_round:
    input:
        previous_round,
    output:
        "results/{campaign}/rounds/{round}/nodes.json",
    log:
        "results/{campaign}/rounds/{round}/logs/nodes.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections(*CAMPAIGN.RUN_SECTIONS),
        data_version=CAMPAIGN.data_version,
        previous=lambda wildcards, input: (
            Path(input[0]).parent.as_posix() if input else "''"
        ),
    message:
        "Choosing the runs of round {wildcards.round}"
    shell:
        "python workflow/scripts/plan_round.py --config {params.config:q}"
        " --previous {params.previous} --output {output} --log {log}"


rule settle:
    input:
        last_round,
    output:
        [f"results/{{campaign}}/{name}" for name in ROUND_FILES],
    log:
        "results/{campaign}/logs/settle.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Taking the last round's results"
    shell:
        "cp {input} results/{wildcards.campaign} 2> {log}"
