"""What acts on joints in structure files: on hinges, slides, universal joints, in their units."""

import numpy as np
import pytest
from structures_for_tests import SMALL, changed, refused

from fpm.elements import (
    Damper,
    Friction,
    Latch,
    Stop,
    TableSpring,
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
