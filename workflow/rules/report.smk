# Figures, headline numbers, and the page.


rule envelopes:
    input:
        "{stage}/bounds.nc",
    output:
        report(
            WORKFLOW.envelope_figures("{stage}", "png"),
            caption="../report/envelope.rst",
            category="Bounds",
        ),
        WORKFLOW.envelope_figures("{stage}", "pdf", "svg"),
    log:
        "{stage}/logs/envelopes.log",
    priority: 1
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("envelopes"),
        code=code("envelopes"),
    message:
        "Drawing the envelopes"
    shell:
        "python -P -m deployable envelopes {params.folder:q} --config {params.config:q} --log {log:q}"


rule sensitivities:
    input:
        "{stage}/sensitivities.nc",
    output:
        report(
            "{stage}/figures/campaign/sensitivities.png",
            caption="../report/sensitivities.rst",
            category="Parameters",
        ),
        WORKFLOW.overview("{stage}", "sensitivities")[1:],
    log:
        "{stage}/logs/sensitivities.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        code=code("sensitivities"),
    message:
        "Drawing which parameter matters when"
    shell:
        "python -P -m deployable sensitivities {params.folder:q} --log {log:q}"


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
        WORKFLOW.overview("{stage}", "ranges")[1:],
    log:
        "{stage}/logs/ranges.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        code=code("ranges"),
    message:
        "Drawing the quantities over the box"
    shell:
        "python -P -m deployable ranges {params.folder:q} --log {log:q}"


rule alternatives:
    input:
        "{stage}/choice.json",
    output:
        report(
            "{stage}/figures/campaign/alternatives.png",
            caption="../report/alternatives.rst",
            category="Parameters",
        ),
        WORKFLOW.overview("{stage}", "alternatives")[1:],
    log:
        "{stage}/logs/alternatives.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        code=code("alternatives"),
    message:
        "Drawing the choices that were tried"
    shell:
        "python -P -m deployable alternatives {params.folder:q} --log {log:q}"


rule moments:
    input:
        "{stage}/samples.nc",
        "{stage}/report.html",  # with the motion that is drawn
    output:
        report(
            "{stage}/figures/campaign/moments.png",
            caption="../report/moments.rst",
            category="Structure",
        ),
        WORKFLOW.overview("{stage}", "moments")[1:],
    log:
        "{stage}/logs/moments.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("moments"),
        code=code("moments"),
    message:
        "Drawing the structure"
    shell:
        "python -P -m deployable moments {params.folder:q} --config {params.config:q} --log {log:q}"


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
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("summary"),
        code=code("summary"),
    message:
        "Summing up"
    shell:
        "python -P -m deployable summary {params.folder:q} --config {params.config:q} --log {log:q}"


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
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        code=code("report"),
    message:
        "Making the page"
    shell:
        "python -P -m deployable report {params.folder:q} --log {log:q}"
