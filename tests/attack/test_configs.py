"""Configs are changed at random: refused in words, or run.

`python -m deployable attack --only configs` does the same for longer.
"""

from __future__ import annotations

import random

import pytest

from evidence.attack.configs import attack_by_config, attack_runs, mutate_config
from evidence.attack.ledger import Ledger

COUNT, RUNS = 600, 20


@pytest.mark.slow
def test_mutated_configs_are_refused_or_run(tmp_path):
    rng, ledger, ran = random.Random(20), Ledger(), 0
    for _ in range(COUNT):
        text = mutate_config(rng)
        if found := attack_by_config(text, tmp_path, ledger, ran < RUNS):
            ran += 1
            attack_runs(found, text, tmp_path / str(ran), ledger)
    assert not ledger.bad, ledger.bad[0]
    assert ledger.counts["config mutated", "refused"] > COUNT // 2
    assert ledger.counts["config mutated", "right"] > COUNT // 50
    assert ran == RUNS
