# Which runs there are, and the time step that serves them all.


rule plan:
    input:
        no_files,
    output:
        "{stage}/nodes.json",
    log:
        "{stage}/logs/plan.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("plan"),
        code=code("plan"),
        mechanics=WORKFLOW.mechanics,
    message:
        "Choosing the runs and the time step"
    shell:
        "python -P -m deployable plan {params.folder:q} --config {params.config:q} --log {log:q}"
