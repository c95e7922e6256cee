"""Keeps the quick tests quick: none compiles the kinds of element that take long."""

from __future__ import annotations

import os
import sys

import pytest

# One thread of linear algebra, as the program has it. Two in each of two processes on two cores
# wait for each other: eigenvalues of 72 degrees of freedom take 0.1 s then, and 0.3 ms with one.
import deployable.__main__  # noqa: F401

COSTLY = {"Joints"}
"""Kinds, by the named tuples of their arrays, that are compiled in 5 to 10 s; others in 1 s."""

_seen: set[str] = set()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Fail a quick test that was the first to need the compiled code of a costly kind."""
    compiled = sys.modules.get("fpm.kernels.compiled_loop")
    ready = compiled.READY if compiled else {}
    needed = {getattr(unit, "__name__", unit) for unit, _ in ready} & COSTLY - _seen
    _seen.update(needed)
    if needed and not item.get_closest_marker("slow"):
        pytest.fail(f"needs compiled kernels of {', '.join(sorted(needed))}: mark it slow")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item):
    return _installed((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector):
    return _installed((yield))


ABSENT = "not installed", "in the extra", "could not import"
LEFT_OUT = "is not set"
"""What CI does not install: peers that need environments of their own, which variables name."""


def _installed(report):
    """With MAY_SKIP=no, as CI has it, a test that is skipped for what could be installed fails."""
    if report.skipped and isinstance(report.longrepr, tuple) and os.environ.get("MAY_SKIP") == "no":
        reason = report.longrepr[2]
        if any(a in reason for a in ABSENT) and LEFT_OUT not in reason:
            report.outcome, report.longrepr = "failed", f"{reason}: CI has to install it"
    return report
