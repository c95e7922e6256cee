"""Peaks between recorded instants, against closed forms: what is shorter than their distance."""

from __future__ import annotations

import numpy as np
import pytest
from stored_runs import curves_in

from deployable.campaign import check_config
from deployable.campaign.plan.plan import make_plan
from deployable.campaign.runs.batch import Simulation
from deployable.campaign.runs.store import open_store
from fpm.reading.events import peak

BODY = "{mass: 1, centre: o, inertia: [1, 1, 1]}"
STRUCTURE = f"""
name: peaks
parameters: {{r: {{value: 1, range: [0.1, 10]}}}}
points: {{o: [0, 0, 0]}}
bodies: {{led: {BODY}, falls: {BODY}, swings: {BODY}}}
joints:
  fall: {{type: revolute, parts: [ground, falls], at: o, axis: x, opening: 0.01 rad}}
  swing: {{type: revolute, parts: [ground, swings], at: o, axis: y, opening: 0.01 rad}}
curves:
  pulse: {{times: [0.0511, 0.0513, 0.0533, 0.0535], values: [0, 1, 1, 0]}}
drives: {{d: {{part: led, at: o, velocity: [0, 0, 10*r*(1 m/s)], curve: pulse}}}}
actions:
  weight: {{type: torque motor, joint: fall, torque: -9.81 N m}}
  floor: {{type: stop, joint: fall, lower: 0, stiffness: 3e4*r*(1 N m/rad)}}
  spring: {{type: torsion spring, joint: swing, stiffness: 1.6e5*r*(1 N m/rad), rest: 0}}
record: {{led: {{part: led, at: o}}}}
"""
RESPONSES = {
    "pulse": {"velocity": "led", "component": "z"},
    "blow": {"joint_moment": "fall", "part": "stop"},
    "depth": {"opening": "fall"},
    "wave": {"opening_rate": "swing"},
}
KINKED = f"""
name: kinked
parameters: {{r: {{value: 1, range: [0.1, 10]}}}}
points: {{o: [0, 0, 0]}}
bodies: {{turns: {BODY}}}
joints: {{turn: {{type: revolute, parts: [ground, turns], at: o, axis: z}}}}
curves: {{stop: {{expression: u**3, over: [0, 0.0373]}}}}
actions: {{motor: {{type: motor, joint: turn, turn: r*(1 rad), curve: stop}}}}
"""


def exact(r: np.ndarray) -> np.ndarray:
    """Peaks of the responses (R, 4): of a pulse; of a stop's moment and its depth after a fall of
    10 mrad; of an oscillation, 16 ms long."""
    g, k = 9.81, 3e4 * r
    depth = g / k + np.sqrt((g / k) ** 2 + 2 * g * 0.01 / k)
    return np.transpose([10 * r, k * depth, -depth, 0.01 * np.sqrt(1.6e5 * r)])


@pytest.fixture
def config(tmp_path) -> dict:
    """Of a campaign with 10 ms between its instants."""
    (tmp_path / "peaks.yaml").write_text(STRUCTURE, encoding="utf-8")
    (tmp_path / "kinked.yaml").write_text(KINKED, encoding="utf-8")
    names = {name: {"smallest" if name == "depth" else "largest": name} for name in RESPONSES}
    return {
        "campaign": "peaks",
        "scene": {"file": str(tmp_path / "peaks.yaml")},
        "solver": {"duration": 0.12, "instants": 13},
        "intervals": {"r": {"relative": 0.3}},
        "design": {"method": "smolyak", "order": 1},
        "responses": RESPONSES,
        "quantities": {f"{name}_peak": definition for name, definition in names.items()},
    }


def simulated(config, keep, folder):
    """Plan of a config, and the records of its runs, from a store."""
    plan = make_plan(check_config(config).experiment)
    store = open_store(keep, folder, plan.experiment)
    store.write(plan.unique_runs, Simulation(plan, 8).results(plan.unique_runs))
    records = store.read(plan.unique_runs)
    return plan, [records[run.id] for run in plan.unique_runs]


@pytest.mark.parametrize("keep", ["trajectories", "responses"])
def test_peaks_that_recorded_instants_miss_are_exact(config, tmp_path, keep):
    plan, records = simulated(config, keep, tmp_path)
    expected = exact(plan.unique_runs.values[:, 0])
    np.testing.assert_allclose([record.numbers for record in records], expected, rtol=2e-3)
    curves = np.array([record.values for record in records])
    assert curves.shape[1:] == (4, 13)
    assert (curves[:, :2].max(axis=-1) < 0.9 * expected[:, :2]).any(axis=0).all()
    if keep == "responses":
        return
    assert {len(curves.time) for curves in curves_in(tmp_path).values()} == {13}
    for more, is_missing in (({"final": "blow"}, False), ({"smallest": "blow"}, True)):
        quantities = {**config["quantities"], "more": more}
        experiment = check_config({**config, "quantities": quantities}).experiment
        runs = make_plan(experiment).unique_runs
        assert len(open_store(keep, tmp_path, experiment).missing(runs)) == is_missing * len(runs)


def test_times_and_means_of_what_recorded_instants_miss_are_right(config, tmp_path):
    """Of a pulse of 10 r m/s with edges of 0.2 ms: no recorded instant lies within it."""
    config["quantities"] = {
        "rises": {"crossing": "pulse", "level": 5.0, "way": "rising"},
        "again": {"crossing": "pulse", "level": 5.0, "way": "rising", "number": 2},
        "falls": {"settling": "pulse", "within": 5.0, "about": 0.0},
        "mean": {"mean": "pulse"},
        "rms": {"rms": "pulse"},
        "top": {"value": "pulse", "at": 0.0523},
        "after": {"value": "pulse", "at": 0.3},
    }
    plan, records = simulated(config, "trajectories", tmp_path)
    r = plan.unique_runs.values[:, 0]
    edge, none = 0.2e-3 * 5 / (10 * r), np.full(len(r), np.nan)
    rms = 10 * r * np.sqrt((2e-3 + 2 / 3 * 0.2e-3) / 0.12)
    expected = [
        0.0511 + edge, none, 0.0535 - edge, 10 * r * 2.2e-3 / 0.12, rms, 10 * r, none
    ]  # fmt: skip
    numbers = np.array([record.numbers for record in records])
    np.testing.assert_allclose(numbers[:, :3], np.transpose(expected[:3]), rtol=0, atol=5e-5)
    np.testing.assert_allclose(numbers[:, 3:], np.transpose(expected[3:]), rtol=2e-2)
    margins = np.array([record.margins for record in records])
    np.testing.assert_allclose(margins[:, 0], np.minimum(5.0, 10 * r - 5.0), rtol=1e-2)
    assert (margins[:, 1] < 0).all()


@pytest.mark.slow
def test_a_rate_that_ends_at_once_is_read_just_before(config, tmp_path):
    """At an instant and beside it the rate is the mean of what it is before and after."""
    config["scene"] = {"file": str(tmp_path / "kinked.yaml")}
    config["solver"]["step"] = 1e-3
    config["responses"] = {"rate": {"opening_rate": "turn"}}
    config["quantities"] = {"top": {"largest": "rate"}}
    plan, records = simulated(config, "responses", tmp_path)
    expected = 3 * plan.unique_runs.values / 0.0373
    np.testing.assert_allclose([record.numbers for record in records], expected, rtol=1e-3)


def test_the_first_peak_that_is_asked_for_later_takes_new_runs(config):
    def ids(**quantities):
        plan = make_plan(check_config({**config, "quantities": quantities}).experiment)
        return {run.id for run in plan.runs}

    end, top = {"final": "blow"}, {"largest": "blow"}
    assert ids(end=end) == ids(end=end, last={"final": "wave"})
    assert not ids(end=end) & ids(end=end, top=top)


def test_readings_divide_the_steps_between_instants_evenly(config):
    config["solver"] |= {"step": 1e-5, "peak_instants": 5000}
    experiment = check_config(config).experiment
    assert experiment.readings(1e-5) == 250  # of 1000 steps: pulses ask for no more than 600
    assert experiment.readings(1e-2) == 1
    config["quantities"] = {"end": {"final": "blow"}}
    assert check_config(config).experiment.readings(1e-5) == 0


@pytest.mark.parametrize(("shift", "jump"), [(0.1, False), (0.4, False), (0.3, True)])
def test_a_parabola_does_not_go_beyond_a_jump(shift, jump):
    """A smooth peak lies between instants; before a jump there is no peak beyond the curve."""
    places = np.arange(-6.0, 6.0) + shift
    values = np.where(jump & (places > 0), 0.0, 10 - places**2 + 3 * jump * places)
    assert peak(values) == pytest.approx(values.max() if jump else 10.0, abs=0.05)
