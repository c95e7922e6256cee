"""What acts on joints in structure files: on hinges, slides, universal joints, in their units."""

import numpy as np
import pytest
from structures_for_tests import SMALL, changed, refused

from fpm.elements import (
    Damper,
    Friction,
    Latch,
    Motor,
    Release,
    Stop,
    SyncLoop,
    TableSpring,
    TorqueMotor,
)
from fpm.structures import loads
from fpm.structures.describe import describe
from fpm.structures.report import longer_steps
from fpm.travel.components import component_classes

HINGES = """
  oil: {type: damper, joint: root, damping: 0.1 N m s/rad}
  dry: {type: friction, joint: root, moment: L*0.2 N}
  ends: {type: stop, joint: root, lower: -10 deg, upper: 100 deg, stiffness: 1e3, damping: 2}
  pin: {type: latch, joint: root, angle: 90 deg, capture_range: 1 deg, side: below, stiffness: 1e3}
  lock:
    {type: latch, joint: root, angle: 0.5 rad, max_capture_rate: 2 rad/s,
     stiffness: 1e3, holds: one way}
  tape: {type: tabulated spring, joint: root, angles: [0, 5 deg, 1 rad],
         moments: [0, -2 N m, -L*0.1 N]}
record:"""
HINGES = changed(SMALL, ("\nrecord:", HINGES))

MOTORS = """
curves:
  ramp: {times: [0, 2], values: [0, 1]}
actions:
  belt: {type: loop, joints: [root, knee], radii: [60 mm, -30 mm], stiffness: 20 kN/m, preload: 5 N}
  tie: {type: loop, joints: [knee, root], radii: [L/10, L/10], stiffness: 1 N/m, rest: [5 deg, 0]}
  drive: {type: motor, joint: root, turn: 60 deg, curve: ramp, stiffness: 5, damping: 2 N m s/rad}
  aid: {type: torque motor, joint: knee, torque: 3 N m, curve: ramp, no_load: 20 rpm}
  bolt: {type: release, joint: knee, stiffness: 100 N m/rad, watch: root, level: 45 deg}
  pin: {type: release, joint: root, stiffness: 10 N m/rad, damping: 1, hold: 21 deg, time: 0.5 s}
"""
MOTORS = changed(
    SMALL,
    (SMALL[SMALL.index("actions:") : SMALL.index("record:")], MOTORS),
    ("points:", "points:\n  C: [2, 0, 0]"),
    ("at: A, axis: y}", "at: A, axis: y, opening: stow}"),
    (
        "joints:",
        "  other: {through: [B, C], section: tube, material: steel, elements: n}\njoints:\n"
        "  knee: {type: revolute, parts: [arm, other], at: B, axis: y, opening: 0.2 rad}",
    ),
)

JOINTS = """
curves:
  ramp: {times: [0, 1 s], values: [0, 1]}
bodies:
  stage: {mass: 2, centre: C, points: [B], box: [1 m, 1 m, 1 m]}
joints:
  boom: {type: prismatic, parts: [ground, stage], at: C, axis: x, opening: 50 mm}
  knuckle:
    {type: universal, parts: [stage, arm], at: B, axis: x, other: y, openings: [5 deg, 0]}"""
SLIDES = """
actions:
  push: {type: spring, joint: boom, stiffness: 40 N/m, preload: 8 N}
  table: {type: tabulated spring, joint: boom, positions: [0, 1 m], forces: [5 N, 0]}
  oil: {type: damper, joint: boom, damping: 2 N s/m}
  dry: {type: friction, joint: boom, force: 0.5 N}
  ends: {type: stop, joint: boom, lower: 0, upper: 40 cm, stiffness: 1 kN/m}
  pin: {type: latch, joint: boom, position: 0.3 m, max_capture_rate: 2 m/s}
  lock: {type: latch, joint: boom, position: 0.2 m, capture_range: 1 mm, stiffness: 1 kN/m}
  drive: {type: motor, joint: boom, travel: 0.2 m, curve: ramp, stiffness: 100 N/m}
  pull: {type: torque motor, joint: boom, force: 3 N, no_load: 1 m/s}
  bend: {type: torsion spring, joint: knuckle_other, stiffness: 2 N m/rad}
  twist: {type: torsion spring, joint: knuckle_axis, stiffness: 4, preload: -1 N m}
  bolt: {type: release, joint: knuckle_axis, watch: boom, level: 0.1 m, stiffness: 5 N m/rad}"""
POINT = ("points:", "points:\n  C: [0, 1 m, 0]")
SLIDES = changed(SMALL, POINT, ("joints:", JOINTS.strip()), ("actions:", SLIDES.strip()))


def test_what_acts_on_joints_is_in_the_scene():
    found = loads(HINGES)
    scene = found.build(L=2.0)
    assert {"latch", "stop", "friction", "table_spring", "joint_loss"} <= set(found.energies)
    pin = Latch(0, np.pi / 2, 1e3, capture_range=np.radians(1), side="below", name="pin")
    expected = {
        Damper: [Damper(0, 0.1)],
        Friction: [Friction(0, 0.4)],
        Stop: [Stop(0, np.radians(least), side, 1e3, 2.0)
               for least, side in ((-10, "below"), (100, "above"))],
        Latch: [pin, Latch(0, 0.5, 1e3, max_capture_rate=2, holds="one way", name="lock")],
        TableSpring: [TableSpring(0, (0.0, np.radians(5), 1.0), (0.0, -2.0, -0.2))],
    }  # fmt: skip
    for kind, elements in expected.items():
        assert scene.kinds[kind] == elements


def test_classes_and_bearings_of_margins():
    more = "rub: {type: bearing, joint: root, mu: 0.1, radius: 20 mm}\nrecord:"
    text = changed(HINGES, ("type: tabulated spring, ", "type: tabulated spring, class: HA, "),
                   ("type: friction, ", "type: friction, class: HD, "),
                   ("record:", f"  {more}"))  # fmt: skip
    scene = loads(text).build()
    assert component_classes(scene) == {
        "spring": "S", "dry": "HD", "ends (stop root below)": "S", "ends (stop root above)": "S",
        "tape": "HA", "bearing root": "FR", "strain of bars": "S",
    }  # fmt: skip
    assert scene.bearings == {0: pytest.approx(0.002)}
    assert "counts in margins only" in describe(loads(text))
    refused(text, "class: HA", "class: XX", "allowed: S, I, HM, FR")
    refused(text, ", radius: 20 mm", "", "a length on a hinge, and none on a slide")


def test_motors_and_what_lets_go_are_in_the_scene():
    scene = loads(MOTORS).build(L=1.5, stow=15.0)
    knee, root = ([hinge.name for hinge in scene.hinges].index(name) for name in ("knee", "root"))
    stow = np.radians(15.0)
    belt, tie = SyncLoop.find(scene)
    assert (belt.name, belt.hinges, belt.radii) == ("belt", (root, knee), (0.06, -0.03))
    assert (belt.stiffness, belt.preload, tie.preload) == (2e4, 5.0, np.inf)
    np.testing.assert_allclose([*belt.rest, *tie.rest], [stow, 0.2, np.radians(5.0), 0.0])
    np.testing.assert_allclose(tie.radii, [0.15, 0.15])
    (motor,), (aid,), (bolt, pin) = (kind.find(scene) for kind in (Motor, TorqueMotor, Release))
    assert (motor.hinge, motor.stiffness, motor.damping, motor.curve) == (root, 5.0, 2.0, 0)
    np.testing.assert_allclose([motor.start, motor.turn], [stow, np.pi / 3])
    assert (aid.hinge, aid.torque, aid.curve) == (knee, 3.0, 0)
    assert aid.no_load == pytest.approx(2 * np.pi / 3)
    assert (bolt.hinge, bolt.watch, bolt.time, bolt.hold) == (knee, root, np.inf, 0.2)
    assert (pin.hinge, pin.watch, pin.time, pin.damping) == (root, -1, 0.5, 1.0)
    assert (bolt.level, pin.hold) == pytest.approx((np.pi / 4, np.radians(21.0)))


def test_all_that_acts_on_slides_and_crosses_is_in_the_scene():
    scene = loads(SLIDES).build()
    names = [hinge.name for hinge in scene.hinges]
    assert names == ["boom", "knuckle_axis", "knuckle_other", "root"]
    assert [hinge.opening for hinge in scene.hinges] == pytest.approx([0.05, 0.0872665, 0, 0])
    found = {kind: of[0] for kind, of in scene.kinds.items() if of}
    for kind in (Damper, Friction, Stop, Latch, Motor, TorqueMotor, TableSpring):
        assert found[kind].hinge == 0
    assert [(s.hinge, s.stiffness, s.rest) for s in scene.springs] == [
        (0, 40.0, 0.25), (2, 2.0, 0.0),
        (1, 4.0, pytest.approx(0.0872665 - 0.25)), (3, 3.0, pytest.approx(1.5707963))
    ]  # fmt: skip
    assert found[Friction].bristle_deflection == 1e-4
    assert (found[Release].hinge, found[Release].watch, found[Release].level) == (1, 0, 0.1)


def test_what_has_no_stiffness_holds_exactly():
    scene = loads(changed(HINGES, ("side: below, stiffness: 1e3", "side: below"))).build()
    pin = Latch(0, np.pi / 2, capture_range=np.radians(1), side="below", name="pin")
    assert scene.kinds[Latch][0] == pin
    assert [latch.name for latch in scene.kinds[Latch] if not latch.is_exact] == ["lock"]
    scene = loads(changed(HINGES, ("L*0.2 N", "L*0.2 N, sticks: exactly"))).build(L=2.0)
    assert scene.kinds[Friction] == [Friction(0, 0.4, None)]
    scene = loads(changed(MOTORS, ("stiffness: 100 N m/rad, watch", "watch"))).build()
    (bolt,) = (e for e in Release.find(scene) if e.is_exact)
    assert (scene.hinges[bolt.hinge].name, bolt.time) == ("knee", np.inf)
    assert (bolt.level, bolt.held_at_start(scene)) == pytest.approx((np.pi / 4, 0.2))
    rigid = changed(MOTORS, (", stiffness: 5, damping: 2 N m s/rad", ""))
    scene = loads(rigid).build(stow=15.0)
    (drive,) = Motor.find(scene)
    assert scene.hinges[drive.hinge].name == "root"
    assert [drive.target(scene, t) for t in (0.0, 1.0)] == pytest.approx(np.radians([15.0, 45.0]))


def test_a_motor_may_prescribe_its_rate():
    text = changed(SMALL, ("actions:", """curves:
  speed: {times: [0, 1 s, 3 s, 4 s], values: [0, 1, 1, 0]}
actions:
  drive: {type: motor, joint: root, rate: 0.5 rad/s, curve: speed}"""))  # fmt: skip
    scene = loads(text).build()
    (motor,) = scene.kinds[Motor]
    openings = {0.0: 0.0, 0.5: 0.0625, 1.0: 0.25, 3.0: 1.25, 4.0: 1.5, 9.0: 1.5}
    for time, opening in openings.items():
        assert motor.target(scene, time) == pytest.approx(opening, abs=1e-15)
    for new, said in (("rate: 0.5 rad/s, turn: 1 rad, ", "not both"), ("", "or a `rate`")):
        assert len(refused(text, "rate: 0.5 rad/s, ", new, said)) == 1


def test_the_command_lists_what_acts_and_what_makes_the_step_longer():
    lines = describe(loads(SLIDES)).splitlines()
    for line in (
        "  boom (slide, opening 0.05 m)",
        "  knuckle_axis (universal, opening 5 deg)",
        "  spring boom (on boom, stiffness 40 N/m, rest 0.25 m)",
        "  friction boom (on boom, force 0.5 N)",
        "  latch lock (on boom, position 0.2 m, stiffness 1000 N/m, capture range 0.001 m)",
        "  release knuckle_axis (on knuckle_axis, stiffness 5 N m/rad, hold 5 deg, "
        "until boom passes 0.1 m)",
    ):
        assert line in lines, line
    found = loads(changed(SMALL, ("value: 2, whole", "value: 6, whole")))
    text = describe(found)
    (step,) = (line.split()[2] for line in text.splitlines() if line.startswith("stable"))
    ways = longer_steps(found, float(step))
    assert [(name, value) for name, value, _ in ways] == [("n", 3), ("L", pytest.approx(1.1))]
    assert ways[0][2] == pytest.approx(2.0, abs=0.1)
    assert "longer with n = 3 (x " in text


OF_HINGES = [
    (
        "damping: 0.1 N m s/rad",
        "damping: 0.1 N m/rad",
        "allowed: a value in N m s/rad of at least 0",
    ),
    ("moment: L*0.2 N", "moment: 1, bristle_deflection: 0", "actions.dry.bristle_deflection: 0"),
    ("lower: -10 deg, upper: 100 deg, ", "", "`lower`, `upper`, or both"),
    ("lower: -10 deg", "lower: 110 deg", "an opening below `upper`, 1.74533 rad"),
    ("lower: -10 deg", "least: -10 deg", "ends.least: there is no such key (did you mean lower?)"),
    (
        "tabulated spring",
        "tape spring",
        "'tape spring' is not allowed (did you mean tabulated spri",
    ),
    ("record:", "motions: {}\nrecord:", "motions: there is no such key (did you mean initial_ve"),
    ("side: below", "side: left", "actions.pin.side: 'left' is not allowed; allowed: below"),
    ("holds: one way", "holds: yes", "allowed: both ways, one way"),
    ("max_capture_rate: 2 rad/s", "max_capture_rate: 0", "actions.lock.max_capture_rate: 0"),
    ("capture_range: 1 deg", "capture_range: 1", "actions.pin.capture_range"),
    ("angles: [0, 5 deg, 1 rad]", "angles: [0, 1 rad]", "as many moments as angles"),
    ("angles: [0, 5 deg, 1 rad]", "angles: [0, 2 rad, 1 rad]", "increasing angles"),
    ("stiffness: 1e3, holds: one way", "holds: one way", "none without a `stiffness`"),
    ("side: below, stiffness: 1e3", "damping: 1", "actions.pin.damping: 1"),
    (
        "moment: L*0.2 N",
        "moment: 1, bristle_deflection: 1 deg, sticks: exactly",
        "actions.dry.sticks",
    ),
    ("type: damper", "type: dampr", "did you mean damper?"),
]
OF_MOTORS = [
    ("[root, knee], radii", "[root, root], radii", "each once"),
    ("[root, knee], radii", "[root, nee], radii", "there is no joint 'nee'"),
    ("[60 mm, -30 mm]", "[60 mm, 0]", "actions.belt.radii: (0.06, 0.0)"),
    ("preload: 5 N}", "preload: -5 N}", "actions.belt.preload: -5"),
    ("turn: 60 deg, ", "", "actions.drive.turn: missing"),
    ("turn: 60 deg, curve: ramp", "turn: 60 deg", "actions.drive.curve: missing"),
    ("curve: ramp, stiffness: 5, ", "curve: ramp, ", "actions.drive.damping: 2"),
    ("stiffness: 5, damping: 2 N m s/rad", "start: 1 rad", "opening of motor root at the start"),
    ("joint: knee, torque", "joint: elbow, torque", "there is no joint 'elbow'"),
    ("no_load: 20 rpm", "no_load: 0 rpm", "actions.aid.no_load: 0"),
    ("watch: root, level: 45 deg", "watch: root", "an opening, with a joint to `watch`"),
    ("watch: root, level: 45 deg", "level: 45 deg", "a time, or a joint or latch to `watch`"),
    ("level: 45 deg", "level: stow", "does not have at the start"),
    ("stiffness: 10 N m/rad, damping", "damping", "actions.pin.hold: 0.366519"),
    ("stiffness: 10 N m/rad, damping: 1, ", "", "actions.pin.hold: 0.366519"),
    ("time: 0.5 s", "time: 0", "actions.pin.time: 0"),
    ("joint: root, stiffness: 10 N", "joint: knee, stiffness: 10 N", "one release on a joint"),
]
OF_SLIDES = [
    ("40 N/m", "0", "above 0, with a `preload`"),
    ("rest: 90 deg", "rest: 90 mm", "'90 mm' is m; allowed: an angle"),
    ("preload: 8 N", "preload: 8 N, rest: 1", "none, with a `preload`"),
    ("position: 0.3 m", "angle: 0.3", "no such key on a slide, where it is position; allowed"),
    ("type: prismatic", "type: sledge", "'sledge' is not allowed; allowed: revolute"),
    ("type: prismatic, ", "", "joints.boom.type: missing"),
    ("force: 0.5 N", "force: 0.5 N m", "allowed: a value in N of at least 0"),
    ("lower: 0", "lower: 1 m", "an opening below `upper`, 0.4 m"),
    ("joint: knuckle_other", "joint: knuckle", "knuckle_axis or knuckle_other"),
    ("joint: knuckle_other", "joint: boom", "for a slide there is `spring`"),
    ("type: spring, joint: boom", "type: spring, joint: root", "the name of a prismatic joint"),
    ("type: torque motor, joint: boom, force: 3 N, no_load: 1 m/s",
     "type: contact, joint: boom, stiffness: 1", "the name of a revolute joint"),
    ("travel: 0.2 m, curve: ramp, stiffness: 100 N/m", "travel: 0.2 m, curve: ramp, start: 0",
     "0.05 m, where the hinge is then"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "said"), OF_HINGES)
def test_what_is_refused_on_hinges(old, new, said):
    refused(HINGES, old, new, said)


@pytest.mark.parametrize(("old", "new", "said"), OF_MOTORS)
def test_what_is_refused_of_motors(old, new, said):
    refused(MOTORS, old, new, said)


@pytest.mark.parametrize(("old", "new", "said"), OF_SLIDES)
def test_what_is_refused_on_slides(old, new, said):
    (_,) = refused(SLIDES, old, new, said)
