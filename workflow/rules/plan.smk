# Which runs there are, and the time step that serves them all.


rule plan:
    input:
        no_files,
    output:
        WORKFLOW.outputs("plan"),
    log:
        "{stage}/logs/plan.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=WORKFLOW.sections("plan"),
        code=CODE,
        mechanics=MECHANICS,
    message:
        "Choosing the runs and the time step"
    shell:
        call("plan")


# Trajectories are not listed as outputs: they are named by their content, so that any later design
# and a campaign that was killed find them again. Where jobs share no folder, a bundle carries them.
# A batch has one core, or a process on each of `jobs.processes`.
rule simulate:
    input:
        WORKFLOW.inputs("simulate"),
    output:
        **batch_files(*WORKFLOW.outputs("simulate")),
    log:
        "{stage}/logs/batch-{batch}.log",
    conda:
        ENVIRONMENT
    threads: PROCESSES
    resources:
        runtime=lambda wildcards, input, attempt: attempt * job_minutes(input),
        mem_mb=megabytes,
    params:
        folder=folder_of,
        config=WORKFLOW.sections("simulate"),
        code=CODE,
        batch_count=WORKFLOW.batch_count(),
        bundle=lambda wildcards, output: (
            f"--bundle {quote(output.bundle)}" if IS_APART else ""
        ),
    message:
        "Simulating batch {wildcards.batch}"
    shell:
        call(
            "simulate",
            "--batch {wildcards.batch} --batches {params.batch_count}",
            "--processes {threads} {params.bundle}",
        )


# Gathers the responses, fits the surrogate, and takes its bounds, which may be a spline's.
rule bounds:
    input:
        nodes=WORKFLOW.inputs("bounds"),
        batches=batches("json"),
        bundles=batches("tar") if IS_APART else [],
    output:
        WORKFLOW.outputs("bounds"),
    log:
        "{stage}/logs/bounds.log",
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=WORKFLOW.sections("bounds"),
        code=CODE,
    message:
        "Gathering the responses and taking their bounds"
    shell:
        call("bounds", "--bundles {input.bundles:q}")
