# `cases`: each case is a campaign of its own, by the same rules as a module; what they answer
# together follows from their summaries.

for CASE in WORKFLOW.cases.values():
    CASE_RULES = f"case_{CASE.name}_".replace("-", "_")

    module:
        name: CASE_RULES
        snakefile:
            "../Snakefile"
        config:
            {"workflow": CASE}

    use rule * from CASE_RULES exclude all as CASE_RULES*


rule cases:
    input:
        no_files,
        [path for case in WORKFLOW.cases.values() for path in case.results()],
    output:
        report(
            WORKFLOW.outputs("cases", ".md", ".html"),
            caption="../report/summary.rst",
            category="Summary",
        ),
        WORKFLOW.outputs("cases", ".json"),
    log:
        "{stage}/logs/cases.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=WORKFLOW.sections("cases"),
        code=CODE,
    message:
        "Comparing the cases"
    shell:
        call("cases")
