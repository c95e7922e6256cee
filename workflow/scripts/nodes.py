"""Choose the runs of a campaign and the time step that serves them all."""

from script import arguments, run, sections


def work(options, tell):
    from campaign.nodes import make_plan, unique_runs, write_plan

    plan = make_plan(sections(options.config))
    write_plan(plan, options.output)
    tell(
        f"{plan['campaign']}: {len(unique_runs(plan))} runs, step {plan['step']:.4g} s "
        f"({plan['step'] / plan['step_limit']:.0%} of the limit, set by {plan['limiting_element']})"
    )


parser = arguments(__doc__)
parser.add_argument("--config", required=True, help="YAML file, or JSON")
parser.add_argument("--output", required=True, help="nodes.json to write")
run(parser, work)
