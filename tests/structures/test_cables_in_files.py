"""Cables and masses in structure files, and the tensegrity prism of the library."""

import numpy as np
import pytest
from structures_for_tests import SMALL, changed, problems_of, refused, structure

import fpm
from fpm.structures import loads

CABLES = """
curves:
  winch: {times: [0, 1], values: [0, 1]}
masses:
  load: {part: arm, at: B, mass: 2 kg, inertia: 0.5}
cables:
  stay: {through: [B, {part: ground, at: C}], EA: 20 kN, preload: L*30 N/m}
  hoist: {through: [A, {part: ground, at: C}, B], EA: 1 MN, rest: 5 m, reel: 10 cm, curve: winch,
    friction: 0.1}
record:"""
TEXT = SMALL.replace("record:", CABLES).replace("points:", "points:\n  C: [0, 0, 2]")


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("[B, {part", "[D, {part", "cables.stay.through: there is no point 'D'"),
        ("{part: ground, at: C}], EA", "C], EA", "that one part has, or {part: ..., at: C}"),
        ("at: C}], EA", "on: C}], EA", "cables.stay.through"),
        (", preload: L*30 N/m", "", "cables.stay.rest: missing; allowed: either"),
        (", preload: L*30 N/m", ", preload: L*30", "allowed: a value in N of at least 0"),
        ("EA: 20 kN", "EA: -20 kN", "cables.stay.EA: -20000"),
        ("preload: L", "rest: 1, preload: L", "either `rest` or `preload`"),
        (", curve: winch,", ",", "a length with a `curve`"),
        ("reel: 10 cm, ", "", "cables.hoist.reel: missing; allowed: a length, with a `curve`"),
        ("through: [A, {part: ground, at: C}, B]", "through: [A, B]", "runs through no point"),
        ("friction: 0.1", "friction: -1", "cables.hoist.friction: -1"),
        ("reel: 10 cm", "reel: 5 m", "unstrained length of cable hoist"),
        ("at: B, mass", "at: C, mass", "masses.load.at: 'C'"),
        ("mass: 2 kg", "mass: 0", "masses.load.mass"),
        ("part: arm, at: B, mass", "part: ground, at: C, mass", "masses.load.part"),
    ],
)
def test_what_is_refused(old, new, problem):
    refused(TEXT, old, new, problem)


def test_a_cable_may_join_two_points_of_one_part():
    assert loads(changed(TEXT, ("[B, {part: ground, at: C}]", "[A, B]"))).build().cables


def test_a_mass_beside_the_axis_is_refused():
    text = TEXT.replace("through: [A, B], section", "through: [A, B], carries: {C: B}, section")
    text = text.replace("at: B, mass", "at: C, mass")
    assert "a point on the axis of arm" in problems_of(text)[0]


def test_a_point_of_two_parts_needs_the_part():
    text = TEXT.replace(
        "joints:",
        "  other: {through: [B, C], section: tube, material: steel, elements: 2}\njoints:\n"
        "  knee: {type: revolute, parts: [arm, other], at: B, axis: y}",
    )
    assert "with one of arm, other" in problems_of(text)[0]


def test_tensions_are_responses():
    found = loads(TEXT).sample
    response = fpm.responses.parse("pull", {"tension": "stay"}, found)
    assert (response.unit, response.long_name) == ("N", "tension of cable stay")
    with pytest.raises(fpm.SceneError, match="one of stay, hoist"):
        fpm.responses.parse("pull", {"tension": "rope"}, found)


@pytest.fixture(scope="module")
def risen():
    """Prisms of three, other struts, cables and starts, at rest again; a heavier one."""
    prism = structure("tensegrity")
    values = [{}, {"strut": 1.01, "wind": 5.0}, {"EA": 5.0}, {"tip": 0.2, "take": 8.0}]
    scenes = [prism.build(**some) for some in values]
    return fpm.simulate(scenes, duration=2.0, instants=101)


def twist(outcome) -> np.ndarray:
    low, high = (outcome.points[name][0] for name in ("low", "high"))
    turns = np.arctan2(high[:, 1], high[:, 0]) - np.arctan2(low[:, 1], low[:, 0])
    return np.degrees(turns) % 360


@pytest.mark.slow
def test_a_prism_of_three_struts_finds_its_form(risen):
    assert [round(float(twist(outcome)[0])) for outcome in risen] == [55, 35, 55, 55]
    for outcome in risen:
        assert outcome.failure is None
        assert twist(outcome)[-1] == pytest.approx(30.0, abs=0.01)
        assert outcome.points["high"][0][-1, 2] > outcome.points["high"][0][0, 2]
        lengths = dict(zip(outcome.records["cable_length"].labels,
                           outcome.records["cable_length"].values[-1], strict=True))  # fmt: skip
        density = {
            name: outcome.select_columns("cable_tension")[name][-1] / lengths[name]
            for name in lengths
        }
        assert density["side1.side"] > 0
        for ring in ("base", "top"):
            ratio = density[f"side1.{ring}"] / density["side1.side"]
            assert ratio == pytest.approx(1 / np.sqrt(3), rel=1e-3)
        assert density["side2.side"] == pytest.approx(density["side1.side"], rel=1e-3)


RING = """
parameters: {n: {value: 4, whole: true}, R: {value: 2, unit: m}}
materials: {steel: {E: 210 GPa, rho: 7850}}
sections: {rod: {type: circle, diameter: 20 mm}}
repeat:
  post:
    count: n
    arrangement: ring
    index: i
    points:
      low: [R*cos(2*pi*i/n), R*sin(2*pi*i/n), 0]
      high: [R*cos(2*pi*i/n), R*sin(2*pi*i/n), 1]
    bars: {bar: {through: [low, high], section: rod, material: steel, elements: 2}}
cables:
  around: {through: [{each: post, through: [high, low]}, post.first.high], EA: 1 kN, preload: 1 N}
"""


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("each: post", "each: pots", "cables.around.through.each: 'pots' is not allowed"),
        ("[high, low]}", "[high, lo]}", "there is no point 'lo'"),
        ("[{each: post, through: [high, low]}, post.first.high]", "[post.first.high]", "2 to 1000"),
        ("through: [high, low]}", "through: high}", "cables.around.through"),
    ],
)
def test_what_is_refused_of_units(old, new, problem):
    refused(RING, old, new, problem)


def test_a_bar_through_points_may_have_one_element_a_stretch():
    text = SMALL.replace("[A, B], section", "[A, M, B], section").replace(
        "points:", "points:\n  M: [half*cos(stow), 0, half*sin(stow)]"
    )
    scene = loads(text.replace("range: [2, 50]", "range: [1, 50]")).build(n=1)
    assert len(scene.position) == 4  # and the ground
    assert scene.mass[1:].sum() == pytest.approx(loads(SMALL).build().mass[1:].sum())
