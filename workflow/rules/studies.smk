# Evidence about the program itself; evidence/registry.py says what each study needs and leaves:
# results/<study>/summary.json and a table. Rows that fail stay in both; a rule fails only if
# its study itself does. A study runs again when the syntax of the code that it judges has changed.

from evidence.registry import STUDIES


# Parts are measured by a process each, side by side, so that their cpu times are those of one core.
rule study_part:
    output:
        "results/{study}/parts/{part}.json",
    log:
        "results/{study}/logs/{part}.log",
    wildcard_constraints:
        study="|".join(STUDIES),
        part="[^/]+",
    conda:
        ENVIRONMENT
    params:
        code=lambda wildcards: STUDIES[wildcards.study].measuring_code(),
    message:
        "Measuring {wildcards.part} for {wildcards.study}"
    shell:
        "python -m evidence {wildcards.study} --part {wildcards.part}"
        " --output results/{wildcards.study} > {log} 2>&1"


# One rule for each study, of its name: `snakemake -c2 verification`. Those that time things ask for
# more cores than there are and get all of them (`workflow.cores` would make `--unlock` and
# `--report` ask for `-c` too); `--force benchmark` repeats one on unchanged code.
for study in STUDIES.values():

    rule:
        name:
            study.name
        input:
            collect(
                "results/{study}/parts/{part}.json", study=study.name, part=study.parts
            ),
        output:
            collect(
                "results/{study}/{file}",
                study=study.name,
                file=["summary.json", "table.md"],
            ),
        log:
            f"results/{study.name}/logs/report.log",
        conda:
            ENVIRONMENT
        threads: 1024 if study.exclusive else 1
        params:
            call=f"{study.name} --output results/{study.name}"
            + (" --measured" if study.parts else ""),
            code=lambda wildcards, study=study: study.code(),
        message:
            study.text
        shell:
            "python -m evidence {params.call} > {log} 2>&1"
