# Intervals of quantities, requirements and choices. The runs that they take are made here, through
# the store of all others.


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
        ENVIRONMENT
    threads: WORKFLOW.processes
    resources:
        runtime=lambda wildcards, attempt: attempt * WORKFLOW.minutes(),
        mem_mb=lambda wildcards, attempt: attempt * WORKFLOW.megabytes(),
    params:
        folder=folder_of,
        config=sections("quantities"),
        code=code("quantities"),
    message:
        "Finding and verifying the intervals of the quantities"
    shell:
        "python -P -m deployable quantities {params.folder:q} --config {params.config:q}"
        " --threads {threads} --log {log:q}"


rule requirements:
    input:
        "{stage}/nodes.json",
        "{stage}/samples.nc",
        "{stage}/further.nc",
    output:
        "{stage}/requirements.json",
    log:
        "{stage}/logs/requirements.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("requirements"),
        code=code("requirements"),
    message:
        "Judging the requirements"
    shell:
        "python -P -m deployable requirements {params.folder:q} --config {params.config:q} --log {log:q}"


rule choice:
    input:
        "{stage}/nodes.json",
    output:
        "{stage}/choice.json",
    log:
        "{stage}/logs/choice.log",
    conda:
        ENVIRONMENT
    threads: WORKFLOW.processes
    resources:
        runtime=lambda wildcards, attempt: attempt * WORKFLOW.minutes(),
        mem_mb=lambda wildcards, attempt: attempt * WORKFLOW.megabytes(),
    params:
        folder=folder_of,
        config=sections("choice"),
        code=code("choice"),
    message:
        "Finding the best choice"
    shell:
        "python -P -m deployable choice {params.folder:q} --config {params.config:q}"
        " --threads {threads} --log {log:q}"
