"""The bench of the verification problems: rows, orders, and runs that break down."""

import math

import fpm
from evidence.verification import study
from evidence.verification.bench import Bench


def test_a_row_passes_within_its_tolerance_only():
    bench = Bench("problem")
    bench.check("close", 1.0009, 1.0, 1e-3, "source")
    bench.check("off", 1.0011, 1.0, 1e-3, "source")
    bench.check("nothing", math.nan, 1.0, 1e-3, "source")
    bench.check_small("small", 1e-13, 1e-12, "source", "L")
    bench.check_at_least("order", 1.89, 1.9, "source")
    bench.check_at_least("better order", 3.0, 1.9, "source")
    assert [row.passed for row in bench.rows] == [True, False, False, True, False, True]
    assert {row.group for row in bench.rows} == {"problem"}


def test_a_run_that_breaks_down_is_a_failing_row(monkeypatch):
    def unstable(bench):
        bench.check("before", 1.0, 1.0, 1e-3, "book")
        scene = fpm.Scene("bar")
        scene.add_link(
            (0, 0, 0), (1, 0, 0), (0, 0, 1), fpm.Section.square(0.1), fpm.Material(1e9, 0.3, 1e3), 2
        )
        scene.velocity[0, 2] = 1.0
        step = 1.05 * fpm.find_stable_step(scene).step
        bench.simulate(scene, duration=0.1, instants=11, step=step)

    monkeypatch.setitem(study.PROBLEMS, "unstable", unstable)
    rows = study.solve("unstable", True).rows
    assert [row.passed for row in rows] == [True, False]
    assert "unstable at t =" in rows[1].name
