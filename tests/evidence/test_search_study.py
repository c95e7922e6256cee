"""The study of the search for bounds tells bounds that are wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evidence.search import fractions, mechanisms, mechanisms_carts
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


def a_check(off: float, error: float) -> dict:
    """A mechanism whose only bound, and fraction, is off."""
    bound = {"bound": "t upper", "off": off, "runs_off": 0.001, "error": error, "true": 1.0,
             "said": 1.0, "attained": 1.0, "predicted": True, "partial": True,
             "told_met": error < 0.05}  # fmt: skip
    share = {
        "true": 0.5,
        "said": 0.5 + off,
        "open": error,
        "met": "all" if off > error else "some",
        "all": False,
    }
    answer = {"box": "latch", "seconds": 3.0, "runs": mechanisms.MAX_RUNS + (off > error),
              "accuracy_met": error < 0.05, "bounds": [bound], "shares": [share]}  # fmt: skip
    rivals = {"default": (1.0 if off > error else 2.0, 0.0)}
    return {"accuracy": answer, "default": answer, "rivals": rivals, "as_right": "default"}


@pytest.mark.parametrize(("off", "error", "count"), [(0.001, 0.002, 0), (0.1, 0.03, 16)])
def test_rows_of_mechanisms_tell_what_is_wrong(off, error, count):
    rows = report({"carts": [a_check(off, error)]}).rows
    assert sum(row.is_failed for row in rows) == count


@pytest.mark.slow  # compiles
def test_carts_move_as_their_closed_forms():
    box = mechanisms_carts.BOXES[4]
    answer = mechanisms.play(
        box,
        mechanisms.truths("mechanisms_carts")[box.name],
        {"design": {"method": "smolyak", "order": 2}},
    )
    # As near as a search goes on, a thousandth of the width; it was 1e-4, which it came to by luck.
    assert max(bound["runs_off"] for bound in answer["bounds"] if "rate" in bound["bound"]) < 1e-3


def test_fractions_lie_within_what_is_told_and_others_fail():
    checks = fractions.measure_fractions(quick=True)
    assert sum(check.error > check.uncertainty + 5e-4 for check in checks) <= 1
    wrong = [replace(check, uncertainty=0.3 * check.error) for check in checks]
    rows = report({"fractions": wrong}).rows
    assert [row.is_failed for row in rows] == [True, False]
