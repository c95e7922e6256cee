"""The interval side computes what it did before, whatever was rearranged."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.mark.slow
def test_the_numbers_are_those_of_before():
    """To 1e-8: a nudge of 1e-14 of all values moves none by more than 1e-11."""
    before = json.loads((HERE / "interval_cases.json").read_text(encoding="utf-8"))
    paths = [str(HERE.parents[1]), str(HERE.parent / "intervals")]
    ran = subprocess.run(
        [sys.executable, HERE / "interval_cases.py"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=True,
    )
    after = json.loads(ran.stdout)
    assert after.keys() == before.keys()
    for part, rows in after.items():
        assert len(rows) == len(before[part])
        for number, (row, expected) in enumerate(zip(rows, before[part], strict=True)):
            (total, size, lost), where = row, f"{part} {number}"
            assert lost == expected[2], where
            assert total == pytest.approx(expected[0], abs=1e-8 * size + 1e-12), where
            assert size == pytest.approx(expected[1], rel=1e-8, abs=1e-12), where
