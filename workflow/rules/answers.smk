# Intervals of quantities. The runs that verify them are made here, through the store of all others.


rule quantities:
    input:
        "{stage}/nodes.json",
        "{stage}/samples.nc",
    output:
        "{stage}/quantities.nc",
        "{stage}/further.nc",
    log:
        "{stage}/logs/quantities.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("quantities"),
        code=code("quantities"),
    message:
        "Finding and verifying the intervals of the quantities"
    shell:
        "python -m campaign quantities {wildcards.stage} --config {params.config:q} --log {log}"
