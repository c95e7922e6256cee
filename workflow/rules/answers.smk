# Intervals of quantities, requirements and choices, with the runs that they take; the summary.


rule answers:
    input:
        WORKFLOW.inputs("answers"),
    output:
        report(
            WORKFLOW.outputs("answers", ".md"),
            caption="../report/summary.rst",
            category="Summary",
        ),
        WORKFLOW.outputs("answers", ".json", ".nc"),
    log:
        "{stage}/logs/answers.log",
    priority: 1  # the page waits for it
    conda:
        ENVIRONMENT
    threads: PROCESSES
    resources:
        runtime=minutes,
        mem_mb=megabytes,
    params:
        folder=folder_of,
        config=WORKFLOW.sections("answers"),
        code=CODE,
    message:
        "Finding what the campaign asks for, and summing up"
    shell:
        call("answers", "--threads {threads}")
