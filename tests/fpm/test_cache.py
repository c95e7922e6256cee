"""Compiled afresh or loaded from the cache, the solver gives the same bits."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import fpm
scene = fpm.scenes.get("bennett").build(elements_per_link=2)
outcome = fpm.simulate(scene, duration=0.5, instants=3, step=1e-4)[0]
print(outcome.points["B"][0].tobytes().hex())
from fpm.kernels.compiled import LOOPS
print(sum(sum(run.stats.cache_hits.values()) for run in LOOPS.values()))
"""


@pytest.mark.slow
def test_cached_code_gives_the_bits_of_fresh_code(tmp_path):
    root = str(Path(__file__).parents[2])
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": root}
    runs = [
        subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True,
            check=True,
        ).stdout.split()
        for _ in range(2)
    ]  # fmt: skip
    assert [int(hits) for _, hits in runs] == [0, 1]
    assert runs[0][0] == runs[1][0]
