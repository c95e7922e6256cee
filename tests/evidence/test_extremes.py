"""The judge of the extremes: right curves pass, wrong ones fail, refusals are told as such."""

import pytest

from evidence.extremes.judge import LINE_ACCURACY, compare, judge
from evidence.linkage.runs import closing_time, curves, first_closing, simulate


@pytest.mark.slow
def test_a_stiff_linkage_agrees_with_the_rigid_one():
    rows = judge("stiff", {"E": 1e11}, reference="rigid")
    assert [row.name for row in rows] == ["stiff: BD", "stiff: velocity of B"]
    assert all(row.passed for row in rows)


def test_a_wrong_curve_fails():
    """The same run against curves of linkages that are 1 % and 10 % thicker."""
    duration = closing_time()
    right, wrong, far = (simulate(duration, a=a, elements=4) for a in (0.035, 0.03535, 0.0385))
    until = 0.98 * min(first_closing(right), first_closing(wrong), duration)
    same = compare("same", right, curves(right), until, LINE_ACCURACY, "itself")
    assert all(row.passed for row in same)
    other = compare("other", right, curves(wrong), until, LINE_ACCURACY, "another")
    assert not other[0].passed
    other = compare("far", right, curves(far), until, LINE_ACCURACY, "another")
    assert not any(row.passed for row in other)
