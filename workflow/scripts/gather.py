"""Gather the responses of all runs in nodes.json into samples.nc."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.gather import gather
    from campaign.nodes import read_plan

    plan = read_plan(options.nodes)
    gather(plan, options.batches, sections(options.jobs)["jobs"], options.folder, options.output)


parser = arguments(__doc__)
parser.add_argument("--nodes", required=True, help="nodes.json")
parser.add_argument("--jobs", required=True, help="config with the section `jobs`")
parser.add_argument("--batches", type=int, default=1, help="number of batches")
parser.add_argument("--folder", required=True, help="folder of the trajectories")
parser.add_argument("--output", required=True, help="samples.nc to write")
run(parser, work)
