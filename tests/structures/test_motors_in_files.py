"""Loops, motors and releases in structure files."""

import numpy as np
import pytest
from structures_for_tests import SMALL, problems_of

from fpm.elements import Motor, Release, RigidMotor, RigidRelease, SyncLoop, TorqueMotor
from fpm.structures import loads

ACTIONS = """
curves:
  ramp: {times: [0, 2], values: [0, 1]}
actions:
  belt: {type: loop, joints: [root, knee], radii: [60 mm, -30 mm], stiffness: 20 kN/m, preload: 5 N}
  tie: {type: loop, joints: [knee, root], radii: [L/10, L/10], stiffness: 1 N/m, rest: [5 deg, 0]}
  drive: {type: motor, joint: root, turn: 60 deg, curve: ramp, stiffness: 5, damping: 2 N m s/rad}
  aid: {type: torque motor, joint: knee, torque: 3 N m, curve: ramp, no_load: 20 rpm}
  bolt: {type: release, joint: knee, stiffness: 100 N m/rad, watch: root, level: 45 deg}
  pin: {type: release, joint: root, stiffness: 10 N m/rad, damping: 1, hold: 21 deg, time: 0.5 s}
record:"""
TEXT = (
    SMALL.split("actions:")[0]
    .replace("points:", "points:\n  C: [2, 0, 0]")
    .replace(
        "joints:",
        "  other: {through: [B, C], section: tube, material: steel, elements: n}\njoints:\n"
        "  knee: {type: revolute, parts: [arm, other], at: B, axis: y, opening: 0.2 rad}",
    )
    .replace("at: A, axis: y}", "at: A, axis: y, opening: stow}")
    + ACTIONS
    + SMALL.split("record:")[1]
)


def test_they_are_in_the_scene():
    scene = loads(TEXT).build(L=1.5, stow=15.0)
    knee, root = ([hinge.name for hinge in scene.hinges].index(name) for name in ("knee", "root"))
    stow = np.radians(15.0)
    belt, tie = SyncLoop.of(scene)
    assert (belt.name, belt.hinges, belt.radii) == ("belt", (root, knee), (0.06, -0.03))
    assert (belt.stiffness, belt.preload) == (2e4, 5.0)
    np.testing.assert_allclose(belt.rest, [stow, 0.2])
    np.testing.assert_allclose(tie.rest, [np.radians(5.0), 0.0])
    assert tie.preload == np.inf
    np.testing.assert_allclose(tie.radii, [0.15, 0.15])
    (motor,) = Motor.of(scene)
    assert (motor.hinge, motor.stiffness, motor.damping, motor.curve) == (root, 5.0, 2.0, 0)
    np.testing.assert_allclose([motor.start, motor.turn], [stow, np.pi / 3])
    (aid,) = TorqueMotor.of(scene)
    assert (aid.hinge, aid.torque, aid.curve) == (knee, 3.0, 0)
    assert aid.no_load == pytest.approx(2 * np.pi / 3)
    bolt, pin = Release.of(scene)
    assert (bolt.hinge, bolt.watch, bolt.time, bolt.hold) == (knee, root, np.inf, 0.2)
    assert bolt.level == pytest.approx(np.pi / 4)
    assert (pin.hinge, pin.watch, pin.time, pin.damping) == (root, -1, 0.5, 1.0)
    assert pin.hold == pytest.approx(np.radians(21.0))


def test_a_release_without_stiffness_is_rigid():
    scene = loads(TEXT.replace("stiffness: 100 N m/rad, watch", "watch")).build()
    (bolt,) = RigidRelease.of(scene)
    assert (scene.hinges[bolt.hinge].name, bolt.time) == ("knee", np.inf)
    assert bolt.level == pytest.approx(np.pi / 4)
    assert bolt.held_at_start(scene) == pytest.approx(0.2)


def test_a_motor_without_stiffness_is_rigid():
    text = TEXT.replace("curve: ramp, stiffness: 5, damping: 2 N m s/rad", "curve: ramp")
    scene = loads(text).build(stow=15.0)
    (drive,) = RigidMotor.of(scene)
    assert scene.hinges[drive.hinge].name == "root"
    assert [drive.at(scene, t) for t in (0.0, 1.0)] == pytest.approx(np.radians([15.0, 45.0]))


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("[root, knee], radii", "[root], radii", "actions.belt.joints: "),
        ("[root, knee], radii", "[root, root], radii", "each once"),
        ("[root, knee], radii", "[root, nee], radii", "there is no joint 'nee'"),
        ("[60 mm, -30 mm]", "[60 mm]", "actions.belt.radii: "),
        ("[60 mm, -30 mm]", "[60 mm, 0]", "radii of loop belt"),
        ("preload: 5 N}", "preload: -5 N}", "actions.belt.preload: -5"),
        ("stiffness: 20 kN/m", "stiffness: 20 kN", "actions.belt.stiffness: "),
        ("turn: 60 deg, ", "", "actions.drive.turn: None"),
        ("turn: 60 deg", "turn: 60", "actions.drive.turn: "),
        ("turn: 60 deg, curve: ramp", "turn: 60 deg", "actions.drive.curve: missing"),
        ("damping: 2 N", "damping: -2 N", "actions.drive.damping: -2"),
        ("curve: ramp, stiffness: 5, ", "curve: ramp, ", "actions.drive.damping: 2"),
        (
            "curve: ramp, stiffness: 5, damping: 2 N m s/rad",
            "curve: ramp, start: 1 rad",
            "opening of motor root at the start",
        ),
        ("joint: knee, torque", "joint: elbow, torque", "there is no joint 'elbow'"),
        ("no_load: 20 rpm", "no_load: 0 rpm", "actions.aid.no_load: 0"),
        ("watch: root, level: 45 deg", "watch: root", "an opening, with a joint to `watch`"),
        ("watch: root, level: 45 deg", "level: 45 deg", "a time, or a joint to `watch`"),
        ("level: 45 deg", "level: stow", "does not have at the start"),
        ("stiffness: 10 N m/rad, damping", "damping", "actions.pin.damping: 1"),
        ("stiffness: 10 N m/rad, damping: 1, ", "", "actions.pin.hold: 0.366519"),
        ("time: 0.5 s", "time: 0", "actions.pin.time: 0"),
        ("joint: root, stiffness: 10 N", "joint: knee, stiffness: 10 N", "without a release"),
    ],
)
def test_what_is_refused(old, new, problem):
    text = TEXT.replace(old, new, 1)
    assert text != TEXT
    assert any(problem in told for told in problems_of(text)), problems_of(text)


def test_a_motor_may_prescribe_its_rate():
    text = SMALL.replace(
        "actions:",
        """curves:
  speed: {times: [0, 1 s, 3 s, 4 s], values: [0, 1, 1, 0]}
actions:
  drive: {type: motor, joint: root, rate: 0.5 rad/s, curve: speed}""",
    )
    (motor,) = loads(text).build().kinds[RigidMotor]
    scene = loads(text).build()
    for time, opening in (
        (0.0, 0.0),
        (0.5, 0.0625),
        (1.0, 0.25),
        (3.0, 1.25),
        (4.0, 1.5),
        (9.0, 1.5),
    ):
        assert motor.at(scene, time) == pytest.approx(opening, abs=1e-15)
    for old, new, said in (
        ("rate: 0.5 rad/s", "rate: 0.5 rad/s, turn: 1 rad", "not both"),
        ("rate: 0.5 rad/s, ", "", "by how much it moves, or a `rate`"),
    ):
        (told,) = problems_of(text.replace(old, new))
        assert said in told
