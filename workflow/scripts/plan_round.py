"""Choose the runs of the next round of an adaptive campaign, or say why it ends."""

from pathlib import Path

from script import arguments, run, sections


def work(options, tell):
    from campaign.adaptive import first_plan, is_finished, next_plan
    from campaign.nodes import read_plan, unique_runs, write_plan

    config = sections(options.config)
    if options.previous:
        folder = Path(options.previous)
        before = read_plan(folder / "nodes.json")
        plan = next_plan(config, before, folder / "samples.nc", folder / "bounds.nc")
        tell(f"{plan['campaign']}: {plan['adaptive']['rounds'][-1]['reason']}")
    else:
        plan = first_plan(config)
    write_plan(plan, options.output)
    if not is_finished(plan):
        order = plan["config"]["design"]["order"]
        tell(f"{plan['campaign']}: {len(unique_runs(plan))} runs of order {order}")


parser = arguments(__doc__)
parser.add_argument("--config", required=True, help="YAML file, or JSON")
parser.add_argument("--previous", default="", help="folder of the round before, if there is one")
parser.add_argument("--output", required=True, help="nodes.json to write")
run(parser, work)
