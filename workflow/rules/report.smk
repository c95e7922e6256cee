# Figures and headline numbers.


rule envelopes:
    input:
        "{stage}/bounds.nc",
    output:
        CAMPAIGN.envelope_figures("{stage}"),
    log:
        "{stage}/logs/envelopes.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("error"),
        folder=lambda wildcards: f"{wildcards.stage}/figures",
    message:
        "Drawing the envelopes"
    shell:
        "python workflow/scripts/envelopes.py --bounds {input} --config {params.config:q}"
        " --output {params.folder} --log {log}"


rule sensitivities:
    input:
        "{stage}/sensitivities.nc",
    output:
        "{stage}/figures/sensitivities.png",
        "{stage}/figures/sensitivities.pdf",
    log:
        "{stage}/logs/sensitivities.log",
    conda:
        "../envs/campaign.yaml"
    params:
        folder=lambda wildcards: f"{wildcards.stage}/figures",
    message:
        "Drawing which parameter matters when"
    shell:
        "python workflow/scripts/sensitivities.py --sensitivities {input}"
        " --output {params.folder} --log {log}"


rule linkage:
    input:
        "{stage}/samples.nc",
    output:
        "{stage}/figures/linkage.png",
        "{stage}/figures/linkage.pdf",
    log:
        "{stage}/logs/linkage.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("figures"),
        store=CAMPAIGN.store_folder(),
        folder=lambda wildcards: f"{wildcards.stage}/figures",
    message:
        "Drawing the structure"
    shell:
        "python workflow/scripts/linkage.py --samples {input} --folder {params.store}"
        " --config {params.config:q} --output {params.folder} --log {log}"


rule summary:
    input:
        bounds="{stage}/bounds.nc",
        samples="{stage}/samples.nc",
        nodes="{stage}/nodes.json",
    output:
        json="{stage}/summary.json",
        text="{stage}/summary.md",
    log:
        "{stage}/logs/summary.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("published"),
    message:
        "Summing up"
    shell:
        "python workflow/scripts/summary.py --bounds {input.bounds} --samples {input.samples}"
        " --nodes {input.nodes} --config {params.config:q} --json {output.json} --text {output.text} --log {log}"
