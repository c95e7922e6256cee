"""Supports, drives and bodies of text structures: what they bear, by name, against closed forms."""

import numpy as np
import pytest

import fpm
from fpm import structures

own_loop = pytest.mark.slow  # a time loop of its own

G, PUSH = 9.81, 1.5  # m/s²: weight, and the acceleration of the cart

TEXT = f"""
name: carried
gravity: [0, 0, -{G}]
parameters:
  push: {{value: {PUSH}, unit: m/s2, range: [0, 10], description: acceleration of the cart}}
let:
  angle: atan2(push, {G} m/s2)
  slender: (1 kg m2)/12
points:
  cart: [0, 0, 0]
  middle: [-(0.5 m)*sin(angle), 0, -(0.5 m)*cos(angle)]
  nail: [5, 0, 0]
  beside: [5.5, 0, 0]
  block: [9, 0, 0]
bodies:
  cart: {{mass: 2, centre: cart, box: [0.2, 0.2, 0.2]}}
  hanging: {{mass: 1, centre: middle, points: [cart], inertia: [0.1, 0.1, 0.1]}}
  rod: {{mass: 1, centre: beside, points: [nail], inertia: [1e-9, slender, slender]}}
  block: {{mass: 3, centre: block, box: [0.1, 0.2, 0.3]}}
joints:
  pin: {{type: revolute, parts: [cart, hanging], at: cart, axis: -y}}
supports:
  nail: {{part: rod, at: nail, rotations: none}}
  rail: {{part: block, at: block, translations: z}}
curves:
  ramp: {{times: [0, 10], values: [0, 10]}}
drives:
  track: {{part: cart, at: cart, velocity: ["push*(1 s)", 0, 0], curve: ramp}}
loads:
  aside: {{part: block, at: block, force: [0, 0.3, 0]}}
record:
  end: {{part: rod, at: beside}}
  block: {{part: block, at: block}}
"""


def definitions(structure) -> list:
    found = {}
    for axis in "xyz":
        for name in ("nail", "rail", "track"):
            found[f"F {name} {axis}"] = {"reaction_force": name, "component": axis}
        for name in ("rail", "track"):
            found[f"M {name} {axis}"] = {"reaction_moment": name, "component": axis}
        found[f"pin {axis}"] = {"constraint_force": "pin", "component": axis}
        found[f"w {axis}"] = {"angular_velocity": "rod", "component": axis}
        found[f"a {axis}"] = {"acceleration": "block", "component": axis}
    return [fpm.responses.parse(name, d, structure.sample) for name, d in found.items()]


@pytest.fixture(scope="module")
def run():
    structure = structures.loads(TEXT)
    responses = definitions(structure)
    record = [need for response in responses for need in response.needs]
    (outcome,) = fpm.simulate(
        structure.build(), duration=0.5, instants=101, step=1e-3, record=record
    )
    assert outcome.failure is None
    found = {response.name: response.evaluate(outcome) for response in responses}
    return outcome, lambda name: np.stack([found[f"{name} {axis}"] for axis in "xyz"], axis=1)


@own_loop
def test_a_drive_pushes_what_it_moves_and_carries_its_weight(run):
    """Cart and load in relative equilibrium: (M + m) a and (M + m) g; 1e-4 of the weight."""
    _, vector = run
    expected = np.array([3 * PUSH, 0.0, 3 * G])
    np.testing.assert_allclose(vector("F track"), np.tile(expected, (101, 1)), atol=1e-4 * 3 * G)
    np.testing.assert_allclose(vector("M track"), 0.0, atol=1e-4)
    pin = np.array([PUSH, 0.0, G])
    np.testing.assert_allclose(vector("pin"), np.tile(pin, (101, 1)), atol=1e-4 * 3 * G)


@own_loop
def test_a_point_that_is_held_bears_a_swinging_rod(run):
    """As a hinge would: m g (5 cos θ - 3 cos θ0)/2 along and m g sin θ/4 across, from θ0 = 90°; and
    ω² = 3 g cos θ/L."""
    outcome, vector = run
    arm = outcome.points["end"][0] - np.array([5.0, 0, 0])
    cos, sin = -arm[:, 2] / 0.5, arm[:, 0] / 0.5
    away = arm / 0.5
    across = np.stack([cos, 0 * cos, sin], axis=1)
    expected = -(2.5 * G * cos)[:, None] * away + (0.25 * G * sin)[:, None] * across
    np.testing.assert_allclose(vector("F nail"), expected, atol=2e-4 * G)
    square = 3 * G * cos
    np.testing.assert_allclose((vector("w") ** 2).sum(1), square, atol=2e-4 * square.max())


@own_loop
def test_what_is_held_along_one_axis_is_free_along_the_others(run):
    _, vector = run
    np.testing.assert_allclose(vector("F rail"), np.tile([0, 0, 3 * G], (101, 1)), atol=1e-9)
    np.testing.assert_allclose(vector("M rail"), 0.0, atol=1e-9)
    np.testing.assert_allclose(vector("a"), np.tile([0, 0.1, 0], (101, 1)), atol=1e-9)


def test_names_that_are_not_there_are_refused_with_those_that_are():
    structure = structures.loads(TEXT)
    for definition, names in (
        ({"reaction_force": "wall", "component": "x"}, "one of block, nail, rail, track"),
        ({"angular_velocity": "wheel", "component": "x"}, "end, block, cart, hanging, rod"),
        ({"stress": "beam"}, "only these have stress, and bodies are rigid"),
        ({"clearance": ["a", "b"]}, "(there is none)"),
        ({"constraint_force": "pin"}, "constraint_force and component"),
        ({"opening_rate": "pin", "component": "x"}, "opening_rate alone"),
    ):
        with pytest.raises(fpm.SceneError, match=names):
            fpm.responses.parse("r", definition, structure.sample)
