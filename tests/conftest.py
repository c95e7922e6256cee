"""Keeps the quick tests quick: they share a few time loops, each of which takes 10 to 30 s. Keeps
the slow ones from taking minutes."""

from __future__ import annotations

import resource
import sys
from collections.abc import Iterator

import pytest

from deployable.one_thread import set_environment

# As the program has it. Two threads of linear algebra in each of two processes on two cores wait
# for each other: eigenvalues of 72 degrees of freedom take 0.1 s then, and 0.3 ms with one.
set_environment()

# By the named tuples of their kinds (`fpm.kernels.compiled`).
SHARED = {
    "StraightElements-Openings-Hinges-Springs-Contacts",  # the Bennett linkage
    "StraightElements-Openings-Hinges-Springs",  # a panel on a spring
    "Weight-StraightElements-Openings-Hinges",  # the pendulum
    "StraightElements",  # bars alone
}

LONGEST = 90.0
"""Cpu time (s) of a test, of the processes that it starts and of what it sets up."""

# Tests that may take longer, by their ids without parameters: why nothing shorter proves it.
MAY_TAKE_LONGER: dict[str, str] = {
    "tests/workflow/test_storage.py::test_campaign_runs_through_a_storage": "every job of a whole "
    "campaign starts a Snakemake of its own there, and nothing smaller goes through a storage",
}

_seen: set[str] = set()


def _cpu_time() -> float:
    """Seconds of this process and of those that it has seen end; no neighbour makes them more."""
    who = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, who))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Note when a test begins."""
    item.began = _cpu_time()
    return (yield)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Fail a test that takes too long. What the fixtures of a whole session end is not the last
    test's: a browser's time is only known when it has ended."""
    taken = _cpu_time() - item.began
    if taken > LONGEST and item.nodeid.partition("[")[0] not in MAY_TAKE_LONGER:
        pytest.fail(f"took {taken:.1f} s of cpu time; allowed: {LONGEST:g} s, or a reason")
    _check_loops(item)


def _check_loops(item: pytest.Item) -> None:
    """Fail a quick test that was the first to need another time loop."""
    compiled = sys.modules.get("fpm.kernels.compiled")
    ready = compiled.READY if compiled else ()
    needed = {
        "+".join(["-".join(kind.__name__ for kind in kinds), *more])
        for what, kinds, more, _ in ready
        if what == "loop"
    } - _seen
    _seen.update(needed)
    if (more := needed - SHARED) and not item.get_closest_marker("slow"):
        pytest.fail(f"needs a time loop of its own, {', '.join(sorted(more))}: mark it slow")
