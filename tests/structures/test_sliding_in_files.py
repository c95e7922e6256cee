"""Joints whose second part slides and turns, as files state them: openings, and what is refused."""

import pytest
from structures_for_tests import problems_of

TEXT = """
points: {{o: [0, 0, 0], c: [0.1, 0, 0]}}
bodies: {{b: {{mass: 1, centre: c, points: [o], box: [10 cm, 20 cm, 5 cm]}}}}
joints: {{j: {{type: {}, parts: [ground, b], at: o, axis: z}}}}
actions: {{k: {{type: {}}}}}
"""
SPRING = "torsion spring, stiffness: 1, joint: "


@pytest.mark.parametrize(
    ("joint", "action", "key", "allowed"),
    [
        ("screw", SPRING + "j", "joints.j.pitch", "missing"),
        ("screw, pitch: 0", SPRING + "j", "joints.j.pitch", "a length that is not 0"),
        ("planar, x: z", SPRING + "j_turn", "joints.j.x", "a direction normal to"),
        ("planar, x: x, opening: 1", SPRING + "j_turn", "joints.j.opening", "no such key"),
        ("cylindrical", SPRING + "j", "actions.k.joint", "one of its openings, j_turn"),
        ("cylindrical", SPRING + "j_slide", "actions.k.joint", "for a slide there is `spring`"),
        ("cylindrical", "damper, damping: 1, joint: j", "actions.k.joint", "j_turn or j_slide"),
        ("cylindrical", "contact, stiffness: 1, joint: j_turn", "actions.k.joint", "revolute"),
        ("pin in slot, x: x", "bearing, joint: j_turn, mu: 0.1", "actions.k.radius", "a length"),
        ("spherical", SPRING + "j", "actions.k.joint", "the name of a revolute or screw joint"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_what_is_allowed(joint, action, key, allowed):
    text = TEXT.format(joint, action)
    text = text if joint != "spherical" else text.replace(", axis: z", "")
    (problem,) = problems_of(text)
    assert key in problem and allowed in problem
