"""All problems of the verification suite, what they cost, and what follows from them."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module

import fpm
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
    """A problem's rows.

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
    """The rows of all problems, and what each cost."""
    benches = list(results.values())
    costs = {b.problem: {"element_steps": b.element_steps, "cpu": b.cpu} for b in benches}
    steps, cpu = (sum(cost[key] for cost in costs.values()) for key in ("element_steps", "cpu"))
    return Report(
        [row for bench in benches for row in bench.rows],
        {"costs": costs},
        f"\nCost: {steps:.3g} element-steps in {cpu:.1f} s of cpu time.\n",
    )
