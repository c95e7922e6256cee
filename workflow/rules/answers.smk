# Intervals of quantities, requirements and choices, with the runs that they take; the summary.


rule answers:
    input:
        [f"{{stage}}/{name}" for name in ("plan.json", "samples.nc", "bounds.nc")],
    output:
        report(
            "{stage}/summary.md",
            caption="../report/summary.rst",
            category="Summary",
        ),
        [name for name in WORKFLOW.answers("{stage}") if not name.endswith(".md")],
    log:
        "{stage}/logs/answers.log",
    priority: 1  # the page waits for it
    conda:
        ENVIRONMENT
    threads: WORKFLOW.processes
    resources:
        runtime=minutes,
        mem_mb=megabytes,
    params:
        folder=folder_of,
        config=sections("answers"),
        code=CODE,
    message:
        "Finding what the campaign asks for, and summing up"
    shell:
        "python -P -m deployable answers {params.folder:q} --config {params.config:q}"
        " --threads {threads} --log {log:q}"
