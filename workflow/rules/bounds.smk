# From samples to a surrogate, to bounds (which may be a spline's), and to what each parameter contributes.


rule bounds:
    input:
        "{stage}/nodes.json",
        "{stage}/samples.nc",
    output:
        "{stage}/surrogate.nc",
        "{stage}/bounds.nc",
        "{stage}/sensitivities.nc",
    log:
        "{stage}/logs/bounds.log",
    wildcard_constraints:
        stage=WORKFLOW.run_stage,
    priority: 1  # most jobs wait for it
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("bounds"),
        code=code("bounds"),
    message:
        "Fitting the surrogate and taking its bounds"
    shell:
        "python -P -m deployable bounds {params.folder:q} --config {params.config:q} --log {log:q}"
