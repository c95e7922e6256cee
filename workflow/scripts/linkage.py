"""Draw the structure at some moments of the nominal run."""

from pathlib import Path

from script import arguments, run, sections


def work(options, tell):
    from campaign.linkage import draw_nominal

    draw_nominal(options.samples, options.folder, sections(options.config), options.output)


parser = arguments(__doc__)
parser.add_argument("--samples", required=True, help="samples.nc")
parser.add_argument("--folder", required=True, type=Path, help="folder of the trajectories")
parser.add_argument("--config", required=True, help="config with the section `figures`")
parser.add_argument("--output", required=True, type=Path, help="folder for the figures")
run(parser, work)
