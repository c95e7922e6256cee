"""Draw the envelopes, the sensitivities and the structure itself."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.figures import draw_all

    draw_all(options.bounds, options.samples, sections(options.config), options.folder)


parser = arguments(__doc__)
parser.add_argument("--bounds", required=True, help="bounds.nc")
parser.add_argument("--samples", required=True, help="samples.nc")
parser.add_argument(
    "--config", required=True, help="config with the sections `error`, `figures`, `scene`"
)
parser.add_argument("--folder", required=True, help="folder for the figures")
run(parser, work)
