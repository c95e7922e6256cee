"""Structures of all kinds move as they did before, whatever was rearranged."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from evidence.attack.metamorphic.runs import scene_of
from fpm.elements import KINDS, Probe, kinds_of

HERE = Path(__file__).parent
BEFORE = json.loads((HERE / "all_kinds.json").read_text(encoding="utf-8"))


def test_the_structures_have_all_kinds():
    """But for probes, which a response asks for."""
    found = {kind for case in BEFORE for kind in kinds_of([scene_of(case["structure"])])}
    assert set(KINDS) - found == {Probe}


@pytest.mark.slow
@pytest.mark.parametrize("half", [0, 1])
def test_they_move_as_before(half):
    """To 1e-8: a nudge of 1e-9 of their numbers changes none by more than 3e-7, and rounding is a
    ten millionth of that. Half of them with the linear algebra of another processor."""
    environment = {**os.environ, "PYTHONPATH": str(HERE.parents[1])}
    if half:
        environment["OPENBLAS_CORETYPE"] = "Nehalem"
    ran = subprocess.run(
        [sys.executable, HERE / "all_kinds.py", str(half), "2"],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    for before, after in zip(BEFORE[half::2], json.loads(ran.stdout), strict=True):
        assert after.get("fails") == before.get("fails")
        assert after["sums"].keys() == before["sums"].keys()
        for what, (total, size) in after["sums"].items():
            assert total == pytest.approx(before["sums"][what][0], abs=1e-8 * size + 1e-12), what
