"""What acts on joints, in structure files."""

import numpy as np
import pytest
from structures_for_tests import SMALL, problems_of, structure

import fpm
from fpm.elements import Damper, Friction, Latch, RigidFriction, RigidLatch, Stop, TableSpring
from fpm.structures import loads

ACTIONS = """
  oil: {type: damper, joint: root, damping: 0.1 N m s/rad}
  dry: {type: friction, joint: root, moment: L*0.2 N}
  ends: {type: stop, joint: root, least: -10 deg, most: 100 deg, stiffness: 1e3, damping: 2}
  pin: {type: latch, joint: root, angle: 90 deg, tolerance: 1 deg, side: below, stiffness: 1e3}
  lock:
    {type: latch, joint: root, angle: 0.5 rad, fastest: 2 rad/s, stiffness: 1e3, holds: one way}
  tape: {type: tape spring, joint: root, angles: [0, 5 deg, 1 rad], moments: [0, -2 N m, -L*0.1 N]}
record:"""
TEXT = SMALL.replace("\nrecord:", ACTIONS)


def test_what_acts_on_joints_is_in_the_scene():
    found = loads(TEXT)
    scene = found.build(L=2.0)
    energies = {"latch", "stop", "friction", "table_spring", "joint_loss"}
    assert energies <= set(found.energies)
    assert scene.kinds[Damper] == [Damper(0, 0.1)]
    assert scene.kinds[Friction] == [Friction(0, 0.4)]
    stops = [Stop(0, np.radians(-10), "below", 1e3, 2.0), Stop(0, np.radians(100), "above", 1e3, 2)]
    assert scene.kinds[Stop] == stops
    pin = Latch(0, np.pi / 2, 1e3, tolerance=np.radians(1), side="below", name="pin")
    assert scene.kinds[Latch] == [pin, Latch(0, 0.5, 1e3, fastest=2, one_sided=True, name="lock")]
    tape = TableSpring(0, (0.0, np.radians(5), 1.0), (0.0, -2.0, -0.2))
    assert scene.kinds[TableSpring] == [tape]


def test_a_latch_without_stiffness_is_rigid():
    text = TEXT.replace("side: below, stiffness: 1e3", "side: below")
    scene = loads(text).build()
    pin = RigidLatch(0, np.pi / 2, tolerance=np.radians(1), side="below", name="pin")
    assert scene.kinds[RigidLatch] == [pin]
    assert [latch.name for latch in scene.kinds[Latch]] == ["lock"]


def test_friction_may_stick_exactly():
    scene = loads(TEXT.replace("L*0.2 N", "L*0.2 N, sticks: exactly")).build(L=2.0)
    assert scene.kinds[RigidFriction] == [RigidFriction(0, 0.4)]
    assert Friction not in scene.kinds


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("damping: 0.1 N m s/rad", "damping: 0.1 N m/rad", "allowed: a value in N m s/rad >= 0"),
        ("damping: 0.1 N m s/rad", "damping: -1", "actions.oil.damping: -1"),
        ("moment: L*0.2 N", "moment: L", "actions.dry.moment"),
        ("moment: L*0.2 N", "moment: 1, bend: 0", "actions.dry.bend: 0"),
        ("least: -10 deg, most: 100 deg, ", "", "`least`, `most`, or both"),
        ("least: -10 deg", "least: 110 deg", "an opening below `most`, 1.74533 rad"),
        ("side: below", "side: left", "actions.pin.side: 'left' is not allowed; allowed: below"),
        ("side: below", "side: [below]", "actions.pin.side"),
        ("holds: one way", "holds: yes", "allowed: both ways, one way"),
        ("fastest: 2 rad/s", "fastest: 0", "actions.lock.fastest: 0"),
        ("tolerance: 1 deg", "tolerance: -1 deg", "actions.pin.tolerance"),
        ("tolerance: 1 deg", "tolerance: 1", "actions.pin.tolerance"),
        ("angles: [0, 5 deg, 1 rad]", "angles: [0, 1 rad]", "as many moments as angles"),
        ("angles: [0, 5 deg, 1 rad]", "angles: [0, 2 rad, 1 rad]", "increasing angles"),
        ("stiffness: 1e3, holds: one way", "holds: one way", "none without a `stiffness`"),
        ("side: below, stiffness: 1e3", "damping: 1", "actions.pin.damping: 1"),
        ("moment: L*0.2 N", "moment: 1, bend: 1 deg, sticks: exactly", "actions.dry.sticks"),
        ("type: damper", "type: dampr", "did you mean damper?"),
    ],
)
def test_actions_that_are_refused(old, new, problem):
    text = TEXT.replace(old, new, 1)
    assert text != TEXT
    assert any(problem in told for told in problems_of(text)), problems_of(text)


@pytest.mark.slow
def test_the_latch_of_the_library_catches_at_the_published_time():
    values = [{}, {"k": 0.2}, {"angle": 60.0}, {"fastest": 1.4}]
    scenes = [structure("latch").build(**some) for some in values]
    outcomes = fpm.simulate(scenes, duration=2.5, instants=251, step=5e-4)
    exact = [1.911912403, 1.911912403 / np.sqrt(2), np.sqrt(10 / 3) * np.arccos(2 / 3)]
    for time, outcome in zip(exact, outcomes[:3], strict=True):
        assert outcome.events[0, 0] == pytest.approx(time, abs=1e-6)
        assert outcome.eventful[0][:2] == ("latch catch", ("latches", "misses"))
    assert outcomes[0].recorded["latch_rate"].values[-1, 0] == pytest.approx(1.490188240, abs=1e-6)
    assert outcomes[3].events[0, 2] == 1  # missed
