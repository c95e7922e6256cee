"""The study of bounds of quantities tells bounds that are wrong."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.search import fractions, mechanisms, mechanisms_carts
from evidence.search.boxes import Box
from evidence.search.study import report


def test_true_bounds_are_those_of_the_closed_form():
    """A crossing of 0.9 by an amplitude of 0.5 to 1.5 that happens in 60 % of the interval."""

    def crossing(u):
        level = 0.9 / (1 + 0.5 * u[:, 0])
        return np.where(level < 1, np.arcsin(np.clip(level, -1, 1)), np.nan)

    lower, upper = Box(1, crossing).true_bounds()
    assert (lower, upper) == (pytest.approx(np.arcsin(0.6)), pytest.approx(np.pi / 2, abs=1e-4))


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
    return {"accuracy": answer, "default": answer}


@pytest.mark.parametrize(("off", "error", "count"), [(0.001, 0.002, 0), (0.1, 0.03, 15)])
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
    # As near as a search goes on, a thousandth of the width.
    assert max(bound["runs_off"] for bound in answer["bounds"] if "rate" in bound["bound"]) < 1e-3


def test_rows_of_fractions_count_what_lies_within():
    """Of 1 %, 3 % and, where no run fails, 0.5 %, said with 2 % each: the second does not."""
    answers = [
        {"box": "b", "by": "default", "runs": 30, "fraction": "f", "kind": "fraction", "met": met,
         "true": true, "said": said, "open": open_}
        for met, true, said, open_ in
        (("some", 0.5, 0.51, 0.02), ("some", 0.5, 0.53, 0.02), ("all", 0.995, 1.0, 0.0))
    ]  # fmt: skip
    row, ratio, *_ = fractions.report(answers).rows
    assert row.note == "2 of 3" and row.is_failed
    assert ratio.value == pytest.approx(2 / 3) and not ratio.is_failed


@pytest.mark.parametrize("name", ["step 1", "both", "rare"])
def test_stored_fractions_are_those_of_the_closed_forms(name):
    box = next(box for box in fractions.BOXES if box.name == name)
    truth, points = (
        fractions.truths()[name],
        np.random.default_rng(0).uniform(-1, 1, (40000, box.k)),
    )
    for key, mask in box.masks(points).items():
        assert mask.mean() == pytest.approx(truth[key], abs=0.01)
