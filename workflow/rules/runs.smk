# The runs and their responses.


# Trajectories are not listed as outputs: they are named by their content, so that any later design
# and a campaign that was killed find them again. Where jobs share no folder, a bundle carries them.
rule simulate:
    input:
        "{stage}/nodes.json",
    output:
        **batch_files("{stage}/batches/{batch}"),
    log:
        "{stage}/logs/batch-{batch}.log",
    wildcard_constraints:
        stage=WORKFLOW.run_stage,
    conda:
        ENVIRONMENT
    threads: WORKFLOW.processes
    resources:
        runtime=lambda wildcards, input, attempt: attempt
        * job_minutes(wildcards, input),
        mem_mb=lambda wildcards, attempt: attempt * WORKFLOW.megabytes(),
    params:
        folder=folder_of,
        config=sections("simulate"),
        code=code("simulate"),
        batch_count=batch_count,
        bundle=lambda wildcards, output: (
            f"--bundle {quote(output.bundle)}" if IS_APART else ""
        ),
    message:
        "Simulating batch {wildcards.batch}"
    shell:
        "python -P -m deployable simulate {params.folder:q} --config {params.config:q}"
        " --batch {wildcards.batch} --batches {params.batch_count}"
        " --processes {threads} {params.bundle} --log {log:q}"


rule gather:
    input:
        nodes="{stage}/nodes.json",
        batches=batches,
        bundles=bundles,
    output:
        "{stage}/samples.nc",
    log:
        "{stage}/logs/gather.log",
    wildcard_constraints:
        stage=WORKFLOW.run_stage,
    localrule: True
    conda:
        ENVIRONMENT
    params:
        folder=folder_of,
        config=sections("gather"),
        code=code("gather"),
    message:
        "Gathering the responses of all runs"
    shell:
        "python -P -m deployable gather {params.folder:q} --config {params.config:q} --log {log:q}"
        " --bundles {input.bundles:q}"
