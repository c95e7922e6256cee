# The runs and their responses.


# Trajectories are not listed as outputs: they are named by their content, so that any later design
# and a campaign that was killed find them again.
rule simulate:
    input:
        nodes="{stage}/nodes.json",
    output:
        "{stage}/batches/{batch}.json",
    log:
        "{stage}/logs/batch-{batch}.log",
    wildcard_constraints:
        stage=CAMPAIGN.run_stage,
    conda:
        "../envs/campaign.yaml"
    params:
        jobs=sections("jobs"),
        batch_count=batch_count,
        folder=CAMPAIGN.store_folder(),
    message:
        "Simulating batch {wildcards.batch}"
    shell:
        "python workflow/scripts/simulate.py --nodes {input.nodes} --jobs {params.jobs:q}"
        " --batch {wildcards.batch} --batches {params.batch_count} --folder {params.folder}"
        " --output {output} --log {log}"


rule gather:
    input:
        nodes="{stage}/nodes.json",
        batches=batches,
    output:
        "{stage}/samples.nc",
    log:
        "{stage}/logs/gather.log",
    wildcard_constraints:
        stage=CAMPAIGN.run_stage,
    conda:
        "../envs/campaign.yaml"
    params:
        jobs=sections("jobs"),
        batch_count=batch_count,
        folder=CAMPAIGN.store_folder(),
    message:
        "Gathering the responses of all runs"
    shell:
        "python workflow/scripts/gather.py --nodes {input.nodes} --jobs {params.jobs:q}"
        " --batches {params.batch_count} --folder {params.folder} --output {output} --log {log}"
