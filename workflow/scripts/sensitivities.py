"""Draw which parameter widens the bounds, and when."""

from pathlib import Path

from script import arguments, run


def work(options, tell):
    from campaign.figures import draw_sensitivities

    draw_sensitivities(options.sensitivities, options.output)


parser = arguments(__doc__)
parser.add_argument("--sensitivities", required=True, help="sensitivities.nc")
parser.add_argument("--output", required=True, type=Path, help="folder for the figure")
run(parser, work)
