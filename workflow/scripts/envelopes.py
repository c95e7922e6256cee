"""Draw each response with its bounds and the nominal run."""

from pathlib import Path

from script import arguments, run, sections


def work(options, tell):
    from campaign.figures import draw_envelopes

    draw_envelopes(options.bounds, sections(options.config), options.output)


parser = arguments(__doc__)
parser.add_argument("--bounds", required=True, help="bounds.nc")
parser.add_argument("--config", required=True, help="config with the section `error`")
parser.add_argument("--output", required=True, type=Path, help="folder for the figures")
run(parser, work)
