# From samples to a surrogate and to bounds.


rule bounds:
    input:
        "{stage}/samples.nc",
    output:
        surrogate="{stage}/surrogate.nc",
        bounds="{stage}/bounds.nc",
    log:
        "{stage}/logs/bounds.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Fitting the surrogate and taking its bounds"
    shell:
        "python workflow/scripts/bounds.py --samples {input} --surrogate {output.surrogate}"
        " --bounds {output.bounds} --log {log}"
