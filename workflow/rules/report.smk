# Figures, headline numbers, and the page.


rule envelopes:
    input:
        "{stage}/bounds.nc",
    output:
        report(
            WORKFLOW.envelope_figures("{stage}"),
            caption="../report/envelope.rst",
            category="Bounds",
        ),
    log:
        "{stage}/logs/envelopes.log",
    priority: 1
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("envelopes"),
        code=code("envelopes"),
    message:
        "Drawing the envelopes"
    shell:
        "python -m campaign envelopes {wildcards.stage} --config {params.config:q} --log {log}"


rule sensitivities:
    input:
        "{stage}/sensitivities.nc",
    output:
        report(
            "{stage}/figures/campaign/sensitivities.png",
            caption="../report/sensitivities.rst",
            category="Parameters",
        ),
        "{stage}/figures/campaign/sensitivities.pdf",
    log:
        "{stage}/logs/sensitivities.log",
    conda:
        "../envs/campaign.yaml"
    params:
        code=code("sensitivities"),
    message:
        "Drawing which parameter matters when"
    shell:
        "python -m campaign sensitivities {wildcards.stage} --log {log}"


rule ranges:
    input:
        "{stage}/samples.nc",
        "{stage}/quantities.nc",
        "{stage}/further.nc",
    output:
        report(
            "{stage}/figures/campaign/ranges.png",
            caption="../report/ranges.rst",
            category="Parameters",
        ),
        "{stage}/figures/campaign/ranges.pdf",
    log:
        "{stage}/logs/ranges.log",
    conda:
        "../envs/campaign.yaml"
    params:
        code=code("ranges"),
    message:
        "Drawing the quantities over the box"
    shell:
        "python -m campaign ranges {wildcards.stage} --log {log}"


rule alternatives:
    input:
        "{stage}/choice.json",
    output:
        report(
            "{stage}/figures/campaign/alternatives.png",
            caption="../report/alternatives.rst",
            category="Parameters",
        ),
        "{stage}/figures/campaign/alternatives.pdf",
    log:
        "{stage}/logs/alternatives.log",
    conda:
        "../envs/campaign.yaml"
    params:
        code=code("alternatives"),
    message:
        "Drawing the choices that were tried"
    shell:
        "python -m campaign alternatives {wildcards.stage} --log {log}"


rule linkage:
    input:
        "{stage}/samples.nc",
    output:
        report(
            "{stage}/figures/campaign/linkage.png",
            caption="../report/linkage.rst",
            category="Structure",
        ),
        "{stage}/figures/campaign/linkage.pdf",
    log:
        "{stage}/logs/linkage.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("linkage"),
        code=code("linkage"),
    message:
        "Drawing the structure"
    shell:
        "python -m campaign linkage {wildcards.stage} --config {params.config:q} --log {log}"


rule summary:
    input:
        "{stage}/bounds.nc",
        "{stage}/samples.nc",
        "{stage}/nodes.json",
        WORKFLOW.answers("{stage}"),
    output:
        "{stage}/summary.json",
        report(
            "{stage}/summary.md",
            caption="../report/summary.rst",
            category="Summary",
        ),
    log:
        "{stage}/logs/summary.log",
    priority: 2  # the page waits for it
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("summary"),
        code=code("summary"),
    message:
        "Summing up"
    shell:
        "python -m campaign summary {wildcards.stage} --config {params.config:q} --log {log}"


rule report:
    input:
        "{stage}/bounds.nc",
        "{stage}/samples.nc",
        "{stage}/sensitivities.nc",
        "{stage}/summary.json",
    output:
        report(
            "{stage}/report.html",
            caption="../report/page.rst",
            category="Summary",
        ),
    log:
        "{stage}/logs/report.log",
    priority: 2  # the longest of the last jobs
    conda:
        "../envs/campaign.yaml"
    params:
        code=code("report"),
    message:
        "Making the page"
    shell:
        "python -m campaign report {wildcards.stage} --log {log}"
