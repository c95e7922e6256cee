"""Rigid bodies, pins of several members, and all joints, as text."""

import numpy as np
import pytest
from structures_for_tests import refused, structure

import fpm
from fpm import structures
from fpm.structures import report
from fpm.structures.describe import describe

TEXT = """
name: arm
parameters:
  L: {value: 0.5, unit: m, range: [0.1, 2], description: length}
points:
  a: [0, 0, 0]
  b: [L, 0, 0]
  c: [2*L, 0, 0]
  d: [3*L, 0, 0]
  m1: [L/2, 0, 0]
  m2: [3*L/2, 0, 0]
  m3: [5*L/2, 0, 0]
bodies:
  one: {mass: 1, centre: m1, points: [a, b], box: [L, 20 mm, 20 mm]}
  two: {mass: 1, centre: m2, points: [b, c], inertia: [0.001, 0.03, 0.03]}
  three: {mass: 2, centre: m3, points: [c, d], inertia: [0.03, 0.03, 0.001], x: y, up: x}
joints:
  shoulder: {type: JOINT1, parts: [ground, one], at: a AXIS1}
  elbow: {type: JOINT2, parts: [one, two], at: b AXIS2}
  wrist: {type: JOINT3, parts: [two, three], at: c AXIS3}
gravity: [0, 0, -9.81]
record:
  tip: {part: three, at: d}
  middle: {part: two, at: b}
"""
ARM_OF = {
    "revolute": ", axis: y",
    "spherical": "",
    "fixed": "",
    "universal": ", axis: y, other: z",
    "prismatic": ", axis: y",
}


def arm(*types) -> str:
    text = TEXT
    for k, kind in enumerate(types, start=1):
        text = text.replace(f"JOINT{k}", kind).replace(f" AXIS{k}", ARM_OF[kind])
    return text


ARM = arm("revolute", "revolute", "revolute")


def run(scene, duration, instants, step=None):
    (outcome,) = fpm.simulate(scene, duration=duration, instants=instants, step=step)
    assert outcome.failure is None
    return outcome


def test_redundant_joints_are_found_and_named():
    scene = structure("bricard").build()
    assert tuple(report.mobility(scene)) == (5, 30, 1, 1)
    assert report.redundant(scene) == [f"joint j{k}" for k in range(6)]
    chain = structures.loads(ARM)
    assert report.redundant(chain.build()) == []
    assert "redundant " not in describe(chain)
    assert "joint j5" in describe(structure("bricard"))


def test_redundant_supports_have_their_names():
    held = "{}: {{part: one, at: {}, translations: xyz, rotations: none}}"
    supports = "\n  ".join(held.format(*pair) for pair in (("left", "a"), ("right", "b")))
    scene = structures.loads(f"{ARM}\nsupports:\n  {supports}\n").build()
    assert {"support left", "support right"} <= set(report.redundant(scene))


@pytest.mark.slow
def test_joints_of_all_types_can_be_said():
    """In the plane of the fall, a spherical or universal joint does what the hinge does.

    Nothing pushes along a slider across the plane.
    """

    def tip(second, third):
        found = structures.loads(arm("revolute", second, third))
        return run(found.build(), 0.2, 21, 1e-3).points["tip"][0]

    hinged = tip("revolute", "revolute")
    np.testing.assert_allclose(tip("spherical", "universal"), hinged, atol=1e-9)
    stiff = tip("fixed", "fixed")
    assert np.abs(stiff - hinged).max() > 1e-3
    np.testing.assert_allclose(tip("prismatic", "fixed"), stiff, atol=1e-9)


SHOULDER = "shoulder: {type: revolute, parts: [ground, one], at: a, axis: y}"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("x: y, up: x", "x: y, up: y", "a direction normal to x"),
        ("mass: 2,", "mass: 0,", "bodies.three.mass: 0 is not allowed"),
        ("centre: m1, points: [a, b]", "centre: m1, points: [a]", "a point of one: m1, a"),
        (SHOULDER, "shoulder: {type: universal, parts: [ground, one], at: a, axis: y, other: y}",
         "joints.shoulder.other"),
        (SHOULDER, "shoulder: {type: prismatic, parts: [ground, one, two], at: a, axis: y}",
         "a list of 2, each"),
        ("gravity:", "drives:\n  crank: {part: one, at: a, spin: [0, 1, 0]}\ngravity:",
         "the centre of a body"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_bodies_is_said(old, new, said):
    refused(ARM, old, new, said)


LUMP = """
points: {o: [0, 0, 0], c: [0.5, 0, 0], tip: [1, 0, 0], side: [1, 0.3, 0.4]}
bodies:
  arm: {mass: 2, centre: c, points: [o, tip, side], INERTIA}
joints:
  pin: {type: spherical, parts: [ground, arm], at: o}
gravity: [0, 0, -9.81]
initial_velocities:
  arm: {part: arm, about: o, spin: [3, -1, 2]}
record:
  tip: {part: arm, at: tip}
"""


@pytest.mark.slow
def test_a_mass_at_any_point_of_a_body_moves_as_one_beside_it():
    """A weld to another body there, of a ball's inertia, is the same body."""
    own = LUMP.replace("INERTIA", "inertia: [0.02, 0.3, 0.31]")
    one = own + "masses: {lump: {part: arm, at: side, mass: 1.5, inertia: 0.01}}"
    ball = "\n  ball: {mass: 1.5, centre: side, inertia: [0.01, 0.01, 0.01]}\njoints:"
    weld = "\n  weld: {type: fixed, parts: [arm, ball], at: side}\ngravity"
    moving = "about: o, spin: [3, -1, 2]}\n  ball: {part: ball, about: o, spin: [3, -1, 2]}"
    two = own.replace("\njoints:", ball).replace("\ngravity", weld)
    two = two.replace("about: o, spin: [3, -1, 2]}", moving)
    tips = [run(structures.loads(t).build(), 0.5, 11, 1e-3).points["tip"][0] for t in (one, two)]
    assert np.ptp(tips[0], axis=0).max() > 0.5
    assert tips[0] == pytest.approx(tips[1], abs=1e-6)
