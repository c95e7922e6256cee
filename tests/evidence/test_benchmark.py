"""The benchmark runs and tells well-formed rows; how fast anything is, is not tested."""

import json
import math

import numpy as np
import pytest

import fpm
from evidence.benchmark import (
    campaigns,
    kernel,
    kinds,
    machine,
    operations,
    overheads,
    scenes,
    study,
)
from evidence.benchmark.peers import compare, structures
from evidence.benchmark.peers.description import describe
from evidence.benchmark.scenes import beam_count, linkages
from evidence.results import write
from evidence.rows import Row, at_most, info, skip_row
from fpm.structures import load, report


def check(rows: list[Row]) -> None:
    assert rows
    for row in rows:
        assert row.name and row.unit
        if row.skipped:
            assert row.value is None and row.passed is None
        else:
            assert isinstance(row.value, float | int) and math.isfinite(row.value)
            assert (row.passed is None) == (row.reference is None)
    assert len({row.name for row in rows}) == len(rows)


@pytest.mark.slow
def test_every_element_kind_is_timed_and_the_report_tells_the_machine_and_draws_it(tmp_path):
    rows = kinds.kinds(20, 1, elements=2)
    check(rows)
    assert len(rows) == len(kinds.CASES) + 1
    found = {
        "kinds": rows,
        "cost": [at_most("b", 2.0, 1.0), skip_row("c", "pip install c", "x"), info("d", 1.0, "s")],
    }
    write(tmp_path, "benchmark", study.report(found))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["machine"]["cores"] >= 1
    assert [row["passed"] for row in summary["rows"][-3:]] == [False, None, None]
    assert "Machine: processor: " in (tmp_path / "table.md").read_text(encoding="utf-8")
    assert (tmp_path / "benchmark.png").stat().st_size > 0


def test_every_part_has_its_group(monkeypatch):
    group, _ = study._PARTS["writing"]
    monkeypatch.setitem(study._PARTS, "writing", (group, lambda n: [info(f"{n}", 1.0, "s")]))
    (quick,), (full,) = study.PARTS["writing"](True), study.PARTS["writing"](False)
    assert (quick.name, full.name) == ("10", "1")
    assert quick.group == overheads.GROUP


def test_kernel_rows():
    rows = kernel.cost(20, 1, samples=9, meshes=(2, 3))
    rows += kernel.recording(40, 1, instants=21) + kernel.cores(20, 1, samples=2)
    check(rows)
    assert sum("lanes against one sample" in row.name for row in rows) == 2


def test_overheads():
    rows = overheads.surrogate(1, order=3, instants=20, responses=2)
    check(rows + overheads.time_write(1, 11, 2))


def test_counting_numbers_count_as_the_compiler_fuses():
    a, b, c = (operations.Lanes(np.full(8, x)) for x in (2.0, 3.0, 4.0))
    operations.TALLY.clear()
    assert (a * b - c * a + 1.0).value[0] == -1.0  # product, fused; then a plain sum
    assert (-a / b).value[0] == pytest.approx(-2 / 3)
    wide = operations.Lanes(np.zeros(16))
    assert len((wide + 1.0).value) == 16
    kept = {k: n for k, n in operations.TALLY.items() if isinstance(k, str)}
    assert kept == {"multiply": 1, "fma": 1, "add": 3, "divide": 1}


@pytest.mark.slow
def test_operations_of_the_loop_grow_with_the_elements():
    one, two = (machine.counts(n, steps=16)["operations"] for n in (2, 12))
    # 40 elements and 40 particles more: at least the square root and the division of each element.
    assert two["root"] - one["root"] == pytest.approx(40, abs=0.5)
    assert two["divide"] - one["divide"] == pytest.approx(40, abs=0.5)
    whole = machine.counts()["operations"]  # with a check of the energy
    assert (whole["fma"] + whole["multiply"]) / 48 <= machine.MULTIPLICATIONS
    check(machine.peak(20, 1, elements=2))


def test_peers_that_are_not_installed_are_skipped_with_the_command(monkeypatch):
    monkeypatch.setattr(compare, "interpreter", lambda module, variable: None)
    rows = compare.exudyn(0.001, 1) + compare.elastica(0.001, 1) + structures.exudyn(1)
    check(rows)
    assert len(rows) == 2 + len(structures.CASES)
    assert all("pip install" in row.skipped for row in rows)


@pytest.mark.parametrize(
    ("module", "variable", "measure"),
    [
        ("exudyn", "EXUDYN_PYTHON", lambda: compare.exudyn(0.002, 1, cases=1)),
        ("elastica", "PYELASTICA_PYTHON", lambda: compare.elastica(0.002, 1, cases=1)),
        ("exudyn", "EXUDYN_PYTHON", lambda: structures.exudyn(1, structures.CASES[:2], steps=2)),
    ],
)
@pytest.mark.slow
def test_peers_that_are_installed_run(module, variable, measure):
    if compare.interpreter(module, variable) is None:
        pytest.skip(f"{module} is not installed, and {variable} is not set")
    check(measure())


def test_the_structures_are_what_peers_are_told():
    for case in structures.CASES:
        structure = load(structures.FOLDER / f"{case.name}.yaml")
        scene = structure.build(**case.parameters)
        found = describe(scene, case.ignore)
        json.dumps(found)
        assert case.point in found["points"] and len(found["hinges"]) == len(scene.hinges)
        mass = sum(body["mass"] for body in found["bodies"])
        mass += sum(beam["mass"] * beam["length"] for beam in found["elements"])
        assert mass == pytest.approx(report.mass(scene))
        assert len(case.tasks(structure, 1)) == 1 + len(case.meshes)


def test_loops_are_told_with_the_slip_of_the_start():
    scene = load(structures.FOLDER / "solar_array.yaml").build()
    root, belt = describe(scene, ("Friction", "Latch"))["loops"]
    assert root["hinges"] == [0, 1] and belt["hinges"] == [1, 2]
    assert root["radii"] == [0.06, 0.03] and root["slip"] == 0.0


def test_peers_are_not_told_half_of_a_structure():
    scene = load(structures.FOLDER / "solar_array.yaml").build()
    with pytest.raises(ValueError, match=r"cannot be told of \['Latch'\]"):
        describe(scene, ("Friction",))


def test_ratios_are_of_runs_that_agree():
    ours = structures.Run(np.zeros((2, 3)), 10, 1e-3, 4e-3, 5e-4, 1e-3)
    runs = [
        (off, {"name": f"step {step}", "cpu": cpu, "building": 1e-3, "version": "1"})
        for off, step, cpu in ((1e-1, 3, 1e-3), (5e-4, 2, 5e-3), (1e-5, 1, 8e-2))
    ]
    found = {row.name.rsplit(", ", 1)[1]: row.value for row in
             structures._ratios(structures.CASES[0], ours, 1e-4, runs)}  # fmt: skip
    assert found["a sample of a batch"] == pytest.approx(5.0)
    assert found["the time loops alone"] == pytest.approx(10.0)
    assert found["with building the scenes"] == pytest.approx(3.0)
    assert found["as accurate"] == pytest.approx(80.0)
    assert structures._ratios(structures.CASES[0], ours, 1e-4, runs[:1]) == []


def test_the_description_of_the_linkage_fits_together():
    scene = linkages(1, 3)[0]
    told_scene = describe(scene, ignore=("Contact",))
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


@pytest.mark.slow
def test_memory_of_a_run_is_read_from_another_process():
    grown, before = kernel._measure_growth(11, 20, kernel.stable(linkages(1)))
    assert before > 1000 and grown >= 0


def test_busy_time_counts_an_instant_once():
    assert campaigns.union([(0.0, 2.0), (1.0, 3.0), (5.0, 6.0)]) == 4.0
    assert campaigns.union([]) == 0.0


def test_the_timed_scenes_hold_together():
    assert {kind for case in kinds.CASES.values() for kind in case} == set(scenes.KINDS)
    for case in kinds.CASES.values():
        scene = scenes.bars(2, *case)
        assert fpm.find_stable_step(scene).step > 0
