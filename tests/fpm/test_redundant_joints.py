"""Joints whose conditions others imply: the motion does not determine what each one bears."""

import pytest

from fpm import structures
from fpm.reading.constraint_forces import find_indeterminate, undetermined_forces
from fpm.reading.responses import parse

POINTS = """
name: loop
points: {a: [0, 0, 0], b: [0, 1, 0], c: [1, 1, 0], d: [1, 0, 0], m1: [0, 0.5, 0], m2: [0.5, 1, 0],
         m3: [1, 0.5, 0], e: [5, 0, 0], f: [6, 0, 0]}
"""
RIGID = """
bodies:
  one: {mass: 1 kg, centre: m1, box: [0.1, 1, 0.1], points: [a, b]}
  two: {mass: 1 kg, centre: m2, box: [1, 0.1, 0.1], points: [b, c]}
  three: {mass: 1 kg, centre: m3, box: [0.1, 1, 0.1], points: [c, d]}
  apart: {mass: 1 kg, centre: f, box: [1, 0.1, 0.1], points: [e]}
"""
ELASTIC = """
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m3}}
sections: {bar: {type: square, side: 10 mm}}
bars:
  one: {through: [a, b], section: bar, elements: 4, material: steel, up: z}
  two: {through: [b, c], section: bar, elements: 4, material: steel, up: z}
  three: {through: [c, d], section: bar, elements: 4, material: steel, up: z}
bodies:
  apart: {mass: 1 kg, centre: f, box: [1, 0.1, 0.1], points: [e]}
"""
JOINTS = """
joints:
  A: {type: revolute, parts: [ground, one], at: a, axis: z}
  B: {type: SECOND, parts: [one, two], at: b}
  C: {type: THIRD, parts: [two, three], at: c}
  D: {type: revolute, parts: [ground, three], at: d, axis: z}
  E: {type: revolute, parts: [ground, apart], at: e, axis: z}
"""
HINGE, CARDAN = "revolute, axis: z", "universal, axis: z, other: y"


@pytest.mark.parametrize(
    ("parts", "second", "third", "names"),
    [
        (RIGID, HINGE, HINGE, "ABCD"),  # 20 conditions on 18 freedoms, one of which is left
        (RIGID, HINGE, "spherical", "ABD"),  # 18, one of them twice: a turn of all but the ball
        (RIGID, CARDAN, "spherical", ""),  # 17
        (ELASTIC, HINGE, HINGE, ""),  # bars share forces as they give way
    ],
)
def test_joints_whose_conditions_others_imply_are_told_apart(parts, second, third, names):
    text = POINTS + parts + JOINTS.replace("SECOND", second).replace("THIRD", third)
    scene = structures.loads(text).build()
    assert find_indeterminate(scene) >= set(names)
    assert bool(find_indeterminate(scene)) == bool(names) and "E" not in find_indeterminate(scene)
    for joint in "ADE":
        for kind in ("constraint_force", "constraint_moment"):
            response = parse("x", {kind: joint, "component": "x"}, scene)
            is_free = joint not in find_indeterminate(scene)
            assert is_free != bool(undetermined_forces(scene, [response]))
        response = parse("x", {"opening": joint}, scene)
        assert not undetermined_forces(scene, [response])
