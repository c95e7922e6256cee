"""All problems of the verification suite, and a run of any of them."""

import importlib
import time
from collections.abc import Callable, Iterable

import fpm
from verification.bench import Bench
from verification.relax import NotAtRest

FAMILIES = ("statics", "vibration", "rotation", "dynamics", "joints", "bennett")
"""Modules with the problems, in the order of the table; each has a dictionary PROBLEMS."""


def problems() -> dict[str, Callable[[Bench], None]]:
    """Name of every problem -> its function."""
    found = {}
    for family in FAMILIES:
        found.update(importlib.import_module(f"verification.{family}").PROBLEMS)
    return found


def run(names: Iterable[str] | None = None, quick: bool = False, report=print) -> list[Bench]:
    """Run problems (all by default) and return their benches with rows and figures.

    A row that fails is a finding, not an error, and so is a run that breaks down: it leaves a
    failing row. Errors of the problems themselves are raised.
    report: called with one line per problem as it ends.
    """
    table = problems()
    fpm.warm_up()  # so that no problem is charged for compiling
    benches = []
    for name in table if names is None else names:
        bench, start = Bench(name, quick), time.process_time()
        try:
            table[name](bench)
        except (fpm.InstabilityError, NotAtRest) as error:
            bench.broke(error)
        failed = sum(not row.passed for row in bench.rows)
        report(
            f"{name}: {len(bench.rows)} rows, {failed} failed, "
            f"{time.process_time() - start:.1f} s of cpu time"
        )
        benches.append(bench)
    return benches
