"""The fast part of the verification suite: its problems, on coarse meshes, with its tolerances."""

import pytest

from verification import suite
from verification.bench import Bench


@pytest.mark.parametrize("name", suite.problems())
def test_rows_of_a_problem_pass(name):
    bench = Bench(name, quick=True)
    suite.problems()[name](bench)
    assert bench.rows
    failed = [f"{r.name}: {r.value} for {r.reference}" for r in bench.rows if not r.passed]
    assert not failed
