"""The row that all studies share, and the files that their rows end in."""

import json
import math

import pytest

from evidence.results import Report, write
from evidence.rows import Row, at_least, at_most, close_to, info, refusal, set_group, skip_row

ROWS = set_group(
    "one",
    [
        close_to("one: right", 1.0, 1.0, 1e-3, "book"),
        close_to("one: wrong", 2.0, 1.0, 1e-3, "book"),
        close_to("one: not a number", math.nan, 1.0, 1e-3, "book"),
    ],
) + set_group(
    "two",
    [
        info("speed", 7.5, "m/s"),
        at_most("cost", 7.0, 6.0, unit="s"),
        refusal("case", "too thin"),
        skip_row("peer", "not installed: pip install peer", "x"),
    ],
)


def test_rows_pass_fail_or_are_not_judged():
    assert [row.passed for row in ROWS] == [True, False, False, None, False, True, None]
    assert [row.is_failed for row in ROWS] == [False, True, True, False, True, False, False]
    assert at_most("n", 5.0, 6.0).passed and not at_most("n", 7.0, 6.0).passed
    assert at_least("n", 7.0, 6.0).passed and not at_least("n", 5.0, 6.0).passed
    assert not at_most("n", math.nan, 6.0).passed and not at_least("n", math.nan, 6.0).passed


def test_results_are_a_summary_and_a_table(tmp_path):
    write(tmp_path, "trial", Report(ROWS, {"machine": {"cores": 2}}, "\nMore.\n"))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["study"] == "trial" and summary["machine"] == {"cores": 2}
    assert [Row(**row).name for row in summary["rows"]] == [row.name for row in ROWS]
    assert [row["passed"] for row in summary["rows"]] == [row.passed for row in ROWS]
    assert summary["rows"][2]["value"] is None
    text = (tmp_path / "table.md").read_text(encoding="utf-8")
    assert "7 rows, 3 failed, 1 skipped" in text
    assert "**failed**: one: wrong: 2, 1 ± 0.001" in text
    assert "| right | 1 | 1 ± 0.001 | yes | book |" in text
    assert "| cost | 7 | s | at most 6 | **NO** |" in text
    assert "pip install peer" in text and "More." in text
    assert len(list(tmp_path.iterdir())) == 2


def test_further_entries_must_be_finite_and_results_are_written_whole(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write(tmp_path, "trial", Report(ROWS, {"cost": math.nan}))
    assert [path.name for path in tmp_path.iterdir()] == ["table.md"]
