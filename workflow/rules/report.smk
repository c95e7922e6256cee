# Figures and headline numbers.


rule figures:
    input:
        bounds="{stage}/bounds.nc",
        samples="{stage}/samples.nc",
    output:
        CAMPAIGN.figure_files("{stage}"),
    log:
        "{stage}/logs/figures.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("error", "figures", "scene", "published"),
        folder=lambda wildcards, output: Path(output[0]).parent.as_posix(),
    message:
        "Drawing the figures"
    shell:
        "python workflow/scripts/figures.py --bounds {input.bounds} --samples {input.samples}"
        " --config {params.config:q} --folder {params.folder} --log {log}"


rule summary:
    input:
        bounds="{stage}/bounds.nc",
        samples="{stage}/samples.nc",
    output:
        json="{stage}/summary.json",
        text="{stage}/summary.md",
    log:
        "{stage}/logs/summary.log",
    conda:
        "../envs/campaign.yaml"
    params:
        config=sections("error", "published"),
    message:
        "Summing up"
    shell:
        "python workflow/scripts/summary.py --bounds {input.bounds} --samples {input.samples}"
        " --config {params.config:q} --json {output.json} --text {output.text} --log {log}"
