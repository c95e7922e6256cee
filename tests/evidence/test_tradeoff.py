"""The study "error against cost": what is judged, and that it can be measured on a small case."""

import numpy as np
import pytest

from evidence.tradeoff import rows
from evidence.tradeoff.measure.bounds import Band, distance, judge_estimate


def test_an_estimate_that_does_not_cover_is_a_failing_row():
    record = {"kind": "splines", "estimate": [{"covered": 1.0, "ratio": 2.0}]}
    case = {"case": "c", "records": [record]}
    (row,) = rows.all_rows({"c": case})
    assert row.passed and "median 2" in row.note
    record["estimate"][0]["covered"] = 0.5
    (row,) = rows.all_rows({"c": case})
    assert not row.passed


def test_distance_and_estimate_of_a_known_band():
    time = np.linspace(0, 1, 11)
    reference = Band(np.zeros((1, 11)), np.ones((1, 11)), np.zeros((1, 11)))
    half = np.where(time < 0.5, 0.1, 0.3)[None]
    band = Band(reference.lower - 0.2, reference.upper, half)
    assert distance(time, band, reference) == pytest.approx([0.2])
    (estimate,) = judge_estimate(time, band, reference)
    assert estimate["covered"] == pytest.approx(6 / 11)
    assert estimate["ratio"] == pytest.approx(np.trapezoid(half[0], time) / 0.2)
