# Studies of the program itself: verification, extremes, benchmark, tradeoff.
# Each leaves results/<target>/summary.json, a table and plots.

# A study runs again when the code that it judges changes.
STUDIED_CODE = sorted(
    str(file)
    for package in ["fpm", "verification"]
    for file in Path(workflow.basedir).glob(f"{package}/**/*.py")
)


# Rows that fail stay in the summary and the table; the rule fails only if the suite itself does.
rule verification:
    input:
        STUDIED_CODE,
    output:
        "results/verification/summary.json",
        "results/verification/table.md",
    log:
        "results/verification/verification.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Comparing the solver with closed forms and published results"
    shell:
        "python -m verification --output results/verification 2>&1 | tee {log}"


rule calibration:
    input:
        STUDIED_CODE,
        sorted(str(f) for f in Path(workflow.basedir).glob("intervals/*.py")),
        collect(
            str(Path(workflow.basedir, "studies", "calibration{part}.py")),
            part=["", "_report", "_figures"],
        ),
    output:
        "results/calibration/summary.json",
        "results/calibration/table.md",
        collect(
            "results/calibration/{plot}.{kind}",
            plot=["numbers", "misfit", "closures"],
            kind=["png", "pdf"],
        ),
    log:
        "results/calibration/calibration.log",
    conda:
        "../envs/campaign.yaml"
    threads: 2
    message:
        "Fitting K_F to the paper's two numbers"
    shell:
        "python -m studies.calibration --output results/calibration --workers {threads}"
        " > {log} 2>&1"


# Timed, so it asks for more cores than there are and gets all of them (`workflow.cores` would make
# `--unlock` and `--report` ask for `-c` too); `--force benchmark` repeats it on unchanged code.
rule benchmark:
    input:
        sorted(
            str(f)
            for package in ["fpm", "benchmark"]
            for f in Path(workflow.basedir).glob(f"{package}/**/*.py")
        ),
    output:
        "results/benchmark/summary.json",
        "results/benchmark/table.md",
        "results/benchmark/benchmark.png",
    log:
        "results/benchmark/benchmark.log",
    conda:
        "../envs/campaign.yaml"
    threads: 1024
    message:
        "Measuring the solver, the workflow and, where they are installed, peers"
    shell:
        "python -m benchmark --output results/benchmark > {log} 2>&1"


# Each case and the peers are measured by one process each, so that cpu times are those of one core.
TRADEOFF = ["three", "one", "spring", "smooth"]


rule tradeoff:
    input:
        cases=collect("results/tradeoff/cases/{case}.json", case=[*TRADEOFF, "peers"]),
        code=[
            str(Path(workflow.basedir, "studies", f"{name}.py"))
            for name in [
                "rows",
                "tradeoff_presets",
                "tradeoff_report",
                "tradeoff_rows",
            ]
        ],
    output:
        "results/tradeoff/summary.json",
        "results/tradeoff/table.md",
        collect("results/tradeoff/pareto_{case}.png", case=TRADEOFF),
    log:
        "results/tradeoff/logs/report.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Putting error against cost"
    shell:
        "python -m studies.tradeoff report {input.cases} --output results/tradeoff > {log} 2>&1"


rule tradeoff_case:
    input:
        sorted(
            str(f)
            for package in ["fpm", "intervals"]
            for f in Path(workflow.basedir).glob(f"{package}/**/*.py")
        ),
        [
            str(Path(workflow.basedir, "studies", f"tradeoff{part}.py"))
            for part in [
                "",
                "_bounds",
                "_cases",
                "_points",
                "_presets",
                "_reference",
                "_runs",
            ]
        ],
        str(Path(workflow.basedir, "campaign", "presets.py")),
    output:
        "results/tradeoff/cases/{case}.json",
    log:
        "results/tradeoff/logs/{case}.log",
    wildcard_constraints:
        case="|".join(TRADEOFF),
    conda:
        "../envs/campaign.yaml"
    message:
        "Measuring error against cost, case {wildcards.case}"
    shell:
        "python -m studies.tradeoff case {wildcards.case} --output {output} > {log} 2>&1"


# Peers that are not installed become skipped rows; docs/tradeoff.md tells how to name theirs.
rule tradeoff_peers:
    input:
        sorted(
            str(f)
            for package in ["fpm", "intervals"]
            for f in Path(workflow.basedir).glob(f"{package}/**/*.py")
        ),
        [
            str(Path(workflow.basedir, "studies", f"tradeoff{part}.py"))
            for part in ["_cases", "_peer", "_peers", "_points", "_runs"]
        ],
    output:
        "results/tradeoff/cases/peers.json",
    log:
        "results/tradeoff/logs/peers.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Measuring peers on the same runs"
    shell:
        "python -m studies.tradeoff peers --output {output} > {log} 2>&1"


rule extremes:
    input:
        STUDIED_CODE,
        sorted(str(f) for f in Path(workflow.basedir).glob("intervals/*.py")),
        collect(
            str(Path(workflow.basedir, "studies", "{part}.py")),
            part=[
                "extremes",
                "extreme_parameters",
                "extreme_runs",
                "judge",
                "linkage",
                "rows",
                "stable_step",
                "true_limit",
            ],
        ),
    output:
        "results/extremes/summary.json",
        "results/extremes/table.md",
        collect(
            "results/extremes/{plot}.{kind}",
            plot=["stable-step", "errors"],
            kind=["png", "pdf"],
        ),
    log:
        "results/extremes/extremes.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Running the linkage at the ends of its parameters' ranges"
    shell:
        "python -m studies.extremes --output results/extremes > {log} 2>&1"


rule accuracy:
    input:
        STUDIED_CODE,
        collect(
            str(Path(workflow.basedir, "studies", "{part}.py")),
            part=["accuracy", "linkage", "rows"],
        ),
    output:
        "results/accuracy/summary.json",
        "results/accuracy/table.md",
        "results/accuracy/choices.md",
        collect("results/accuracy/errors.{kind}", kind=["png", "pdf"]),
    log:
        "results/accuracy/accuracy.log",
    conda:
        "../envs/campaign.yaml"
    message:
        "Measuring what meshes, steps and lumpings cost and get wrong"
    shell:
        "python -m studies.accuracy --output results/accuracy > {log} 2>&1"
