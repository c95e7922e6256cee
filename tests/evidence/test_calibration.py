"""The calibration of K_F: its campaign, its measures, its files, and the scene's defaults."""

import json
import math
from dataclasses import asdict

import numpy as np
import pytest

from deployable.campaign.config.sections import scene_type
from evidence.calibration import plan, scans, study
from evidence.calibration.findings import spans
from evidence.calibration.scans import PAPER, Numbers, Reading, Scan
from evidence.results import write

COARSE = Reading("coarse", (("elements", 2), ("start", 3.0)))
MESH_8 = Reading("mesh 8", (("elements", 8), ("start", 3.0)))


@pytest.fixture(scope="module")
def coarse() -> Scan:
    return scans.scan(COARSE, [4.0, 5.5, 6.5])


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
    (result,) = scans.campaign(MESH_8, [5.5], 5.5)
    assert result.fits
    assert result.misfit < 0.2
    assert result.at_second_closure
    assert {len(c) for c in result.closures} == {2}
    # "the upper and lower boundary curves essentially coincide" before the first closure
    for name in PAPER:
        assert result.first_width[name] < 0.05 * result.span[name]


def test_number_of_closures_and_their_scaling(coarse):
    soft, middle, stiff = coarse.numbers
    assert {len(c) for c in soft.closures} == {1}
    assert {len(c) for c in middle.closures} == {len(c) for c in stiff.closures} == {2}
    ratio = middle.closure(0).mean() / stiff.closure(0).mean()
    assert ratio == pytest.approx(math.sqrt(6.5 / 5.5), rel=2e-3)
    assert np.isnan(soft.closure(1)).all()


def test_numbers_do_not_depend_on_neighbours_or_on_the_file_they_went_through(coarse):
    again = scans.scan(COARSE, [5.5, 6.5])
    assert again.numbers == coarse.numbers[1:]
    kept = json.loads(json.dumps(asdict(coarse), allow_nan=False))
    assert scans.from_plain(kept) == coarse


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
    assert scan.numbers_at(5.12).K_F == 5.1
    assert spans(scan.K_F, scan.fits) == [[5.1, 5.3]]
    assert spans(scan.K_F, scan.misfit < 0) == []


def test_half_angle_at_b():
    start = plan.start_of_half_angle(22.5)
    scene = scene_type("bennett").build(start=start, elements=2)
    # Links AB, BC of three particles each, both from their A side to their B side.
    bars = [scene.position[i + 2] - scene.position[i] for i in (0, 3)]
    cosine = bars[0] @ bars[1] / np.linalg.norm(bars[0]) / np.linalg.norm(bars[1])
    assert math.degrees(math.acos(cosine)) == pytest.approx(45.0, abs=1e-3)


def test_files(coarse, tmp_path):
    mesh = Scan(Reading("32 elements a link"), coarse.numbers)
    near = [numbers(float(k), 0.06, 4.0) for k in plan.GRID]
    made = [Scan(Reading("default"), near), mesh, Scan(Reading("A pinned"), near)]
    write(tmp_path, "calibration", study.report({"all": [asdict(scan) for scan in made]}))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    first = summary["rows"][0]
    assert first["value"] == 0.06 and first["reference"] == 0.063 and first["passed"]
    assert [r["reading"] for r in summary["readings"]] == [s.reading.label for s in made]
    assert "| A pinned |" in (tmp_path / "table.md").read_text(encoding="utf-8")
