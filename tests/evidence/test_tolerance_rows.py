"""One key for accuracy in the trade study: what is judged of it, and that it can be measured."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from evidence.registry import STUDIES
from evidence.tradeoff.measure.tolerance_cases import ACCURACY_CASES
from evidence.tradeoff.measure.tolerances import judge
from evidence.tradeoff.tolerance_rows import accuracy_rows


def row(cpu, true, told, most, covers=1.0, **more):
    error = {"share": true, "told": told, "most": most, "covers": covers}
    facts = {"met": None, "mesh": None, "rounds": None, "reason": None, "runs": 8}
    return {"cpu": cpu, **facts, **more, "errors": [error]}


def case(asked, rivals):
    return {"case": "c", "title": "C", "responses": ["x"], "asked": asked, "rivals": rivals}


def test_rows_judge_what_was_asked_for_the_estimates_and_the_cost():
    asked = [row(1.0, 0.02, 0.05, 0.09, met=True, share=0.1), row(4.0, 0.01, 0.02, 0.04, met=True,
             share=0.02)]  # fmt: skip
    rivals = [row(10.0, 0.005, 0.02, 0.01, name="dear"), row(3.0, 0.015, 0.02, 0.03, name="cheap")]
    kept, estimate, covers, first, second = accuracy_rows(case(asked, rivals))
    assert (kept.value, kept.passed) == (0.5, False)  # the second leaves 2 % at many instants
    assert estimate.value == pytest.approx(2.5)
    assert estimate.passed and covers.passed
    assert (first.value, first.passed) == (pytest.approx(1 / 3), True)
    assert (second.value, second.passed) == (0.4, True)  # only the dear one is as accurate


def test_the_true_error_is_judged_against_the_reference():
    time = np.linspace(0.0, 2.0, 201)

    def bounds(off):
        curves = {"lower": 0 * time, "upper": 1 + off, "error": 0 * time + 0.1}
        return xr.Dataset({n: (("response", "time"), c[None]) for n, c in curves.items()},
                          coords={"time": time})  # fmt: skip

    found = judge(bounds(0.2 * (time > 1)), bounds(0 * time), 0)
    assert found["share"] == pytest.approx(0.1, rel=0.01)
    assert found["told"] == pytest.approx(0.1)
    assert found["covers"] == pytest.approx(0.5, abs=0.01)
    assert found["most"] == pytest.approx(0.2)


def test_every_case_is_a_part_of_the_study():
    assert {f"asked-{found.name}" for found in ACCURACY_CASES} <= set(STUDIES["tradeoff"].parts)
