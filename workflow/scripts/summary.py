"""Write the headline numbers as JSON and as a table for people."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.summary import summarise

    text = summarise(
        options.bounds,
        options.samples,
        options.nodes,
        sections(options.config),
        options.json,
        options.text,
    )
    tell(text)


parser = arguments(__doc__)
parser.add_argument("--bounds", required=True, help="bounds.nc")
parser.add_argument("--samples", required=True, help="samples.nc")
parser.add_argument("--nodes", required=True, help="nodes.json")
parser.add_argument("--config", required=True, help="config with the section `published`")
parser.add_argument("--json", required=True, help="summary.json to write")
parser.add_argument("--text", required=True, help="summary.md to write")
run(parser, work)
