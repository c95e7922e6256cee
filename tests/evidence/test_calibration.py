"""The calibration of K_F: its campaign, its measures, its files, and the scene's defaults."""

import json
import math
from dataclasses import asdict

import numpy as np
import pytest

from evidence.calibration import scans
from evidence.calibration.scans import PAPER, Numbers, Reading, Scan

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
