"""Rows, tables and the command of the verification suite."""

import json
import math

import numpy as np
import pytest

import fpm
from verification import report, suite
from verification.__main__ import main
from verification.bench import Bench, observed_orders


def test_a_row_passes_within_its_tolerance_only():
    bench = Bench("problem")
    bench.check("close", 1.0009, 1.0, 1e-3, "source")
    bench.check("off", 1.0011, 1.0, 1e-3, "source")
    bench.check("nothing", math.nan, 1.0, 1e-3, "source")
    bench.check_small("small", 1e-13, 1e-12, "source", "L")
    bench.check_at_least("order", 1.89, 1.9, "source")
    bench.check_at_least("better order", 3.0, 1.9, "source")
    assert [row.passed for row in bench.rows] == [True, False, False, True, False, True]
    assert bench.rows[1].error == pytest.approx(1.1e-3)


def test_the_order_of_a_known_error_is_observed():
    sizes = np.array([1.0, 0.5, 0.25])
    assert observed_orders(3 * sizes**2) == pytest.approx([2, 2])


def test_failing_rows_stay_in_summary_and_table(tmp_path, monkeypatch, capsys):
    def broken(bench):
        bench.check("right", 1.0, 1.0, 1e-3, "book")
        bench.check("wrong", 2.0, 1.0, 1e-3, "book")
        bench.check("not a number", math.nan, 1.0, 1e-3, "book")
        bench.figure("A plot", "x", "y").curve([1, 2], [3, 4], "line")

    monkeypatch.setattr(suite, "problems", lambda: {"broken": broken})
    assert main(["--output", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert [row["passed"] for row in rows] == [True, False, False]
    assert rows[2]["value"] is None
    assert {"name", "value", "reference", "tolerance", "passed", "source"} <= set(rows[0])
    table = (tmp_path / "table.md").read_text(encoding="utf-8")
    assert "3 rows, 2 failed" in table
    assert "**failed**: broken: wrong" in table
    assert (tmp_path / "a-plot.png").read_bytes()[:4] == b"\x89PNG"
    assert "failed: broken: wrong" in capsys.readouterr().out
    assert main(["--output", str(tmp_path), "--strict"]) == 1


def test_a_run_that_breaks_down_is_a_failing_row(tmp_path, monkeypatch):
    def unstable(bench):
        bench.check("before", 1.0, 1.0, 1e-3, "book")
        scene = fpm.Scene("bar")
        scene.add_link(
            (0, 0, 0), (1, 0, 0), (0, 0, 1), fpm.Section.square(0.1), fpm.Material(1e9, 0.3, 1e3), 2
        )
        scene.velocity[0, 2] = 1.0
        bench.simulate(scene, duration=0.1, instants=11, step=1.05 * fpm.stable_step(scene).step)

    monkeypatch.setattr(suite, "problems", lambda: {"unstable": unstable})
    assert main(["--output", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert [row["passed"] for row in rows] == [True, False]
    assert "unstable at t =" in rows[1]["name"]


def test_an_unknown_problem_is_refused_by_name(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["no such problem"])
    assert stop.value.code == 2
    assert "no such problem" in capsys.readouterr().err


def test_plots_of_all_problems_have_names_of_their_own():
    names = []
    for name in ("heavy top", "contact bounce"):
        bench = Bench(name, quick=True)
        suite.problems()[name](bench)
        names += [report.file_name(figure) for figure in bench.figures]
    assert len(names) == len(set(names)) == 2
