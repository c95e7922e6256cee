"""Rigid bodies, pins of several members, and all joints, as text."""

import numpy as np
import pytest
from structures_for_tests import refused, structure

import fpm
from fpm import structures
from fpm.structures import report
from fpm.structures.describe import describe

ARM = """
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
  shoulder: {type: revolute, parts: [ground, one], at: a, axis: y}
  elbow: {type: revolute, parts: [one, two], at: b, axis: y}
  wrist: {type: revolute, parts: [two, three], at: c, axis: y}
gravity: [0, 0, -9.81]
record:
  tip: {part: three, at: d}
  middle: {part: two, at: b}
"""


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
    runs = [fpm.simulate(structures.loads(t).build(), duration=0.5, instants=11, step=1e-3)[0]
            for t in (one, two)]  # fmt: skip
    tips = [run.points["tip"][0] for run in runs]
    assert np.ptp(tips[0], axis=0).max() > 0.5
    assert tips[0] == pytest.approx(tips[1], abs=1e-6)
