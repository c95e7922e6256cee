"""Fit the surrogate to samples.nc and take its bounds."""

from script import arguments, run


def work(options, tell):
    from campaign.analyse import analyse

    analyse(options.samples, options.surrogate, options.bounds)


parser = arguments(__doc__)
parser.add_argument("--samples", required=True, help="samples.nc")
parser.add_argument("--surrogate", required=True, help="surrogate.nc to write")
parser.add_argument("--bounds", required=True, help="bounds.nc to write")
run(parser, work)
