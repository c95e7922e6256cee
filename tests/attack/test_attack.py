"""Processes are killed, and disks are full: nothing broken is left, and all goes on.

`python -m evidence attack --minutes 60` does this, and all else that is in this folder, for an
hour.
"""

from __future__ import annotations

import ast
import random

import pytest

from evidence.attack.ledger import Ledger
from evidence.attack.mutants import change_at, sites
from evidence.attack.processes import attack_by_full_disk, attack_by_kill, command, start
from evidence.attack.victim import Victim


@pytest.fixture(scope="module")
def victims(tmp_path_factory):
    """The campaigns that are attacked, with trajectories and with responses only."""
    place = tmp_path_factory.mktemp("victims")
    return [Victim(place, keep) for keep in ("trajectories", "responses")]


@pytest.mark.slow
def test_killed_runs_and_full_disks_leave_nothing_broken(victims, tmp_path):
    rng, ledger = random.Random(20), Ledger()
    for number in range(2):
        attack_by_kill(rng.choice(victims), tmp_path / f"kill{number}", ledger, rng)
        attack_by_full_disk(rng.choice(victims), tmp_path / f"disk{number}", ledger, rng)
    assert not ledger.bad, ledger.bad[0]


def test_a_mutant_is_changed_in_one_place():
    tree = ast.parse("def f(a, b):\n    return max(a + 1, b) if a < b and not b else True\n")
    found = [
        (what, ast.unparse(made)) for _, what, made in (change_at(tree, i) for i in sites(tree))
    ]
    assert len(found) >= 7
    assert len({text for _, text in found} | {ast.unparse(tree)}) == len(found) + 1
    assert ("`a < b` to `a <= b`", ast.unparse(tree).replace("a < b", "a <= b")) in found


def test_what_goes_wrong_is_counted():
    ledger = Ledger()
    ledger.attempt("one", "x", 1.0, lambda: "right")
    ledger.attempt("one", "y", 1.0, lambda: 1 / 0)
    ledger.attempt("two", "z", 0.01, lambda: [None for _ in iter(int, 1)])
    assert [(name, outcome) for name, outcome, _ in ledger.bad] == [
        ("one", "traceback"), ("two", "hang"),
    ]  # fmt: skip
    assert "| one | 2 | 1 | 0 | 0 | 0 | 0 | 0 | 1 | 0 |" in ledger.table()


def test_a_full_disk_is_one_sentence(victims, tmp_path):
    process = start(command(victims[0], tmp_path), limit=3000)
    told, _ = process.communicate()
    assert process.returncode == 1
    assert f"a file in {tmp_path / 'victim'} would be larger than files may be (3 kB" in told
    assert "all runs that were finished are kept: raise the limit and give the same comm" in told
    assert "Traceback" not in told
