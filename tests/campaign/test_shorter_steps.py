"""Runs whose energy does not balance at the step that the program chose are repeated with half."""

import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from deployable import campaign
from deployable.campaign.text import numbers
from fpm.structures import load

STRUCTURE = """
name: hit
parameters: {play: {value: 0.1, unit: rad, range: [0, 1], description: of the drive}}
points: {root: [0, 0, 0]}
bodies: {arm: {mass: 1, centre: root, inertia: [1, 1, 1]}}
joints: {hinge: {type: revolute, parts: [ground, arm], at: root, axis: z, opening: 0}}
curves: {go: {times: [0, 20 ms], values: [0, 1], smooth: true}}
actions:
  drive: {type: motor, joint: hinge, curve: go, turn: 1 rad, stiffness: 2000, backlash: play}
"""

CAMPAIGN = """
campaign: hit
scene: {file: hit.yaml}
solver: {duration: 0.2, instants: 11, energy_tolerance: 0.0005}
intervals: {play: {lower: 0.05, upper: 0.15}}
design: {method: smolyak, order: 2}
verify: {max_iterations: 1, discretization: true}
jobs: {keep: responses}
responses: {th: {opening: hinge}}
quantities: {x: {value: th, at: 0.1}}
"""


def opening(play: float) -> float:
    """The opening at 0.1 s, by another solver."""

    def slope(time, state):
        u = min(time / 0.02, 1.0)
        error = u * u * (3 - 2 * u) - state[0]
        return [state[1], 2000 * np.sign(error) * max(abs(error) - play / 2, 0.0)]

    return float(solve_ivp(slope, (0, 0.1), [0, 0], rtol=1e-9, max_step=1e-4).y[0, -1])


@pytest.mark.slow
def test_such_runs_are_repeated_and_the_result_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hit.yaml").write_text(STRUCTURE)
    (tmp_path / "hit_c.yaml").write_text(CAMPAIGN)
    times = {"duration": 0.2, "instants": 11, "energy_tolerance": 0.0005}
    scene = load(tmp_path / "hit.yaml").build()
    (failed,) = fpm.simulate(scene, halvings=0, **times)
    (repeated,) = fpm.simulate(scene, **times)
    assert isinstance(failed.failure, fpm.InstabilityError) and repeated.failure is None
    assert np.log2(failed.step / repeated.step) % 1 == 0
    campaign.run(str(tmp_path / "hit_c.yaml"), figures=False)
    facts = json.loads((tmp_path / "results/hit/summary.json").read_text())
    assert facts["finest_step"] < 0.6 * facts["time_step"]
    text = (tmp_path / "results/hit/summary.md").read_text()
    assert "energy did not balance or whose joints opened were repeated" in text
    (quantity,) = facts["quantities"]
    exact = [opening(play) for play in (0.05, 0.1, 0.15)]
    error = 1.5 * quantity["error_whole"]
    assert quantity["error_step"] > 0
    row = next(line for line in text.splitlines() if "| simulated" in line)
    assert f"| {numbers.quantity(quantity['error_whole'], quantity['units'], 2)} |" in row
    assert quantity["lower"] - error < min(exact) < quantity["lower"] + error
    assert quantity["upper"] - error < max(exact) < quantity["upper"] + error
