# Figures and headline numbers.


rule envelopes:
    input:
        "{stage}/bounds.nc",
    output:
        report(
            CAMPAIGN.envelope_figures("{stage}"),
            caption="../report/envelope.rst",
            category="Bounds",
        ),
    log:
        "{stage}/logs/envelopes.log",
    priority: 1  # the longest of the last jobs
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
        report(
            "{stage}/figures/sensitivities.png",
            caption="../report/sensitivities.rst",
            category="Parameters",
        ),
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
        report(
            "{stage}/figures/linkage.png",
            caption="../report/linkage.rst",
            category="Structure",
        ),
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
        text=report(
            "{stage}/summary.md",
            caption="../report/summary.rst",
            category="Summary",
        ),
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
