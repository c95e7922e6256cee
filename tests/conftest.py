"""Keeps the quick tests quick: they share a few time loops, each of which takes 10 to 30 s."""

from __future__ import annotations

import sys

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

_seen: set[str] = set()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
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
