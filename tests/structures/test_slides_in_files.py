"""Slides and universal joints in structures' files: what acts on them, in their units."""

import pytest
from structures_for_tests import SMALL, problems_of

from fpm.elements import (
    Damper,
    Friction,
    Latch,
    Motor,
    Release,
    RigidLatch,
    Stop,
    TableSpring,
    TorqueMotor,
)
from fpm.scenes.scene_type import SceneType
from fpm.structures import loads
from fpm.structures.describe import describe
from fpm.structures.report import longer_steps

JOINTS = """
curves:
  ramp: {times: [0, 1 s], values: [0, 1]}
bodies:
  stage: {mass: 2, centre: C, points: [B], box: [1 m, 1 m, 1 m]}
joints:
  boom: {type: prismatic, parts: [ground, stage], at: C, axis: x, opening: 50 mm}
  knuckle:
    {type: universal, parts: [stage, arm], at: B, axis: x, other: y, openings: [5 deg, 0]}
"""
ACTIONS = """
actions:
  push: {type: spring, joint: boom, stiffness: 40 N/m, preload: 8 N}
  table: {type: tape spring, joint: boom, positions: [0, 1 m], forces: [5 N, 0]}
  oil: {type: damper, joint: boom, damping: 2 N s/m}
  dry: {type: friction, joint: boom, force: 0.5 N}
  ends: {type: stop, joint: boom, least: 0, most: 40 cm, stiffness: 1 kN/m}
  pin: {type: latch, joint: boom, position: 0.3 m, fastest: 2 m/s}
  lock: {type: latch, joint: boom, position: 0.2 m, tolerance: 1 mm, stiffness: 1 kN/m}
  drive: {type: motor, joint: boom, travel: 0.2 m, curve: ramp, stiffness: 100 N/m}
  pull: {type: torque motor, joint: boom, force: 3 N, no_load: 1 m/s}
  bend: {type: torsion spring, joint: knuckle_other, stiffness: 2 N m/rad}
  twist: {type: torsion spring, joint: knuckle_axis, stiffness: 4, preload: -1 N m}
  bolt: {type: release, joint: knuckle_axis, watch: boom, level: 0.1 m, stiffness: 5 N m/rad}
"""
TEXT = SMALL.replace("points:", "points:\n  C: [0, 1 m, 0]")
TEXT = TEXT.replace("joints:", JOINTS.strip()).replace("actions:", ACTIONS.strip())


def test_all_that_acts_on_slides_and_crosses_is_in_the_scene():
    scene = loads(TEXT).build()
    names = [hinge.name for hinge in scene.hinges]
    assert names == ["boom", "knuckle_axis", "knuckle_other", "root"]
    assert [hinge.opening for hinge in scene.hinges] == pytest.approx([0.05, 0.0872665, 0, 0])
    found = {kind: of[0] for kind, of in scene.kinds.items() if of}
    on = {kind: getattr(one, "hinge", None) for kind, one in found.items()}
    for kind in (Damper, Friction, Stop, RigidLatch, Latch, Motor, TorqueMotor, TableSpring):
        assert on[kind] == 0
    assert [(s.hinge, s.stiffness, s.rest) for s in scene.springs] == [
        (0, 40.0, 0.25), (2, 2.0, 0.0),
        (1, 4.0, pytest.approx(0.0872665 - 0.25)), (3, 3.0, pytest.approx(1.5707963))
    ]  # fmt: skip
    assert found[Friction].bend == 1e-4
    assert (found[Release].hinge, found[Release].watch, found[Release].level) == (1, 0, 0.1)


def test_the_command_lists_what_acts_and_what_makes_the_step_longer():
    text = describe(loads(TEXT))
    for line in (
        "  boom (slide, opening 0.05 m)",
        "  knuckle_axis (universal, opening 5 deg)",
        "  spring boom (on boom, stiffness 40 N/m, rest 0.25 m)",
        "  friction boom (on boom, force 0.5 N)",
        "  latch lock (on boom, position 0.2 m, stiffness 1000 N/m, tolerance 0.001 m)",
        "  release knuckle_axis (on knuckle_axis, stiffness 5 N m/rad, hold 5 deg, "
        "until boom passes 0.1 m)",
    ):
        assert line in text.splitlines(), line
    found = loads(SMALL.replace("value: 2, whole", "value: 6, whole"))
    assert isinstance(found, SceneType)
    ways = longer_steps(found, float(next(
        line.split()[2] for line in describe(found).splitlines() if line.startswith("stable")
    )))  # fmt: skip
    assert [(name, value) for name, value, _ in ways] == [("n", 3), ("L", pytest.approx(1.1))]
    assert ways[0][2] == pytest.approx(2.0, abs=0.1)
    assert "longer with n = 3 (x " in describe(found)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("40 N/m", "0", "above 0, with a `preload`"),
        ("stiffness: 2 N m/rad", "stiffness: 2, preload: 1 N", "allowed: a value in N m"),
        ("rest: 90 deg", "rest: 90 mm", "'90 mm' is m; allowed: an angle"),
        ("40 N/m", "40 N m/rad", "allowed: a value in N/m >= 0"),
        ("preload: 8 N", "preload: 8 N, rest: 1", "none, with a `preload`"),
        ("position: 0.3 m", "position: 20 deg", "allowed: a value in m"),
        ("position: 0.3 m", "angle: 0.3", "no such key on a slide, where it is position; allowed"),
        ("type: prismatic", "type: prismatik", "did you mean prismatic?"),
        ("type: prismatic", "type: sledge", "'sledge' is not allowed; allowed: revolute"),
        ("type: prismatic, ", "", "joints.boom.type: missing"),
        ("force: 0.5 N", "force: 0.5 N m", "allowed: a value in N >= 0"),
        ("force: 0.5 N", "force: 1, sticks: exactly", "by its bend, on a slide"),
        ("least: 0", "least: 1 m", "an opening below `most`, 0.4 m"),
        ("level: 0.1 m", "level: 0.1 rad", "allowed: a value in m"),
        ("joint: knuckle_other", "joint: knuckle", "knuckle_axis or knuckle_other"),
        ("joint: knuckle_other", "joint: boom", "for a slide there is `spring`"),
        ("type: spring, joint: boom", "type: spring, joint: root", "the name of a prismatic joint"),
        ("joint: knuckle_other", "joint: knuckel_other", "there is no joint 'knuckel_other'"),
        ("type: torque motor, joint: boom, force: 3 N, no_load: 1 m/s",
         "type: contact, joint: boom, stiffness: 1", "the name of a revolute joint"),
        ("travel: 0.2 m, curve: ramp, stiffness: 100 N/m", "travel: 0.2 m, curve: ramp, start: 0",
         "0.05 m, where the hinge is then"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(old, new, said):
    text = TEXT.replace(old, new, 1)
    assert text != TEXT
    told = problems_of(text)
    assert len(told) == 1, told
    assert said in told[0], told
