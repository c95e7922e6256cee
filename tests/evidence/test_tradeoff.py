"""The study "error against cost": what is judged, and that it can be measured on a small case."""

import json

import numpy as np
import pytest

from evidence.results import write
from evidence.tradeoff import rows, study
from evidence.tradeoff.measure.bounds import Band, distance, judge_estimate
from evidence.tradeoff.measure.cases import Case, Choice, Level
from evidence.tradeoff.measure.records import measure_case

CHOICES = (
    Choice("tensor_lobatto", 2),
    Choice("tensor_lobatto", 8),
    Choice("sobol", samples=8),
    Choice("tensor_lobatto", 2, model="spline"),
)
SMALL = Case(
    "small", "Linkage, a ± 10 %", {"a": 0.1}, held_out=4, duration=0.2, instants=101,
    levels=(Level(4, 24, CHOICES), Level(6, 24, CHOICES, rounds=1)),
)  # fmt: skip


@pytest.mark.slow
def test_a_small_case_is_measured_and_told(tmp_path):
    measured = json.loads(json.dumps(measure_case(SMALL, lambda text: None), allow_nan=False))
    coarse, fine = (rows.pick(measured, n, "tensor_lobatto 8") for n in (4, 6))
    low, spline = (rows.pick(measured, 6, f"tensor_lobatto 2{s}") for s in ("", ", spline"))
    assert fine["total"] == fine["surrogate"]
    assert max(coarse["total"]) > 2 * max(coarse["surrogate"])
    assert max(fine["surrogate"]) < max(low["surrogate"])
    assert (low["runs"], spline["runs"], fine["runs"]) == (3, 7, 9)
    assert fine["cpu"] > 0
    write(tmp_path, "tradeoff", study.report({"small": measured}))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert {row["group"] for row in summary["rows"]} == {"small"}
    assert "tensor_lobatto 8" in (tmp_path / "table.md").read_text(encoding="utf-8")


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
