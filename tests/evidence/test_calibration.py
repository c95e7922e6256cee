"""The calibration of K_F: its campaign, its measures, its files, and the scene's defaults."""

import json
import math

import numpy as np
import pytest

import fpm
from studies import calibration, calibration_report
from studies.calibration import PAPER, Numbers, Reading, Scan

COARSE = Reading("coarse", (("elements_per_link", 2), ("start_deg", 3.0)))
MESH_8 = Reading("mesh 8", (("elements_per_link", 8), ("start_deg", 3.0)))


@pytest.fixture(scope="module")
def coarse() -> list[Scan]:
    return calibration.scan([(COARSE, [4.0, 5.5, 6.5])])


def numbers(k: float, bd: float, velocity: float, at=(0.95, 0.95)) -> Numbers:
    return Numbers(
        k,
        {"BD": bd, "vBz": velocity},
        dict(zip(PAPER, at, strict=True)),
        {"BD": 0.001, "vBz": 0.1},
        {"BD": 0.7, "vBz": 9.0},
        ((0.31, 0.94), (0.32, 0.96)),
        1e-5,
    )


def test_the_chosen_readings_give_the_papers_numbers():
    (result,) = calibration.campaign(MESH_8, [5.5], 5.5)
    assert result.fits
    assert result.misfit < 0.2
    assert result.at_second_closure
    assert {len(c) for c in result.closures} == {2}
    # "the upper and lower boundary curves essentially coincide" before the first closure
    for name in PAPER:
        assert result.early[name] < 0.05 * result.span[name]


def test_scene_has_the_calibrated_defaults():
    assert calibration.default("K_F") == 5.5
    assert calibration.default("start_deg") == 3.0
    assert calibration.default("supports") == "plane"


def test_number_of_closures_and_their_scaling(coarse):
    soft, middle, stiff = coarse[0].numbers
    assert {len(c) for c in soft.closures} == {1}
    assert {len(c) for c in middle.closures} == {len(c) for c in stiff.closures} == {2}
    ratio = middle.closure(0).mean() / stiff.closure(0).mean()
    assert ratio == pytest.approx(math.sqrt(6.5 / 5.5), rel=2e-3)
    assert np.isnan(soft.closure(1)).all()


def test_widths_are_those_of_the_cubic_through_the_four_runs(coarse):
    """Written out once more, with numpy's polynomials and a fine scan."""
    unit = np.cos((2 * np.arange(4) + 1) * np.pi / 8)
    scene = fpm.scenes.get("bennett")
    scenes = [
        scene.build(a=0.035 * (1 + 0.01 * u), K_F=5.5, elements_per_link=2, start_deg=3.0)
        for u in unit
    ]
    runs = fpm.simulate(
        scenes, duration=1.0, instants=2001, step=calibration.time_step(COARSE, 6.5)
    )
    curves = np.array([run.points["B"][1][:, 2] for run in runs])
    fits = np.polynomial.polynomial.polyfit(unit, curves, 3)
    values = np.polynomial.polynomial.polyval(np.linspace(-1, 1, 2001), fits)
    width = np.ptp(values, axis=1)
    middle = coarse[0].numbers[1]
    assert middle.largest["vBz"] == pytest.approx(width.max(), rel=1e-5)
    assert middle.at["vBz"] == pytest.approx(runs[0].time[width.argmax()], abs=1e-12)


def test_numbers_do_not_depend_on_workers_or_on_neighbours(coarse):
    again = calibration.scan([(COARSE, [5.5, 6.5])], workers=2)
    assert again[0].numbers == coarse[0].numbers[1:]


def test_misfit_and_fit():
    assert numbers(5, 0.063, 4.38).misfit == 0
    assert numbers(5, 0.063 * math.exp(0.3), 4.38 * math.exp(-0.4)).misfit == pytest.approx(0.5)
    assert numbers(5, 0.063 * 1.24, 4.38 * 0.76).fits
    assert not numbers(5, 0.063 * 1.26, 4.38).fits
    assert not numbers(5, 0.063, 4.38 * 0.74).fits
    assert not numbers(5, 0.063, 4.38, at=(1.0, 0.95)).at_second_closure


def test_scan_tells_how_sharp_the_fit_is():
    values = [(5.0, 0.04), (5.1, 0.058), (5.2, 0.06), (5.3, 0.0604), (5.4, 0.1)]
    scan = Scan(Reading("made up"), [numbers(k, bd, 4.38) for k, bd in values])
    assert scan.best.K_F == 5.3
    assert scan.at(5.12).K_F == 5.1
    assert calibration_report.spans(scan.K_F, scan.fits) == [[5.1, 5.3]]
    assert calibration_report.spans(scan.K_F, scan.within(0.2)) == [[5.2, 5.3]]
    assert calibration_report.spans(scan.K_F, scan.misfit < 0) == []


def test_half_angle_at_b():
    start = calibration.start_of_half_angle(22.5)
    scene = fpm.scenes.get("bennett").build(start_deg=start, elements_per_link=2)
    # Links AB, BC of three particles each, both from their A side to their B side.
    bars = [scene.position[i + 2] - scene.position[i] for i in (0, 3)]
    cosine = bars[0] @ bars[1] / np.linalg.norm(bars[0]) / np.linalg.norm(bars[1])
    assert math.degrees(math.acos(cosine)) == pytest.approx(45.0, abs=1e-3)


def test_rows_can_fail():
    assert calibration_report.row("x", 1.09, 1.0, 0.1, "here").passed
    assert not calibration_report.row("x", 1.11, 1.0, 0.1, "here").passed
    assert not calibration_report.row("x", -0.2, 0.0, 0.1, "here", share=False).passed
    assert not calibration_report.row("x", math.nan, 1.0, 0.1, "here").passed


def test_plan_has_every_open_reading():
    readings = {reading.label: values for reading, values in calibration_report.plan()}
    assert next(iter(readings)) == "default"
    text = " ".join(readings)
    for word in ("32 elements", "start 1°", "free", "pinned", "μ_B", "step"):
        assert word in text
    assert any(np.isclose(calibration.default("K_F"), values).any() for values in readings.values())


def test_files(coarse, tmp_path):
    mesh = Scan(Reading("32 elements a link"), coarse[0].numbers)
    near = [numbers(float(k), 0.06, 4.0) for k in calibration_report.NEAR]
    scans = [Scan(Reading("default"), near), mesh, Scan(Reading("A pinned"), near)]
    calibration_report.write(scans, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    first = summary["rows"][0]
    assert {"name", "value", "reference", "tolerance", "passed", "source"} <= set(first)
    assert first["value"] == 0.06 and first["reference"] == 0.063 and first["passed"]
    assert [r["reading"] for r in summary["readings"]] == [s.reading.label for s in scans]
    assert "| A pinned |" in (tmp_path / "table.md").read_text()
    for name in ("numbers", "misfit", "closures"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")
