# From samples to a surrogate, to bounds (which may be a spline's), and to what each parameter contributes.


rule bounds:
    input:
        "{stage}/samples.nc",
    output:
        surrogate="{stage}/surrogate.nc",
        bounds="{stage}/bounds.nc",
        sensitivities="{stage}/sensitivities.nc",
    log:
        "{stage}/logs/bounds.log",
    wildcard_constraints:
        stage=CAMPAIGN.run_stage,
    priority: 1  # most jobs wait for it
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("bounds"),
    message:
        "Fitting the surrogate and taking its bounds"
    shell:
        "python workflow/scripts/bounds.py --samples {input} --config {params.config:q}"
        " --surrogate {output.surrogate} --bounds {output.bounds}"
        " --sensitivities {output.sensitivities} --log {log}"
