"""Runs that fail: a crank on a motor pushes a slide by a rod of length L, and where L is below the
crank's 1 m it comes to a singular position. The place of the slide is known in closed form."""

from __future__ import annotations

import json

import numpy as np
import pytest

import fpm
from deployable import campaign
from deployable.campaign.config.sections import scene_type
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.results.run_samples import open_samples

pytestmark = pytest.mark.slow

STRUCTURE = """
name: crank
description: Crank of 1 m, led by a motor, that pushes a slide by a rod
parameters:
  L: {value: 1.475, unit: m, range: [0.5, 3], description: length of the rod}
let: {xs: 1 m + L}
points: {O: [0, 0, 0], A: [1 m, 0, 0], B: [xs, 0, 0]}
bodies:
  arm: {type: rod, from: O, to: A, mass: 1, diameter: 20 mm}
  link: {type: rod, from: A, to: B, mass: 1, diameter: 20 mm}
  block: {mass: 1, centre: B, box: [5 cm, 5 cm, 5 cm]}
joints:
  axle: {type: revolute, parts: [ground, arm], at: O, axis: y, opening: 0}
  pin: {type: revolute, parts: [arm, link], at: A, axis: y}
  wrist: {type: revolute, parts: [block, link], at: B, axis: y}
  guide: {type: prismatic, parts: [ground, block], at: B, axis: x, opening: 0}
curves:
  go: {expression: 10*u**3 - 15*u**4 + 6*u**5, over: [0, 2 s]}
actions:
  lead: {type: motor, joint: axle, turn: -90 deg, curve: go}
record:
  B: {part: block, at: B}
"""


NAMES = "axle", "pin", "wrist", "guide"
T = np.linspace(0, 2, 4001)


def angle(t):
    u = t / 2
    return np.pi / 2 * (10 * u**3 - 15 * u**4 + 6 * u**5)


def place(length, t):
    return np.cos(angle(t)) + np.sqrt(length**2 - np.sin(angle(t)) ** 2)


@pytest.fixture
def config(tmp_path):
    (tmp_path / "crank.yaml").write_text(STRUCTURE)
    return {
        "campaign": "crank",
        "scene": {"file": str(tmp_path / "crank.yaml")},
        "solver": {"duration": 2, "instants": 41, "step": 0.002, "failures": 0.3},
        "intervals": {"L": {"lower": 0.95, "nominal": 1.475, "upper": 2}},
        "design": {"method": "tensor_roots", "order": 8},
        "held_out": 4,
        "responses": {"x": {"position": "B", "component": "x"}},
        "quantities": {"end": {"value": "x", "at": 2}},
        "requirements": {"far": {"end": {"at_least": 0}}},
    }


def run(config, tmp_path):
    results = tmp_path / "results"
    bounds = campaign.run(config, results, figures=False, notify=lambda text: None)
    folder = results / "crank"
    return bounds, json.loads((folder / "summary.json").read_text()), folder


@pytest.mark.parametrize("instants", [21, 101])
def test_a_singular_position_is_told_at_the_programs_own_step(tmp_path, instants):
    """Whatever the gap is then: which joints, when, and that no shorter step helps."""
    (path := tmp_path / "crank.yaml").write_text(STRUCTURE)
    lengths = np.linspace(0.5, 0.99, 8)
    scenes = [scene_type(str(path), str(path)).build(L=float(length)) for length in lengths]
    step = 2 / (instants - 1)
    for length, outcome in zip(
        lengths, fpm.simulate(scenes, duration=2, instants=instants), strict=True
    ):
        text, reached = str(outcome.failure), np.interp(np.arcsin(length), angle(T), T)
        assert "reaches a singular position" in text and "halve" not in text
        assert all(name in text.split("of joints")[1] for name in NAMES)
        assert reached - step / 2 < outcome.failure.time < reached + step


def test_runs_that_fail_are_told_and_count_against_the_requirements(config, tmp_path):
    config["jobs"], config["solver"]["failures"] = {"keep": "responses"}, 0.6
    bounds, facts, folder = run(config, tmp_path)
    assert {row["at"]["L"] < 1 for row in facts["failures"]} == {True}
    nodes = 1.475 - 0.525 * np.cos((np.arange(9) + 0.5) * np.pi / 9)
    planned = {round(x, 9) for x in (*nodes[nodes < 1], 0.95)}
    clear = [row for row in facts["failures"] if round(row["at"]["L"], 9) in planned]
    assert len(clear) == len(planned)
    for row in clear:  # noticed at the next recorded instant
        reached = np.interp(np.arcsin(row["at"]["L"]), angle(T), T)
        assert reached < row["time"] < reached + 0.051
        assert "singular position" in row["reason"]
    assert facts["runs"]["failed"] == len(facts["failures"])
    together = facts["together"]
    assert together["met"] == "some"
    assert abs(together["share"] - 1 / 1.05) <= together["share_uncertainty"] < 0.3
    # Runs next to the border tell where it is: up to L = 1 m, of 0.95 to 1.475 m.
    assert together["max_interval_scale"] == pytest.approx(0.475 / 0.525, abs=2e-3)
    assert not together["unsampled"] and facts["runs"]["failed"] <= 0.6 * facts["runs"]["all"]
    lines = (folder / "summary.md").read_text().split("\n\n")
    assert lines[1].startswith("**Not everywhere") and "runs failed" in lines[2]
    time, length = bounds["time"].values, np.linspace(1, 2, 201)[:, None]
    curves = place(length, time)
    error = bounds["error"].values[0] + 1e-4  # of the step
    assert (bounds["lower"].values[0] - error <= curves.min(axis=0)).all()
    assert (bounds["upper"].values[0] + error >= curves.max(axis=0)).all()
    before = len(list((folder / "responses").iterdir()))
    run(config, tmp_path)
    assert len(list((folder / "responses").iterdir())) == before


def test_a_scan_leaves_failed_runs_out(config, tmp_path):
    config |= {"design": {"method": "sobol", "samples": 64}, "jobs": {"keep": "responses"}}
    del config["held_out"]
    _, facts, _ = run(config, tmp_path)
    with open_samples(Folder(tmp_path / "results" / "crank")) as samples:
        lengths = samples.table.values[:, 0]
        np.testing.assert_allclose(samples.table.numbers[:, 0], place(lengths, 2.0), atol=1e-3)
        low, high = samples.extreme_runs(0, 40)
    assert lengths.min() > 1 and [low, high] == [lengths.argmin(), lengths.argmax()]
    assert facts["design"]["runs"] == len(lengths) and facts["runs"]["failed"]


@pytest.mark.parametrize(("allowed", "nominal"), [(0.05, 1.475), (1.0, 0.96)])
def test_too_many_failures_or_a_nominal_one_end_the_campaign(config, tmp_path, allowed, nominal):
    config["solver"]["failures"] = allowed
    config["intervals"]["L"]["nominal"] = nominal
    cause = "solver.failures allows 0.05" if nominal > 1 else "the nominal run among them"
    with pytest.raises(CampaignError, match=cause) as caught:
        run(config, tmp_path)
    assert "L = 0.95" in str(caught.value) and "singular position" in str(caught.value)
