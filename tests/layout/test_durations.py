"""The hook that keeps tests short does."""

import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parents[1]

LISTED = '"test_all.py::test_with_a_reason": "so", '

SPENDING = r"""
import subprocess, sys, time

SPEND = "import time\nwhile time.process_time() < 0.6: pass"

def test_itself():
    end = time.process_time() + 0.6
    while time.process_time() < end:
        pass

def test_by_a_process():
    subprocess.run([sys.executable, "-c", SPEND], check=True)

def test_with_a_reason():
    test_itself()

def test_that_waits():
    time.sleep(0.8)
"""


def test_a_test_that_takes_long_fails_unless_it_is_listed(tmp_path):
    hooks = (TESTS / "conftest.py").read_text(encoding="utf-8")
    for old, new in {
        "LONGEST = 90.0": "LONGEST = 0.5",
        "MAY_TAKE_LONGER: dict[str, str] = {": f"MAY_TAKE_LONGER = {{{LISTED}",
    }.items():
        assert hooks.count(old) == 1
        hooks = hooks.replace(old, new)
    (tmp_path / "conftest.py").write_text(hooks, encoding="utf-8")
    (tmp_path / "test_all.py").write_text(SPENDING, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-c", "/dev/null"]
    done = subprocess.run(
        [*command, "--rootdir", "."], cwd=tmp_path, capture_output=True, text=True
    )
    errors = [line for line in done.stdout.splitlines() if line.startswith("ERROR ")]
    assert [error.split()[1] for error in errors] == [
        "test_all.py::test_itself",
        "test_all.py::test_by_a_process",
    ], done.stdout
    assert "s of cpu time; allowed: 0.5 s, or a reason" in done.stdout
