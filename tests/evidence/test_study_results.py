"""The row that all studies share, and the files that their rows end in."""

import json
import math

import pytest

from evidence import plots
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


def test_how_much_of_its_allowance_a_row_takes():
    assert close_to("n", 1.5, 1.0, 2.0).utilization == pytest.approx(0.25)
    assert at_most("n", 3.0, 6.0).utilization == pytest.approx(0.5)
    for row in (info("n", 1.0), refusal("n", "why"), skip_row("n", "why"), at_least("n", 1.0, 2.0)):
        assert math.isnan(row.utilization)


def test_results_are_a_summary_a_table_and_figures(tmp_path):
    chart = plots.Chart("A plot of 45°", "x (m)", "y (m)", logarithmic=True)
    chart.curve([1, 2], [3, 4], "computed")
    chart.curve([1, 2], [3, 5], "book", reference=True)
    figure, (axes,) = plots.panels()
    plots.draw_utilization(axes, ROWS, [row.group for row in ROWS])
    figures = {"used": figure, chart.name: chart.figure}
    write(tmp_path, "trial", Report(ROWS, {"machine": {"cores": 2}}, "\nMore.\n", figures))
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
    assert "pip install peer" in text and "More." in text and "![used](used.png)" in text
    for name in ("used", "a-plot-of-45-degree"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert len(list(tmp_path.iterdir())) == 6


def test_equal_data_give_equal_files(tmp_path):
    for folder in ("a", "b"):
        chart = plots.Chart("title", "x", "y")
        chart.curve([1, 2], [3, 4], "computed")
        write(tmp_path / folder, "trial", Report(ROWS, figures={"plot": chart.figure}))
    for file in ("summary.json", "table.md", "plot.png", "plot.pdf"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_further_entries_must_be_finite_and_results_are_written_whole(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write(tmp_path, "trial", Report(ROWS, {"cost": math.nan}))
    assert [path.name for path in tmp_path.iterdir()] == ["table.md"]
