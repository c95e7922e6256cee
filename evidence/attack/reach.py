"""Which tests run which lines, and how long they take: a plugin of pytest, and what it found.

    pytest -n 0 -p evidence.attack.reach     with REACH=the file to leave

The lines are those of `coverage`, with a context for each test. What a fixture runs that several
tests share counts for the first of them.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGES = ("deployable", "fpm")


@dataclass(frozen=True)
class Reach:
    """`lines`: tests by file and line; `seconds`: what each test takes, its fixtures included."""

    lines: dict[str, dict[str, list[str]]]
    seconds: dict[str, float]

    @classmethod
    def read(cls, path: Path) -> Reach:
        """What the plugin left."""
        return cls(**json.loads(path.read_text(encoding="utf-8")))

    def tests(self, name: str, first: int, last: int) -> list[str]:
        """The tests that run any of these lines of a file, the quick files of tests first; of
        lines that run when the file is imported, those that run anything in it."""
        lines = self.lines.get(name, {})
        found = {test for line in range(first, last + 1) for test in lines.get(str(line), ())}
        found = found or {test for tests in lines.values() for test in tests}
        cost: dict[str, float] = defaultdict(float)
        for test in found:
            cost[test.split("::")[0]] += self.cost(test)
        return sorted(found, key=lambda test: (cost[test.split("::")[0]], test))

    def cost(self, test: str) -> float:
        """What a test takes (s)."""
        return self.seconds.get(test, 0.0)


if "REACH" in os.environ:
    import coverage
    import pytest

    _SECONDS: dict[str, float] = defaultdict(float)
    _COVERAGE = coverage.Coverage(data_file=None, source=list(PACKAGES))

    def pytest_sessionstart() -> None:
        """Begin."""
        _COVERAGE.start()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
        """What runs from here on, its fixtures included, is run by this test."""
        _COVERAGE.switch_context(item.nodeid)
        yield
        _COVERAGE.switch_context("")

    def pytest_runtest_logreport(report: pytest.TestReport) -> None:
        """Add up what a test takes."""
        _SECONDS[report.nodeid] += report.duration

    def pytest_sessionfinish() -> None:
        """Leave what was found."""
        _COVERAGE.stop()
        data, root, lines = _COVERAGE.get_data(), Path.cwd(), {}
        for file in data.measured_files():
            contexts = data.contexts_by_lineno(file)
            found = {line: sorted(filter(None, names)) for line, names in contexts.items()}
            lines[str(Path(file).relative_to(root))] = {k: v for k, v in found.items() if v}
        told = json.dumps({"lines": lines, "seconds": _SECONDS})
        Path(os.environ["REACH"]).write_text(told, encoding="utf-8")
