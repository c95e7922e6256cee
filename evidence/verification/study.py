"""All problems of the verification suite, what they cost, and what follows from them."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module

import fpm
from evidence import plots
from evidence.results import Report
from evidence.verification.bench import Bench
from evidence.verification.relax import NotAtRest

FAMILIES = (
    "statics",
    "equilibria",
    "vibration",
    "rotation",
    "dynamics",
    "drag",
    "free_flight",
    "joints",
    "forces",
    "latches",
    "motors",
    "pins",
    "rigid_holds",
    "rigid_motors",
    "slides",
    "sliders",
    "curves",
    "mechanisms",
    "squeezer",
    "deployables",
    "cables",
    "bennett",
)

PROBLEMS: dict[str, Callable[[Bench], None]] = {
    name: problem
    for family in FAMILIES
    for name, problem in import_module(f"evidence.verification.{family}").PROBLEMS.items()
}
"""Name of every problem -> its function."""


def solve(name: str, quick: bool) -> Bench:
    """A problem's rows and figures.

    A row that fails is a finding, not an error, and so is a run that breaks down: it leaves a
    failing row. Errors of the problems themselves are raised."""
    bench = Bench(name, quick)
    try:
        PROBLEMS[name](bench)
    except (fpm.InstabilityError, NotAtRest) as error:
        bench.add_failure(error)
    return bench


PARTS = {name: partial(solve, name) for name in PROBLEMS}


def report(results: Mapping[str, Bench]) -> Report:
    """The rows and figures of all problems, what each cost, and an overview."""
    benches = list(results.values())
    costs = {b.problem: {"element_steps": b.element_steps, "cpu": b.cpu} for b in benches}
    steps, cpu = (sum(cost[key] for cost in costs.values()) for key in ("element_steps", "cpu"))
    return Report(
        [row for bench in benches for row in bench.rows],
        {"costs": costs},
        f"\nCost: {steps:.3g} element-steps in {cpu:.1f} s of cpu time.\n",
        {"overview": overview(benches)}
        | {chart.name: chart.figure for bench in benches for chart in bench.figures},
    )


def overview(benches: list[Bench]):
    """How far each row is from its tolerance, and what each problem cost (s of cpu time)."""
    size = (9.6, 0.32 * len(benches) + 1.4)
    figure, (axes, costs) = plots.panels(1, 2, size, sharey=True, width_ratios=(2, 1))
    rows = [row for bench in benches for row in bench.rows]
    plots.draw_utilization(axes, rows, [row.group for row in rows])
    costs.barh(range(len(benches)), [bench.cpu for bench in benches], color=plots.SKY)
    costs.set(xlabel="cpu time (s)")
    return figure
