"""The study "error against cost": what is judged, and that it can be measured on a small case."""

from evidence.tradeoff import rows


def test_an_estimate_that_does_not_cover_is_a_failing_row():
    record = {"kind": "splines", "estimate": [{"covered": 1.0, "ratio": 2.0}]}
    case = {"case": "c", "records": [record]}
    (row,) = rows.all_rows({"c": case})
    assert row.passed and "median 2" in row.note
    record["estimate"][0]["covered"] = 0.5
    (row,) = rows.all_rows({"c": case})
    assert not row.passed
