"""The study of the search for bounds tells bounds that are wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evidence.search.boxes import BOXES
from evidence.search.rivals import CLOSE
from evidence.search.study import measure_all, report


@pytest.fixture(scope="module")
def searched():
    return measure_all(quick=True)


def failed(boxes) -> list[str]:
    return [row.name for row in report({"boxes": boxes}).rows if row.is_failed]


def test_true_bounds_are_those_of_the_closed_form():
    lower, upper = BOXES[0].true_bounds()
    assert (lower, upper) == (pytest.approx(np.arcsin(0.6)), pytest.approx(np.pi / 2, abs=1e-4))


def test_crossings_with_margins_are_exact(searched):
    assert failed(searched) == []
    assert max(box.misses().max() / box.width for box in searched) < CLOSE / 2


def test_bounds_that_are_wrong_fail(searched):
    wrong = [replace(box, outer_bounds=(box.true[0] - 1, box.true[1] + 1)) for box in searched]
    assert len(failed(wrong)) == 3
