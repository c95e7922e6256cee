# Bounds of a deployable structure's responses over interval parameters.
#
#     snakemake -c2                                     the paper's campaign
#     snakemake -c2 --configfile config/three.yaml      another campaign
#     snakemake -c2 verification                        a study of the program itself


include: "workflow/rules/campaign.smk"
include: "workflow/rules/studies.smk"


rule all:
    default_target: True
    input:
        campaign_results(),
    localrule: True
