# Figures, and the page.


rule figures:
    input:
        of_results("{stage}"),
    output:
        report(
            WORKFLOW.figures("{stage}", "png"),
            caption="../report/figures.rst",
            category="Figures",
        ),
        WORKFLOW.figures("{stage}", "pdf", "svg"),
    log:
        "{stage}/logs/figures.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("figures"),
        code=CODE,
    message:
        "Drawing the figures"
    shell:
        "python -P -m deployable figures {params.folder:q} --config {params.config:q} --log {log:q}"


rule page:
    input:
        of_results("{stage}"),
    output:
        report(
            "{stage}/report.html",
            caption="../report/page.rst",
            category="Summary",
        ),
        report(
            "{stage}/figures/campaign/moments.png",
            caption="../report/moments.rst",
            category="Figures",
        ),
        [f"{{stage}}/figures/campaign/moments.{kind}" for kind in ("pdf", "svg")],
    log:
        "{stage}/logs/page.log",
    priority: 1  # the longest of the last jobs
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("page"),
        code=CODE,
    message:
        "Making the page"
    shell:
        "python -P -m deployable page {params.folder:q} --config {params.config:q} --log {log:q}"
