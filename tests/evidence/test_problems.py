"""The fast part of the verification suite: its problems, on coarse meshes, with its tolerances."""

import pytest

from evidence.verification.study import PARTS

# The others compile kernels of kinds that quick tests do not need.
QUICK = ("rigid Bennett linkage", "flexible Bennett linkage")


@pytest.mark.parametrize(
    "name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in PARTS]
)
def test_rows_of_a_problem_pass(name):
    bench = PARTS[name](True)
    assert bench.rows
    failed = [f"{r.name}: {r.value} for {r.reference}" for r in bench.rows if not r.passed]
    assert not failed
