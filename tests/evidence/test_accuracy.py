"""The study of speed against accuracy: a small version of it."""

import pytest

from evidence.accuracy import study as accuracy
from evidence.accuracy.study import Choice


@pytest.mark.slow
def test_the_mesh_and_the_lumping_count_and_the_step_does_not():
    """Against 24 elements."""
    reference, _ = accuracy.simulate(Choice(24))
    choices = [Choice(4), Choice(8), Choice(8, safety=0.45), Choice(8, is_trapezium=True)]
    results = accuracy.measure([*choices, Choice(24)], reference)
    coarse, plain, small_step, trapezium, itself = (r.bd[1] for r in results)
    assert coarse > 4 * plain
    assert small_step == pytest.approx(plain, rel=0.3)
    assert trapezium > 8 * plain
    assert itself == 0.0
    assert accuracy.choices_table(results).count("\n") == 2 + len(results)
