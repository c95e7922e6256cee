"""The program is attacked: nothing wrong, nothing stuck, no traceback, no hang.

`python -m evidence attack --minutes 60` does the same for an hour.
"""

from __future__ import annotations

import ast
import os
import random
import signal

import pytest

from evidence.attack.configs import attack_by_config, attack_by_running, mutated
from evidence.attack.damage import attack_files
from evidence.attack.ledger import Ledger
from evidence.attack.mutants import change_at, sites
from evidence.attack.processes import attack_by_full_disk, attack_by_kill, command, start
from evidence.attack.victim import RAW, Victim

SEED = 20


@pytest.fixture(scope="module")
def victims(tmp_path_factory):
    """The campaigns that are attacked, with trajectories and with responses only."""
    place = tmp_path_factory.mktemp("victims")
    return [Victim(place, keep) for keep in ("trajectories", "responses")]


def judged(ledger: Ledger) -> None:
    assert not ledger.bad, ledger.bad[0]


def damage(victims, place, count):
    rng, ledger = random.Random(SEED), Ledger()
    for _ in range(count):
        attack_files(rng.choice(victims), place / "attacked", ledger, rng)
    judged(ledger)
    assert sum(ledger.counts.values()) > count // 2


def configs(place, count, runs):
    rng, ledger, ran = random.Random(SEED), Ledger(), 0
    for _ in range(count):
        text = mutated(rng)
        if found := attack_by_config(text, place, ledger, ran < runs):
            ran += 1
            attack_by_running(found, text, place / str(ran), ledger)
    judged(ledger)
    assert ledger.counts["config mutated", "refused"] > count // 2
    assert ledger.counts["config mutated", "right"] > count // 50
    assert ran == runs


def processes(victims, place, count):
    rng, ledger = random.Random(SEED), Ledger()
    for number in range(count):
        attack_by_kill(rng.choice(victims), place / f"kill{number}", ledger, rng)
        attack_by_full_disk(rng.choice(victims), place / f"disk{number}", ledger, rng)
    judged(ledger)


@pytest.mark.slow
def test_damaged_files_are_told_and_made_again(victims, tmp_path):
    damage(victims, tmp_path, 8)


@pytest.mark.slow
def test_mutated_configs_are_refused_or_run(tmp_path):
    configs(tmp_path, 100, 3)


@pytest.mark.slow
def test_killed_runs_and_full_disks_leave_nothing_broken(victims, tmp_path):
    processes(victims, tmp_path, 1)


@pytest.mark.slow
def test_many_damaged_files(victims, tmp_path):
    damage(victims, tmp_path, 100)


@pytest.mark.slow
def test_many_mutated_configs(tmp_path):
    configs(tmp_path, 2300, 100)


@pytest.mark.slow
def test_many_killed_runs_and_full_disks(victims, tmp_path):
    processes(victims, tmp_path, 8)


def test_a_mutant_is_changed_in_one_place():
    tree = ast.parse("def f(a, b):\n    return max(a + 1, b) if a < b and not b else True\n")
    found = [
        (what, ast.unparse(made)) for *_, what, made in (change_at(tree, i) for i in sites(tree))
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
    assert "| one | 2 | 1 | 0 | 0 | 0 | 0 | 1 | 0 |" in ledger.table()


def long_one(place):
    """A command that runs for minutes."""
    victim = Victim.__new__(Victim)
    victim.raw = RAW | {"solver": {"duration": 20.0, "instants": 9}, "jobs": {"group": 1}}
    return command(victim, place)


def test_ctrl_c_is_one_line(tmp_path):
    process = start(long_one(tmp_path))
    first = process.stdout.readline()
    os.killpg(process.pid, signal.SIGINT)
    told, _ = process.communicate()
    assert process.returncode == 130
    assert "stopped; finished runs are kept" in told
    assert "Traceback" not in first + told


def test_a_full_disk_is_one_sentence(victims, tmp_path):
    process = start(command(victims[0], tmp_path), limit=3000)
    told, _ = process.communicate()
    assert process.returncode == 1
    assert f"no room to write in {tmp_path / 'victim'}" in told
    assert "all runs that were finished are kept: make room and give the same command" in told
    assert "Traceback" not in told
