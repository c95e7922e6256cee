"""Structures as programs write them: anchors, whole numbers with a point, names of any letters."""

import numpy as np
import pytest

from fpm.structures import StructureError, loads

PLAIN = """
parameters:
  k: {value: 2, unit: N m/rad, range: [1, 3]}
  fold: {value: 30, unit: deg}
  friction: {value: 0.1, unit: N m}
  n: {value: 2, whole: true}
points: {O: [0, 0, 0], A: [1, 0, 0], B: [0, 1, 0], C: [0.5, 0.5, 0]}
sections: {tube: {type: tube, diameter: 35 mm, thickness: 2 mm}}
materials: {steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m3}}
bodies: {arm: {mass: 1, centre: O, points: [A, B, C], inertia: [0.1, 0.1, 0.1]}}
bars: {rod: {through: [A, [2*A.x, 0, 0]], section: tube, material: steel, elements: n}}
joints:
  hinge: {type: revolute, parts: [ground, arm], at: O, axis: z, opening: fold}
  weld: {type: fixed, parts: [arm, rod], at: A}
actions:
  spring: {type: torsion spring, joint: hinge, stiffness: k, rest: 0 deg}
  brake: {type: friction, joint: hinge, moment: friction}
record: {tip: {part: arm, at: C}}
"""
PLAIN = PLAIN.replace("[A, [2*A.x, 0, 0]]", "[A, D]").replace("C: [0.5,", "D: [2, 0, 0], C: [0.5,")


def other(*pairs):
    text = PLAIN
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


WRITINGS = {
    "anchors": other(
        ("inertia: [0.1, 0.1, 0.1]", "inertia: &i [0.1, 0.1, 0.1]"),
        ("points: [A, B, C]", "points: &p [A, B, C]"),
    ),
    "aliases": other(
        ("mass: 1, ", "mass: &one 1, "), ("O: [0, 0, 0]", "O: &zero [0, 0, 0]"),
        ("rest: 0 deg", "rest: &rest 0 deg"), ("value: 2, whole", "value: &n 2, whole"),
        ("elements: n", "elements: *n"), ("record:", "let: {unused: n}\nrecord:"),
    ),
    "keys that hold what is marked": "x-parts: &i [0.1, 0.1, 0.1]\n.marks: {brake: &b {type: "
    "friction, joint: hinge}}\n" + other(("inertia: [0.1, 0.1, 0.1]", "inertia: *i"),
                                         ("{type: friction, joint: hinge, ", "{<<: *b, ")),
    "merges": other(
        ("unit: N m}", "unit: N m, range: [0, 1]}"),
        ("  fold: {", "  fold: {<<: {description: angle}, "),
        ("spring: {type: torsion spring, joint: hinge,", "spring: &s {type: torsion spring, joint: "
         "hinge,"),
    ),
    "points for whole numbers": other(("{value: 2, whole", "{value: 2.0, whole")),
    "powers for whole numbers": other(("{value: 2, whole", "{value: 0.2e1, whole")),
    "accents": other(("fold", "öffnung"), ("k:", "κ:"), ("stiffness: k", "stiffness: κ")),
    "decomposed accents": other(("fold:", "o\u0308ffnung:"), ("opening: fold", "opening: öffnung"),
        ("O: [0", "e\u0301: [0"), ("centre: O", "centre: e\u0301"), ("at: O", "at: é")),
    "a micro sign": other(("friction:", "µ:"), ("moment: friction", "moment: µ")),
    "numbers": other(
        ("arm", "1"), ("hinge", "2"), ("B:", "3:"), ("A, B, C", "A, 3, C"), ("rod", "10"),
    ),
    "units": other(("arm", "m"), ("hinge", "in"), ("weld", "s"), ("rod", "rad"), ("B:", "deg:"),
                   ("A, B, C", "A, deg, C")),
    "words of Python": other(("hinge", "is"), ("spring:", "for:"), ("steel", "class")),
}  # fmt: skip


@pytest.mark.parametrize("text", WRITINGS.values(), ids=WRITINGS)
def test_another_writing_is_the_same_structure(text):
    plain, scene = loads(PLAIN).build(), loads(text).build()
    for name in ("position", "mass", "inertia", "frame"):
        np.testing.assert_array_equal(getattr(scene, name), getattr(plain, name))
    assert [hinge.opening for hinge in scene.hinges] == [hinge.opening for hinge in plain.hinges]
    assert [len(scene.kinds[kind]) for kind in scene.kinds] == [
        len(plain.kinds[kind]) for kind in plain.kinds
    ]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("  n:", "  m:", "parameters.m: the name 'm' is not allowed; .* such as m_$"),
        ("  n:", "  3:", "parameters.3: the name '3' is not allowed; .* after a letter"),
        ("  n:", "  x²:", "parameters.x²: the name 'x²' is not allowed; .* such as x2$"),
        ("D: [2", "in: [2", "points.in: the name 'in' is not allowed; .* such as in_$"),
        ("tip:", "next:", "record.next: the name 'next' is not allowed"),
        ("tip:", "_tip:", "record._tip: the name '_tip' is not allowed"),
    ],
)
def test_a_name_that_could_be_a_number_is_refused_with_another(old, new, words):
    with pytest.raises(StructureError, match=f"(?m){words}"):
        loads(other((old, new)))
