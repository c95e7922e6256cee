"""The benchmark runs and tells well-formed rows; how fast anything is, is not tested."""

import json
import math

import numpy as np
import pytest

from evidence.benchmark.peers import compare
from evidence.benchmark.peers.description import describe
from evidence.benchmark.scenes import beam_count, linkages
from evidence.rows import Row


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


def test_exudyn_is_skipped_with_the_command_where_it_is_not_installed(monkeypatch):
    monkeypatch.setattr(compare, "interpreter", lambda: None)
    rows = compare.exudyn(0.001, 1)
    check(rows)
    assert len(rows) == 1 and "pip install" in rows[0].skipped


@pytest.mark.slow
def test_exudyn_runs_where_it_is_installed():
    if compare.interpreter() is None:
        pytest.skip("exudyn is not installed, and EXUDYN_PYTHON is not set")
    check(compare.exudyn(0.002, 1, cases=1))


def test_the_description_of_the_linkage_fits_together():
    scene = linkages(1, 3)[0]
    told_scene = describe(scene)
    assert len(told_scene["elements"]) == beam_count(scene) == 12
    mass = sum(beam["mass"] * beam["length"] for beam in told_scene["elements"])
    assert mass == pytest.approx(scene.mass.sum())
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
