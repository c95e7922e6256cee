# Figures, and the page.


rule figures:
    input:
        WORKFLOW.inputs("figures"),
    output:
        report(
            WORKFLOW.outputs("figures", ".png"),
            caption="../report/figures.rst",
            category="Figures",
        ),
        WORKFLOW.outputs("figures", ".pdf"),
    log:
        "{stage}/logs/figures.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=WORKFLOW.sections("figures"),
        code=CODE,
    message:
        "Drawing the figures"
    shell:
        call("figures")


rule page:
    input:
        WORKFLOW.inputs("page"),
    output:
        report(
            WORKFLOW.outputs("page", ".html"),
            caption="../report/page.rst",
            category="Summary",
        ),
        report(
            WORKFLOW.outputs("page", ".png"),
            caption="../report/moments.rst",
            category="Figures",
        ),
        WORKFLOW.outputs("page", ".pdf"),
    log:
        "{stage}/logs/page.log",
    priority: 1  # the longest of the last jobs
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=WORKFLOW.sections("page"),
        code=CODE,
    message:
        "Making the page"
    shell:
        call("page")
