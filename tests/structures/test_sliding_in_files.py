"""Joints whose second part slides and turns, as files state them: openings, and what is refused."""

import pytest
from structures_for_tests import problems_of

from fpm.structures import loads

TEXT = """
points: {{o: [0, 0, 0], c: [0.1, 0, 0]}}
bodies: {{b: {{mass: 1, centre: c, points: [o], box: [10 cm, 20 cm, 5 cm]}}}}
joints: {{j: {{type: {}, parts: [ground, b], at: o, axis: z}}}}
actions: {{k: {{type: {}}}}}
"""
SPRING = "torsion spring, stiffness: 1, joint: "


def test_openings_have_the_names_and_starts_that_are_stated():
    stated = {
        "cylindrical, opening_slide: 2 mm": {"j_turn": 0.0, "j_slide": 0.002},
        "planar, x: x, opening_y: 3 m, opening_turn: 7 rad": {"j_turn": 7.0, "j_x": 0, "j_y": 3.0},
        "pin in slot, x: [0, 2, 0], opening_slide: -1": {"j_turn": 0.0, "j_slide": -1.0},
    }
    for joint, openings in stated.items():
        scene = loads(TEXT.format(joint, SPRING + "j_turn")).build()
        assert {hinge.name: hinge.opening for hinge in scene.hinges} == pytest.approx(openings)
        assert {hinge.joint for hinge in scene.hinges} == {"j"}
    (hinge,) = loads(TEXT.format("screw, pitch: -3 mm", SPRING + "j")).build().hinges
    assert hinge.lead == pytest.approx(-0.003 / 6.283185307179586)


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
