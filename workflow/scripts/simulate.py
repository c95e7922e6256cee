"""Simulate one batch of the runs in nodes.json, except those that are there already."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.nodes import read_plan
    from campaign.run import run_batch

    plan = read_plan(options.nodes)
    jobs = sections(options.jobs)["jobs"]
    run_batch(plan, options.batch, options.batches, jobs, options.folder, options.output, tell)


parser = arguments(__doc__)
parser.add_argument("--nodes", required=True, help="nodes.json")
parser.add_argument("--jobs", required=True, help="config with the section `jobs`")
parser.add_argument("--batch", type=int, default=0, help="number of the batch, from 0")
parser.add_argument("--batches", type=int, default=1, help="number of batches")
parser.add_argument("--folder", required=True, help="folder of the trajectories")
parser.add_argument("--output", required=True, help="manifest to write when all runs are there")
run(parser, work)
