"""What is wrong with a file is said before anything runs: line, key, value, what is allowed."""

import re

import numpy as np
import pytest
from structures_for_tests import FOURBAR, SMALL, changed, problems_of, refused, structure

from fpm.structures import StructureError, loads
from fpm.structures.describe import describe
from fpm.structures.names import Names
from fpm.structures.reading import Problems
from fpm.structures.statement import NO_VALUE
from fpm.structures.statements import STATEMENTS

OPEN = changed(FOURBAR, ("assemble: {hold: [A]}\n", ""), ("value: 10", "value: 0"))

WRONG = [
    # what is replaced, by what, and what is said
    ("mesh: n", "mehs: n", "mehs: there is no such key (did you mean mesh?); allowed: name"),
    ("mesh: n", "mesh: L", "mesh: 'L' is not allowed; allowed: a parameter with `whole: true`: n"),
    ("  half: L/2", "  half: L/2 + t", "let.half: there is no number called 't'"),
    ("  half: L/2", "  half: half/2", "let.half: defined by itself (half -> half)"),
    ("  half: L/2", "  half: sin(45)", "sin takes an angle with a unit"),
    ("  half: L/2", "  half: L + 1", "a number without unit and m cannot be added"),
    ("  half: L/2", "  half: L/2\n  half: L", "half is defined twice (first on line 8)"),
    ("  half: L/2", "  L: 3", "let.L: the name L is defined twice"),
    ("  half: L/2", "  mm: 3", "let.mm: the name 'mm' is not allowed; allowed: a name that"),
    ("  half: L/2", "  lambda: 3", "the name 'lambda' is not allowed"),
    ("  half: L/2", "  half: open(L)", "not arithmetic; allowed: numbers with units"),
    ("  half: L/2", "  half: L/(2 - 2)", "let.half: 'L/(2 - 2)' is not allowed; allowed: arith"),
    ("range: [0.1, 10], ", "range: [2, 10], ", "L.value: 1 is not allowed; allowed: a number"),
    ("range: [0.1, 10], ", "range: [3, 2], ", "allowed: the lowest value first"),
    ("value: 1, unit: m", "value: 1 s, unit: m", "a number in the parameter's `unit`, or with a"),
    ("value: 1, unit: m", "value: '1,5', unit: m", "'1,5' is not allowed (did you mean 1.5?)"),
    ("joint: root, ", "", "actions.spring.joint: missing; allowed: root"),
    ("value: 1, unit: m", "value: 1 m", "a number in the parameter's `unit`, or with a unit that"),
    ("L*cos(stow), 0", "stow*cos(stow), 0", "points.B: stow*cos(stow) is a number or an angle"),
    ("[L*cos(stow), 0, ", "[L*cos(stow), ", "allowed: three coordinates [x, y, z]"),
    ("[L*cos(stow), 0", "[atan2(L, L)*L, 0", "an expression with a comma stands in quotes"),
    ("A: [0, 0, 0]", "A: [L*cos(stow), 0, L*sin(stow)]", "allowed: a length above 0 m from A to B"),
    ("210 GPa", "210 mm", "materials.steel.E: '210 mm' is m; allowed: a value in Pa above 0"),
    ("nu: 0.3", "nu: 0.7", "materials.steel, Poisson's ratio nu: 0.7 is not allowed"),
    ("type: tube, ", "", "sections.tube.type: missing"),
    ("thickness: 2 mm", "thickness: 20 mm", "allowed: at most half the diameter"),
    ("elements: n}", "elements: L/(1 m)}", "of parameters with `whole: true`"),
    ("elements: n}", "elements: 2.5}", "bars.arm.elements: 2.5 is not allowed; allowed: a whole"),
    ("elements: n}", "elements: n, up: B}", "bars.arm.up: 'B' is not allowed; allowed: x, y, z"),
    ("elements: n}", "elements: n, up: {from: A, to: B}}", "direction that is not the bar's own"),
    ("section: tube", "section: tuba", "there is no section 'tuba' (did you mean tube?)"),
    ("section: tube, ", "", "bars.arm.section: missing; allowed: the name of one of `sections`"),
    ("[A, B], section", "[A, A], section", "each once"),
    ("type: revolute", "type: spherik", "(did you mean spherical?); allowed: revolute, spherical"),
    ("type: revolute", "type: spherical", "joints.root.axis: there is no such key; allowed: type"),
    ("at: A, axis", "at: C, axis", "joints.root.at: there is no point 'C'"),
    ("axis: y", "axis: [0, 0, 0]", "joints.root.axis: [0.0, 0.0, 0.0] is not allowed; allowed: a"),
    ("axis: y", "axis: y, held: w", "joints.root.held: 'w' is not allowed; allowed: letters"),
    ("rest: 90 deg", "rest: 90", "whose unit must be said, such as 90 deg"),
    ("3 N m/rad", "3 N", "actions.spring.stiffness: '3 N' is N; allowed: a value in N m/rad of at"),
    ("record:", "bodies: {box: {mass: 1, centre: B}}\nrecord:",
     "bodies.box.box or inertia: missing; allowed: one of the two"),
    ("record:", "bodies: {b: {mass: 1, centre: B, inertia: [1, 1, 3]}}\nrecord:",
     "none of them more than the sum of the other two"),
    ("record:", "bodies: {box: {mass: 1, centre: B, box: [0, 0, 0]}}\nrecord:",
     "edges >= 0, at most two of them 0"),
    ("record:", "struts: {t: {type: spring, stiffness: 1, rest: 3 mm/rad}}\nrecord:",
     "struts.t.rest: '3 mm/rad' is not allowed; allowed: a length in m, not one for each radian"),
    ("record:", "opening_rates: {r: {joint: root, rate: 2 Hz}}\nrecord:",
     "opening_rates.r.rate: '2 Hz' is not allowed; allowed: a value in rad/s, deg/s or rpm"),
    ("record:", "assemble: yes\nrecord:", "assemble: 'yes' is not allowed; allowed: true, false"),
    ("  L: {", "  M: {value: 1}\n  L: {", "parameters.M: nothing uses it"),
]  # fmt: skip


STRUTS = [  # keys of a strut between the points A and B, 1 m apart, and what is said
    ("{part: arm, at: A}", "type: damper, damping: 1",
     "struts.s.between: 'A of arm and A of arm' is not allowed; allowed: points of two parts"),
    ("{part: ground, at: A}", "type: gas spring, force: 5, length: 1500, stroke: 600, ratio: 2",
     "struts.s.length: 1500 is not allowed; allowed: at least 1 m, the distance of its points at"),
    ("{part: ground, at: A}", "type: gas spring, force: 5, length: 0.9, stroke: 0.6, ratio: 2",
     "and at most its stroke, 0.6 m, more"),
]  # fmt: skip


@pytest.mark.parametrize(("place", "keys", "said"), STRUTS)
def test_a_strut_that_cannot_be_is_told_by_its_points_and_their_distance(place, keys, said):
    end = "{part: arm, at: A}" if "arm" in place else "{part: arm, at: B}"
    text = f"struts: {{s: {{between: [{place}, {end}], {keys}}}}}\nrecord:"
    refused(SMALL, "record:", text, said)
    if "gas" in keys:
        fitting = re.sub("length: [0-9.]+, stroke: [0-9.]+", "length: 1.4, stroke: 0.6", text)
        loads(changed(SMALL, ("record:", fitting))).build()


@pytest.mark.parametrize(("old", "new", "said"), WRONG, ids=[new or old for old, new, _ in WRONG])
def test_what_is_wrong_is_said_with_its_line(old, new, said):
    text = changed(SMALL, (old, new))
    for problem in refused(SMALL, old, new, said):
        line, key = re.match(r"line (\d+): ([\w.]+)", problem).groups()
        assert key.split(".")[-1] in text.splitlines()[int(line) - 1] or ": missing" in problem


@pytest.mark.parametrize(("value", "said"), [
    ("!!str L/2", "line 8: the tag 'tag:yaml.org,2002:str' is not allowed"),
    ("*h", "line 8: *h stands for what &h marks, and nothing above is marked so"),
    ("\x07", "line 8: the character '\\x07' is not text"),
    (f"{30 * '['}{30 * ']'}", "line 8: nested too deep; allowed: 20 mappings"),
])  # fmt: skip
def test_what_no_key_may_hold_is_said_with_its_line(value, said):
    refused(SMALL, "  half: L/2", f"  half: {value}", said)


def test_a_part_that_nothing_joins_is_refused():
    loose = "  loose: {through: [B, C], section: tube, material: steel, elements: 2}\njoints:"
    text = changed(SMALL, ("joints:", loose), ("points:", "points:\n  C: [3, 3, 3]"))
    assert problems_of(text) == [
        "line 19: bars.loose: nothing joins it to anything; allowed: parts with a joint, a cable, "
        "a strut, a support, a drive or initial_velocities"
    ]


def test_a_part_that_nothing_joins_may_move_freely():
    loose = "  loose: {through: [B, C], section: tube, material: steel, elements: 2}\njoints:"
    text = changed(SMALL, ("joints:", loose), ("points:", "points:\n  C: [3, 3, 3]"))
    text += "initial_velocities: {loose: {part: loose, about: C, velocity: [1, 0, 0]}}\n"
    scene = loads(text).build()
    assert (scene.velocity == [1.0, 0.0, 0.0]).all(axis=1).sum() == 3


def test_a_point_that_is_not_the_part_s_is_refused():
    text = SMALL.replace("points:", "points:\n  C: [0, 0, 0]").replace("at: A, axis", "at: C, axis")
    assert "allowed: a point of arm: A, B (or let its `carries` hold C)" in problems_of(text)[0]
    text = text.replace("joints:", "bodies: {box: {mass: 1, centre: A, box: [1, 1, 1]}}\njoints:")
    text = text.replace("[ground, arm], at: C", "[ground, box], at: C")
    assert "allowed: a point of box: A (or list C in its `points`)" in problems_of(text)[0]


def test_every_part_of_a_joint_has_a_point():
    refused(OPEN, "{BC: end, CD: C}", "{BC: end}", "joints.C.at: ['BC'] is not allowed; allowed: a")


def test_what_follows_from_a_body_that_cannot_be_built_is_not_told(request):
    text = (request.config.rootpath / "config/structures/hatch.yaml").read_text(encoding="utf-8")
    with pytest.raises(StructureError) as caught:
        loads(text.replace("unit: kg,", "unit: N,", 1))
    (problem,) = caught.value.problems
    assert problem.text.startswith("bodies.lid.mass: 'mass' is N (parameters.mass on line ")


def test_a_structure_without_a_part_is_refused():
    with pytest.raises(StructureError, match="the structure has no part; allowed: at least a bar"):
        loads("points: {A: [0, 0, 0]}").build()


@pytest.mark.parametrize(("old", "new"), [("points:", "pionts:"), ("bars:", "bar:"),
                                          ("value: 2, whole", "value: 2.5, whole"),
                                          ("section: tube, ", "")])  # fmt: skip
def test_what_only_follows_from_a_slip_is_not_told(old, new):
    assert len(problems_of(SMALL.replace(old, new))) == 1


# -- what is left out ------------------------------------------------------------------------------

NOTHING, AHEAD, UPWARDS = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]
DEFAULTS = {
    "materials": {"nu": 0.3, "stiffness_damping": 0.0},
    "bars": {"inertia_scale": 1.0, "strain": 0.0},
    "bodies": {"points": (), "x": AHEAD, "up": UPWARDS},
    "masses": {"inertia": 0.0},
    "supports": {"translations": "xyz", "rotations": "xyz"},
    "joints revolute": {"opening": 0.0, "held": ""},
    "joints prismatic": {"opening": 0.0},
    "joints cylindrical": {"opening_turn": 0.0, "opening_slide": 0.0},
    "joints planar": {"opening_turn": 0.0, "opening_x": 0.0, "opening_y": 0.0},
    "joints pin in slot": {"opening_turn": 0.0, "opening_slide": 0.0},
    "joints screw": {"opening": 0.0},
    "joints pin with play": {
        "restitution": 1.0,
        "friction": 0.0,
        "radius": 0.0,
        "bristle_deflection": 1e-5,
        "opening_turn": 0.0,
        "opening_x": 0.0,
        "opening_y": 0.0,
    },
    "actions torsion spring": {"rest": 0.0},
    "actions spring": {"rest": 0.0},
    "bodies plate": {"thickness": 0.0},
    "actions stop": {"damping": 0.0},
    "actions latch": {"capture_range": 0.0, "side": "either", "damping": 0.0},
    "actions motor": {"damping": 0.0},
    "actions release": {"damping": 0.0},
    "loads": {"force": NOTHING, "moment": NOTHING},
    "drags": {"wind": NOTHING},
    "struts spring": {"acts": "both ways", "damping": 0.0},
    "struts tabulated spring": {"damping": 0.0},
    "struts gas spring": {"exponent": 1.0, "damping": 0.0},
    "struts constant force": {"damping": 0.0},
    "drives": {"velocity": NOTHING, "spin": NOTHING},
    "initial_velocities": {"velocity": NOTHING, "spin": NOTHING},
}
"""What files that exist rely on: another default would change what they mean without a word."""


@pytest.mark.parametrize("name", DEFAULTS)
def test_what_is_left_out_means_what_it_did(name):
    (found,) = (s for s in STATEMENTS if f"{s.group} {s.type}".strip() == name)
    for key, value in DEFAULTS[name].items():
        default = found.keys[key].default
        assert (default.tolist() if isinstance(default, np.ndarray) else default) == value


def test_no_number_is_left_out_of_these():
    for one in STATEMENTS:
        known = DEFAULTS.get(f"{one.group} {one.type}".strip(), {})
        for key, kind in one.keys.items():
            if kind.default is not NO_VALUE and isinstance(kind.default, float | np.ndarray):
                assert key in known, (one.group, key)


def test_the_command_tells_each_parameter_with_its_default_unit_and_limits():
    found = structure("scissor")
    assert describe(found)[:100] in found._repr_html_()  # of notebooks
    rows = {line.split()[0]: line for line in describe(found).splitlines()[::-1] if line.strip()}
    for name, parameter in found.parameters.items():
        row, default = rows[name], parameter.default
        assert ("(from others)" in row) == (default is None)
        if default is not None:
            assert float(row.split()[1]) == pytest.approx(float(default), rel=1e-8)
        assert parameter.unit == "1" or parameter.unit in row


@pytest.mark.parametrize("name", ["½", "x²", "ﬁt", "5\u2075", "℡"])
@pytest.mark.parametrize("group", ["let", "points", "bodies"])
def test_a_name_that_a_message_proposes_is_allowed(name, group):
    problems = Problems("")
    assert not Names(problems, {}).allows(name, "key", 1, group)
    with pytest.raises(StructureError) as error:
        problems.stop()
    proposal = error.value.problems[0].text.partition("such as ")[2].partition(";")[0]
    assert Names(Problems(""), {}).allows(proposal or "n", "key", 1, group)
