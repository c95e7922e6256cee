"""Keeps the quick tests quick: none compiles the kinds of element that take long. Runs a shipped
campaign once, whichever tests ask for it."""

from __future__ import annotations

import fcntl
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import netCDF4
import pytest

# One thread of linear algebra, as the program has it. Two in each of two processes on two cores
# wait for each other: eigenvalues of 72 degrees of freedom take 0.1 s then, and 0.3 ms with one.
import deployable.__main__  # noqa: F401

COSTLY = {"Joints"}
"""Kinds, by the named tuples of their arrays, that are compiled in 5 to 10 s; others in 1 s."""

_seen: set[str] = set()

_open: WeakKeyDictionary[netCDF4.Dataset, str] = WeakKeyDictionary()


class OpenOnce(netCDF4.Dataset):  # type: ignore[misc]
    """A dataset that is open only once in a process. HDF5 can crash on a second one, with texts:
    https://github.com/Unidata/netcdf-c/issues/2510."""

    __hash__ = object.__hash__

    def __init__(self, path: Any, *arguments: Any, **options: Any) -> None:
        real = os.path.realpath(path)
        assert real not in [of for file, of in _open.items() if file.isopen()], f"{real} is open"
        super().__init__(path, *arguments, **options)
        _open[self] = real


netCDF4.Dataset = OpenOnce


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Fail a quick test that was the first to need the compiled code of a costly kind."""
    compiled = sys.modules.get("fpm.kernels.compiled_loop")
    ready = compiled.READY if compiled else {}
    needed = {getattr(unit, "__name__", unit) for unit, _ in ready} & COSTLY - _seen
    _seen.update(needed)
    if needed and not item.get_closest_marker("slow"):
        pytest.fail(f"needs compiled kernels of {', '.join(sorted(needed))}: mark it slow")


WITH_FIGURES = {"latch", "deploys"}
"""Shipped campaigns of which a test asks what all of it costs."""


@pytest.fixture(scope="session")
def shipped(tmp_path_factory) -> Callable[[str], tuple[Path, float]]:
    """A function that runs a shipped campaign, once for all tests in all processes: its folder of
    results, and the processor time (s) that it took."""
    home = tmp_path_factory.getbasetemp()
    results = (home.parent if "PYTEST_XDIST_WORKER" in os.environ else home) / "shipped"
    results.mkdir(exist_ok=True)

    def run(name: str) -> tuple[Path, float]:
        config = Path(__file__).parents[1] / f"config/{name}.yaml"
        command = [sys.executable, "-m", "deployable", "run", config, "--results", results]
        with open(results / f"{name}.seconds", "a+", encoding="utf-8") as told:
            fcntl.flock(told, fcntl.LOCK_EX)
            told.seek(0)
            if not (seconds := told.read()):
                begun = resource.getrusage(resource.RUSAGE_CHILDREN)
                subprocess.run(command + ["--no-figures"] * (name not in WITH_FIGURES), check=True)
                ended = resource.getrusage(resource.RUSAGE_CHILDREN)
                seconds = str(ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime)
                told.write(seconds)
        return results / name, float(seconds)

    return run


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
