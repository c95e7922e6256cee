"""The benchmark runs and tells well-formed rows; how fast anything is, is not tested."""

import json
import math

import numpy as np
import pytest

import fpm
from benchmark import campaigns, kernel, kinds, machine, operations, overheads, peers, plot
from benchmark.description import describe
from benchmark.rows import Row, at_least, at_most, skipped, told, write_results
from benchmark.scenes import beam_count, linkages


def check(rows: list[Row]) -> None:
    assert rows
    for row in rows:
        assert row.name and row.unit and row.group
        if row.skipped:
            assert row.value is None and row.passed is None
        else:
            assert isinstance(row.value, float | int) and math.isfinite(row.value)
            assert (row.passed is None) == (row.target is None)
    assert len({(row.group, row.name) for row in rows}) == len(rows)


def test_a_row_that_misses_its_target_says_so():
    assert at_most("g", "n", 5.0, 6.0, "s").passed and not at_most("g", "n", 7.0, 6.0, "s").passed
    assert at_least("g", "n", 7.0, 6.0, "s").passed and not at_least("g", "n", 5.0, 6.0, "x").passed
    assert at_most("g", "n", 7.0, 6.0, "s").verdict == "NO"


def test_results_are_a_json_file_and_a_table(tmp_path):
    rows = [told("one", "a", 1.0, "s"), at_most("two", "b", 2.0, 1.0, "s")]
    rows.append(skipped("two", "c", "x", "not installed: pip install c"))
    write_results(tmp_path, rows, {"cores": 2})
    found = json.loads((tmp_path / "summary.json").read_text())
    assert [row["passed"] for row in found["rows"]] == [None, False, None]
    assert {"name", "value", "target", "passed", "unit", "skipped"} <= set(found["rows"][0])
    text = (tmp_path / "table.md").read_text()
    assert "| NO |" in text and "pip install c" in text and "cores: 2" in text
    plot.costs(rows, tmp_path)
    assert (tmp_path / "benchmark.png").stat().st_size > 0


def test_kernel_rows():
    rows = kernel.cost(20, 1, samples=9, meshes=(2, 3))
    rows += kernel.recording(40, 1, instants=21) + kernel.cores(20, 1, samples=2)
    check(rows)
    assert sum("lanes against one sample" in row.name for row in rows) == 2


def test_every_element_kind_is_timed():
    rows = kinds.kinds(20, 1, elements=2)
    check(rows)
    assert len(rows) == len(kinds.CASES) + 1


def test_overheads():
    rows = overheads.surrogate(1, order=3, instants=20, responses=2) + overheads.writing(1, 11, 2)
    check(rows)


def test_counting_numbers_count_as_the_compiler_fuses():
    a, b, c = (operations.Lanes(np.full(8, x)) for x in (2.0, 3.0, 4.0))
    operations.TALLY.clear()
    assert (a * b - c * a + 1.0).value[0] == -1.0  # product, fused; then a plain sum
    assert (-a / b).value[0] == pytest.approx(-2 / 3)
    wide = operations.Lanes(np.zeros(16))
    assert len((wide + 1.0).value) == 16
    kept = {k: n for k, n in operations.TALLY.items() if isinstance(k, str)}
    assert kept == {"multiply": 1, "fma": 1, "add": 3, "divide": 1}


def test_operations_of_the_loop_grow_with_the_elements():
    one, two = (machine.counts(n, steps=5)["operations"] for n in (2, 3))
    # 4 elements and 4 particles more: at least the square root and the division of each element.
    assert two["root"] - one["root"] == pytest.approx(4, abs=0.5)
    assert two["divide"] - one["divide"] == pytest.approx(4, abs=0.5)
    assert two["fma"] > one["fma"] > 100


def test_peers_that_are_not_installed_are_skipped_with_the_command(monkeypatch):
    monkeypatch.setattr(peers, "interpreter", lambda module, variable: None)
    rows = peers.exudyn(0.001, 1) + peers.elastica(0.001, 1)
    check(rows)
    assert len(rows) == 2
    assert all("pip install" in row.skipped for row in rows)


@pytest.mark.parametrize(
    ("module", "variable", "measure"),
    [("exudyn", "EXUDYN_PYTHON", peers.exudyn), ("elastica", "PYELASTICA_PYTHON", peers.elastica)],
)
@pytest.mark.slow
def test_peers_that_are_installed_run(module, variable, measure):
    if peers.interpreter(module, variable) is None:
        pytest.skip(f"{module} is not installed, and {variable} is not set")
    check(measure(0.002, 1, cases=1))


def test_the_description_of_the_linkage_fits_together():
    scene = linkages(1, 3)[0]
    told_scene = describe(scene)
    assert len(told_scene["elements"]) == beam_count(scene) == 12
    position, frame = np.array(told_scene["position"]), np.array(told_scene["frame"])
    for hinge in told_scene["hinges"]:
        points, axes = [], []
        for n, arm, own in zip(hinge["nodes"], hinge["arms"], hinge["frames"], strict=True):
            assert np.linalg.det(own) == pytest.approx(1.0)
            points.append(position[n] + frame[n] @ arm)
            axes.append(frame[n] @ own)
        np.testing.assert_allclose(points[0], points[1], atol=1e-12)
        np.testing.assert_allclose(axes[0], axes[1], atol=1e-12)
        assert hinge["opening"] > 0
    json.dumps(told_scene)


def test_memory_of_a_run_is_read_from_another_process():
    grown, before = kernel._grown(11, 20, kernel.stable(linkages(1)))
    assert before > 1000 and grown >= 0


def test_busy_time_counts_an_instant_once():
    assert campaigns.busy([(0.0, 2.0), (1.0, 3.0), (5.0, 6.0)]) == 4.0
    assert campaigns.busy([]) == 0.0


def test_the_timed_scenes_hold_together():
    for case in kinds.CASES.values():
        scene = kinds.bars(2, *case)
        assert fpm.stable_step(scene).step > 0
