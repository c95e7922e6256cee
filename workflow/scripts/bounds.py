"""Fit the surrogate to samples.nc, take its bounds, and tell which parameter matters."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.analyse import analyse

    analyse(
        options.samples,
        sections(options.config),
        options.surrogate,
        options.bounds,
        options.sensitivities,
    )


parser = arguments(__doc__)
parser.add_argument("--samples", required=True, help="samples.nc")
parser.add_argument("--config", required=True, help="config with the section `bounds`")
parser.add_argument("--surrogate", required=True, help="surrogate.nc to write")
parser.add_argument("--bounds", required=True, help="bounds.nc to write")
parser.add_argument("--sensitivities", required=True, help="sensitivities.nc to write")
run(parser, work)
