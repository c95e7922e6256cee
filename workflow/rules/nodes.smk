# Which runs there are, and the time step that serves them all.


rule nodes:
    output:
        "{stage}/nodes.json",
    log:
        "{stage}/logs/nodes.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections(*CAMPAIGN.RUN_SECTIONS),
        data_version=CAMPAIGN.data_version,
    message:
        "Choosing the runs and the time step"
    shell:
        "python workflow/scripts/nodes.py --config {params.config:q} --output {output} --log {log}"
