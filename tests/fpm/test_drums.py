"""Drums that wind cables, tensions and slips along cables, posts that turn, arms under tension."""

import numpy as np
import pytest

import fpm
from fpm.elements import TorqueMotor
from fpm.reading.responses import parse
from fpm.structures import loads

G, MASS, SPIN = 9.81, 2.0, 0.01
TEXT = """
name: hoist
gravity: [0, 0, -9.81 m/s2]
parameters:
  r: {value: 50, unit: mm}
  M: {value: 3, unit: N m}
  start: {value: 0, unit: rad}
  EA: {value: 10, unit: kN}
points: {O: [0, 0, 0], load: [0, 0, -1 m]}
bodies:
  reel: {mass: 1 kg, centre: O, inertia: [0.005, 0.01, 0.005]}
  weight: {mass: 2 kg, centre: load, box: [0.1 m, 0.1 m, 0.1 m]}
joints:
  winch: {type: revolute, parts: [ground, reel], at: O, axis: y, opening: start}
actions:
  motor: {type: torque motor, joint: winch, torque: M}
cables:
  rope: {through: [{part: ground, at: O}, load], EA: EA, preload: 19.62 N, drum: winch, radius: r}
record: {load: {part: weight, at: load}}
"""


def hoist(torque=0.0, **cable) -> fpm.Scene:
    """A drum at the origin, on the ground, which winds a cable over a point of it with a weight."""
    scene = fpm.Scene("hoist", gravity=(0, 0, -G))
    base, reel = (int(p) for p in scene.add_particles(np.zeros((2, 3)), 1.0, SPIN))
    scene.fix(base)
    weight = int(scene.add_particles((1, 0, -1.0), MASS, 1.0)[0])
    winch = scene.add_hinge("winch", (base, reel), (0, 0, 0), (0, 1, 0))
    scene.add(TorqueMotor(winch, torque))
    points = [(base, None), (base, (1, 0, 0)), (weight, None)]
    scene.add_cable("rope", points, 1e5, preload=MASS * G, drum=winch, radius=0.05, **cable)
    scene.add_point("load", weight)
    return scene


@pytest.mark.slow
def test_what_is_too_much_for_a_cable_on_a_drum_is_named():
    (outcome,) = fpm.simulate(hoist(3.0, least=1.9), duration=0.3, instants=31)
    assert outcome.failure.cause == "drum"
    assert "shortest" in str(outcome.failure) and "cable rope" in str(outcome.failure)


@pytest.mark.slow
def test_arms_under_tension_count_in_the_stable_step():
    """A light body that a soft cable pulls at a short arm: a pendulum under that tension."""
    scene = fpm.Scene("arm", gravity=(0, 0, -G))
    top, body = (int(p) for p in scene.add_particles([(0, 0, 1.0), (0, 0, -0.02)], [1, 4], 1e-4))
    scene.fix(top)
    scene.add_cable("soft", [(top, None), (body, (0, 0, 0))], 50.0, preload=4 * G)
    scene.spin[body] = (1e-3, 0, 0)
    limit = fpm.find_stable_step(scene)
    assert limit.frequency**2 > (4 * G * 0.02 + 4 * G * 0.02**2) / 1e-4
    for factor, fails in ((0.99, False), (1.2, True)):
        step = factor * limit.step
        (outcome,) = fpm.simulate(scene, duration=2000 * step, instants=3, step=step)
        assert (outcome.failure is not None) == fails


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("radius: r", "radius: 0 m", "cables.rope.radius"),
        (", radius: r", "", "a length other than 0 with a `drum`"),
        ("drum: winch, ", "", "a length other than 0 with a `drum`, none without"),
        ("drum: winch, radius: r", "shortest: 0.1 m", "cables.rope.shortest"),
        ("radius: r", "radius: r, shortest: 2 m", "below the unstrained length at the start"),
        ("drum: winch", "drum: wheel", "cables.rope.drum"),
        ("drum: winch", "drum: winch, curve: c", "cables.rope.drum"),
        ("drum: winch", "drum: rail", "cables.rope.drum"),
    ],
)
def test_what_is_refused(old, new, problem):
    text = TEXT.replace("cables:", "curves: {c: {times: [0, 1], values: [0, 1]}}\ncables:")
    rail = "  rail: {type: prismatic, parts: [ground, weight], at: load, axis: z}\nactions:"
    text = text.replace("actions:", rail)
    with pytest.raises(fpm.SceneError, match=problem):
        loads(text.replace(old, new)).build()


def test_stretches_and_points_are_asked_for_by_number():
    scene = hoist()
    response = parse("pull", {"tension": "rope", "stretch": 2}, scene)
    assert response.columns == (("stretch_tension", "rope 2"),)
    assert response.long_name == "tension of stretch 2 of cable rope"
    assert parse("way", {"slip": "rope", "point": 2}, scene).unit == "m"
    for definition, words in (
        ({"tension": "rope", "stretch": 3}, "1 to 2"),
        ({"slip": "rope", "point": 1}, "2 to 2"),
        ({"slip": "rope", "point": True}, "2 to 2"),
        ({"slip": "rope"}, "slip and point"),
    ):
        with pytest.raises(fpm.SceneError, match=words):
            parse("x", definition, scene)
