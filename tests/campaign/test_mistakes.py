"""Mistakes that engineers make: one change of a good structure or campaign, and the words that the
message must hold, which a reader can act on at once."""

from __future__ import annotations

import re

import numpy as np
import pytest

import fpm
from deployable.campaign.cli import main
from fpm import structures
from fpm.structures import report
from fpm.structures.plausible import warnings

STRUCTURE = """\
name: barrier
description: A barrier that a spring opens until a latch catches it
parameters:
  L: {value: 1.2, unit: m, description: length of the arm}
  k: {value: 3, unit: N m/rad, range: [0, 1000], description: stiffness of the spring}
let:
  half: L/2
points:
  root: [0, 0, 0]
  tip: [L, 0, 0]
materials:
  steel: {E: 210 GPa, rho: 7850 kg/m3}
sections:
  tube: {type: tube, diameter: 40 mm, thickness: 2 mm}
bars:
  arm: {through: [root, tip], section: tube, material: steel, elements: 2}
joints:
  pivot: {type: revolute, parts: [ground, arm], at: root, axis: -y}
actions:
  push: {type: torsion spring, joint: pivot, stiffness: k, rest: 120 deg}
  catch: {type: latch, joint: pivot, angle: 90 deg}
record:
  tip: {part: arm, at: tip}
"""

CAMPAIGN = """\
campaign: mine
scene: {file: barrier.yaml}
solver: {duration: 2, instants: 201}
intervals:
  k: {relative: 0.1}
  L: {absolute: 0.02}
design: {method: smolyak, order: 2}
responses:
  psi: {opening: pivot}
quantities:
  t: {event: latches, of: catch}
requirements:
  in_time: {t: {at_most: 3}}
"""

MISTAKES = [  # what is replaced, by what, and what the message holds
    ("  tube: {", "\ttube: {", "line 14: this is not YAML: a tab; allowed: spaces"),
    ("description: A", "description A", "line 2: this is not YAML: a colon is missing"),
    ("description: A", "description A\n", "line 2: this is not YAML: a colon is missing"),
    ("value: 1.2,", "value 1.2,", "line 4: parameters.L.value 1.2", "missing: `value: 1.2`"),
    ("value: 1.2,", "value:1.2,", "a space behind the colon is missing: `value: 1.2`"),
    ("40 mm", "2 in", "line 14: sections.tube.diameter", "did you mean 50.8 mm?"),
    ("40 mm", "4,5 mm", "sections.tube.5 mm: there is no such key", "a point, not a comma"),
    ("stiffness: k", "stiffness: 3 Nm/rad", "did you mean 3 N m/rad?"),
    ("half: L/2", "half: L^2", "line 7: let.half", "did you mean L**2?"),
    ("value: 1.2,", "value: 1,2,", "line 4: parameters.L.2", "a point, not a comma"),
    ("[ground, arm]", "[ground, strut]", "there is no part 'strut'; allowed: ground, arm"),
    ("joint: pivot, stiff", "joint: push, stiff", "no joint 'push' (it is one of `actions`)"),
    ("rho: 7850", "density: 7850", "line 12: materials.steel.density", "did you mean rho?"),
    ("relative: 0.1}", "relative: 10}", "line 5: intervals.k", "did you mean 0.1, for 10 %?"),
    ("duration: 2,", "duration: 3 sec,", "line 3: solver.duration: '3 sec'", "did you mean 3 s?"),
    ("{t: {at_most: 3}}", "{max: 3}", "line 13: requirements.in_time.max", "a mapping from"),
    ("{relative: 0.1}", "{min: 2, max: 4}", "did you mean lower?", "did you mean upper?"),
    ("of: catch", "of: catsh", "line 11: quantities.t.of: 'catsh'", "one of latch catch"),
    ("barrier.yaml", "barier.yaml", "line 2: scene.file: barier.yaml, the file cannot be read"),
    ("scene: {file: barrier.yaml}", "scene: {name: barrier}", "line 2: scene.name: 'barrier'"),
    ("file: barrier", "file: a/barrier", "(did you mean barrier.yaml?); allowed: a path from the"),
    ("  push: {type: torsion spring, joint: pivot, ", "  push:\n    type spring\n    joint: p\n  {",
     "line 21: this is not YAML: a colon is missing; allowed: `type: spring`"),
    ("type: tube, diameter: 40 mm, thickness: 2 mm", "type: rectangle, width: 9 mm, height: 2 mm",
     "line 16: bars.arm.up: missing; allowed: the direction", "such as z"),
    ("type: latch, joint: pivot, angle: 90 deg", "type: stop, joint: pivot, stiffness: 9 N m/rad",
     "line 21: actions.catch.lower: missing; allowed: `lower`, `upper`, or both"),
    ("  arm: {", "  arm:\n    arm: {", "line 17: bars.arm.arm: its keys stand one level too deep"),
    ("stiffness: k", "stiffness: 10%", "a product: 0.1*k"),
    ("{t: {at", "{psi: {at", "this is a response; allowed: a quantity, such as `quantities: {la"),
    ("{relative: 0.1}", "{nominal: 1 relative: 0.1}", "a comma is missing before `relative:`"),
    ("design:", "margins: {m: {along: pivot, to: 90, standard: nasa-std-5017b}}\ndesign:",
     "line 7: margins.m.to: 90 is not allowed; allowed: up to 20 rad", "as 90 deg"),
    ("design:", "margins: {m: {along: pivot, to: 3, standard: nasa-std-5017b}}\ndesign:",
     "line 7: margins.m.to: 171.9 deg is beyond 90 deg, where latch catch catches"),
    ("design:", "cases: {a: {}, b: {scene: {k: 2}}}\ndesign:", "cases.b.scene.k: 2, and k is",
     "`intervals: {k: {nominal: 2, relative: 0.1}}` in this case"),
    ("design:", "bars: {}\ndesign:", "(it stands in the file of the structure)"),
    ("  arm: {", "  arms: {", "has 1 problem", "line 18: joints.pivot.parts", "no part 'arm'"),
    ("  pivot: {", "  pivo: {", "has 1 problem", "line 20: actions.push.joint", "mean pivo?"),
    ("  L: {value", "  l: {value", "has 1 problem", "line 7: let.half: there is no number called"),
    ("  t: {event: latches, of: catch}\nrequirements:\n",
     "requirements:\n  soon: {t: {at_most: 2}}\n",
     "has 1 problem", "line 10: quantities: null is not allowed"),
    ("parameters:", "solver: {}\nparameters:", "(it stands in the file of a campaign)"),
]  # fmt: skip


QUANTITY = """\
quantities:
  t: {event: latches, of: catch}
requirements:
  in_time: {t: {at_most: """
IDLE = (
    "is never positive as the joint is stopped, so that no run can break it: did you mean at_least:"
)
SIGNED = [  # the latch pushes back: responses of its impulse and moment, and limits of these
    ("latch_impulse: catch", "final", "at_most: 5 N m s", IDLE, "at_most: 5, but t", "-5?"),
    ("latch_impact: catch, component: signed", "final", "at_most: 2", IDLE, "-2?"),
    ("latch_moment: catch", "smallest", "at_most: 2", IDLE),
    ("joint_moment: pivot, part: latch", "smallest", "at_most: 2", IDLE),
    ("latch_impulse: catch", "final", "at_most: 5, at_least: -5", ""),
    ("latch_impact: catch", "final", "at_most: 5", ""),
    ("latch_moment: catch", "largest", "at_most: 2", ""),
]
UNLIKELY = [  # the same, of what is allowed and hardly meant
    ("40 mm", "40 m", "bar arm is 1.2 m long and 40 m wide: both in metres?"),
    ("40 mm, thickness: 2 mm", "40, thickness: 20", "mass of all of it: 1.184e+07 kg; usual"),
    ("7850 kg/m3", "7.85", "density of bar arm: 7.85 kg/m3; usual: 20 to 25000 kg/m3"),
    ("value: 1.2,", "value: 1200,", "largest extent of all of it: 1200 m", "only 0.04 m wide"),
    ("thickness: 2 mm", "thickness: 2 um", "bar arm is 0.04 m wide and only 2e-06 m thick"),
    ("rest: 120 deg", "rest: -120 deg", "away from latch catch at 90 deg, with 6.283 N m: give"),
    ("angle: 90 deg", "angle: 150 deg", "latch catch at 150 deg is beyond where the springs on pi"),
    ("actions:", "actions:\n  end: {type: stop, joint: pivot, stiffness: 1000, upper: 80 deg}",
     "latch catch at 90 deg is beyond the stop at 80 deg: it cannot catch"),
    ("actions:", "struts:\n  s: {type: tabulated spring, between: [{part: ground, at: root}, tip], "
     "lengths: [900, 1500], forces: [7, 5]}\nactions:", "s is 1.2 m long at the start", "7 N"),
    ("actions:", "struts:\n  s: {type: tabulated spring, between: [{part: ground, at: root}, tip], "
     "lengths: [0.2, 0.9], forces: [7, 0]}\nactions:", ""),
    ("name: barrier", "name: barrier\ngravity: [0, 0, -9.81]\nloads:\n  wind: {part: arm, at: tip,"
     " force: [1, 0, 0]}", ""),
    ("duration: 2,", "duration: 0.02,", "0.02 s are too short for latch catch at 90 deg", "6.283"),
    ("{event: latches, of: catch}", "{crossing: psi, level: 45}", "2578 deg: did you mean"),
    ("{event: latches, of: catch}", "{crossing: psi, level: 2}", "is beyond 90 deg, where"),
    ("at_most: 3", "at_least: 5", "5 s, but runs end at 2 s, so that none can meet it"),
    ("at_most: 3", "at_least: 0", "warning: line 13: requirements.in_time.t.at_least: 0, but t is "
     "never below 0, so that it asks only that it happens"),
    ("at_most: 3", "at_most: -1", "-1, but t is never below 0, so that none can meet it"),
    ("at_most: 3", "at_most: 30", "30 s, but runs end at 2 s, so that all where it happens"),
    *((QUANTITY + "3}}", f"  j: {{{response}}}\nquantities:\n  t: {{{kind}: j}}\nrequirements:\n"
       f"  in_time: {{t: {{{limits}}}}}", *words)
      for response, kind, limits, *words in SIGNED),
    ("instants: 201", "instants: 12", "12 for 2 s are 0.1818 s apart", "take 201 or more"),
    ("actions:\n", "  end: {type: fixed, parts: [ground, arm], at: tip}\nactions:\n",
     "nothing can move but by bending, and it is held by joint end: check axes"),
    ("{event: latches, of: catch}", "{crossing: psi, level: 370 deg}", "370 deg, more than a turn"),
    ("order: 2}", "order: 2, samples: 500}", "design.samples: 500 is of sobol and screening alone"),
    ("{event: latches, of: catch}", "{value: psi, at: 15}", "t.at: 15 s, but runs last from 0"),
    ("relative: 0.1", "relative: 0", "line 5: intervals.k: 3 to 3 has no width", "scene.param"),
    ("absolute: 0.02", "absolute: 20", "intervals.L: -18.8 to 21.2 about 1.2", "the unit m of L"),
]  # fmt: skip


def test_a_step_longer_than_a_pulse_is_told(tmp_path, capsys, monkeypatch):
    pulse = "curves: {p: {times: [0.5, 0.50003, 0.50006], values: [0, 1, 0]}}\nloads:\n"
    load = "  blow: {part: arm, at: tip, force: [0, 0, 1 N], curve: p}\nactions:"
    monkeypatch.setitem(globals(), "STRUCTURE", STRUCTURE.replace("actions:", pulse + load))
    text = told(tmp_path, capsys, monkeypatch, "201}", "201, step: 5e-5}")
    assert "solver.step: 5e-05 s is longer than 7.5e-06 s" in text and "most 7.5e-06" in text
    text = told(tmp_path, capsys, monkeypatch, "201}", "201}")
    assert "longer than" not in text


@pytest.mark.parametrize(
    ("response", "quantity", "limit", "words"),
    [
        ("joint_moment: pivot, part: stop", "largest: j", "5", "at_least: -5, of its smallest v"),
        ("joint_moment: pivot, part: stop", "smallest: j", "5", "did you mean at_least: -5?"),
        ("opening: pivot", "smallest_at: j", "3", "runs end at 2 s, so that no run can break it"),
        (
            "opening: pivot",
            "settling: j, within: 0.1",
            "2",
            "runs end at 2 s, so that no run can break it",
        ),
    ],
)
def test_limits_that_no_run_can_break(
    tmp_path, capsys, monkeypatch, response, quantity, limit, words
):
    stop = "actions:\n  end: {type: stop, joint: pivot, stiffness: 1000, upper: 80 deg}"
    monkeypatch.setitem(globals(), "STRUCTURE", STRUCTURE.replace("actions:", stop))
    new = f"  j: {{{response}}}\nquantities:\n  t: {{{quantity}}}\nrequirements:\n"
    text = told(
        tmp_path, capsys, monkeypatch, QUANTITY + "3", f"{new}  in_time: {{t: {{at_most: {limit}"
    )
    assert words in text


def test_radians_of_a_parameter_in_degrees_are_told(tmp_path, capsys, monkeypatch):
    text = STRUCTURE.replace("parameters:\n", "parameters:\n  up: {value: 90, unit: deg}\n")
    monkeypatch.setitem(globals(), "STRUCTURE", text.replace("angle: 90 deg", "angle: up"))
    for nominal, count in (("1.57", 1), ("88", 0)):
        new = f"up: {{nominal: {nominal}, absolute: 0.02}}"
        text = told(tmp_path, capsys, monkeypatch, "L: {absolute: 0.02}", new)
        assert text.count("intervals.up: did you mean 89.95, for 1.57 rad, not deg?") == count


def told(folder, capsys, monkeypatch, old: str, new: str) -> str:
    """What `structure`, or `check`, says of the files in which `old` is `new`."""
    monkeypatch.chdir(folder)
    is_structure = old in STRUCTURE
    assert is_structure or old in CAMPAIGN
    for name, text in (("barrier.yaml", STRUCTURE), ("mine.yaml", CAMPAIGN)):
        (folder / name).write_text(text.replace(old, new, 1), encoding="utf-8")
    main(["structure", "barrier.yaml", "--no-picture"] if is_structure else ["check", "mine.yaml"])
    found = capsys.readouterr()
    return found.out + found.err


@pytest.mark.parametrize(
    ("old", "new", "words"), [(old, new, words) for old, new, *words in MISTAKES]
)
def test_a_mistake_is_told_with_its_line_and_a_remedy(
    tmp_path, capsys, monkeypatch, old, new, words
):
    said = told(tmp_path, capsys, monkeypatch, old, new)
    for word in words:
        assert word in said
    assert len(said.splitlines()) <= 3
    assert max(map(len, said.splitlines())) < 300  # three lines of a terminal


@pytest.mark.parametrize(
    ("old", "new", "words"), [(old, new, words) for old, new, *words in UNLIKELY]
)
def test_what_is_hardly_meant_is_warned_of_with_its_number(
    tmp_path, capsys, monkeypatch, old, new, words
):
    said = told(tmp_path, capsys, monkeypatch, old, new)
    warned = [line for line in said.splitlines() if "warning" in line]
    assert "problem" not in said and len(warned) <= 3
    for word in words:
        assert word in "\n".join(warned)
    assert (IDLE in said) == (IDLE in words)


FOUR_BAR = """\
points: {a: [0, 0, 0], b: [0, 1, 0], c: [2, 1, 0], d: [2, 0, 0], e: [1, 1, 0], f: [2, 0.5, 0]}
bodies:
  crank: {mass: 1, centre: a, box: [0.1, 1, 0.1], points: [b]}
  coupler: {mass: 1, centre: e, box: [2, 0.1, 0.1], points: [b, c]}
  rocker: {mass: 1, centre: f, box: [0.1, 1, 0.1], points: [c, d]}
joints:
  a: {type: revolute, parts: [ground, crank], at: a, axis: z}
  b: {type: revolute, parts: [crank, coupler], at: b, axis: z}
  c: {type: revolute, parts: [coupler, rocker], at: c, axis: z}
  d: {type: revolute, parts: [ground, rocker], at: d, axis: z}
actions:
  push: {type: torsion spring, joint: a, stiffness: 1, rest: 90 deg}
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("", "", ""),
        ("  d: {type: revolute, parts: [ground, rocker], at: d, axis: z}\n", "",
         "a part hangs at joint c alone, on which nothing acts; mobility 3: is another joint"),
        ("[2, 0.1, 0.1]", "[2000, 100, 100]", "inertia of a box of 2000 x 100 x 100"),
        ("[2, 0.1, 0.1]", "[2, 0.1, 100]", "where all points lie within 2 m"),
    ],
)  # fmt: skip
def test_a_joint_left_out_and_boxes_in_mm_are_warned_of(old, new, words):
    found = warnings(structures.loads(FOUR_BAR.replace(old, new)).build())
    assert len(found) == bool(words) and words in "".join(found)


LATCHED = (
    FOUR_BAR
    + """\
  catch: {type: latch, joint: a, angle: 30 deg, side: below}
  rub: {type: friction, joint: a, moment: 0.5}
drags:
  air: {part: coupler, through: [e], area: 2, coefficient: 1, density: 0}
"""
)
STILL = LATCHED.partition("drags")[0]
DOUBTS = [  # a structure, what is replaced, by what, and words of its only warning; "": none
    (LATCHED, "", "", ""),
    (LATCHED, "side: below", "side: above",
     "latch catch at 30 deg catches from above, but its joint starts below it, at 0 deg", "below`"),
    (LATCHED, "rest: 90 deg", "rest: -90 deg",
     "push away from latch catch at 30 deg, with 1.571 N m: give them a `rest` beyond it"),
    (LATCHED, "mass: 1, centre: e", "mass: 1000, centre: e", "0.1 x 0.1 m, 5e+04 kg/m3"),
    (LATCHED, "0.1, 0.1]", "0.001, 0.001]", ""),  # a line
    (LATCHED, "drags:", "gravity: [0, 0, -9810]\ndrags:", "gravity is 9810 m/s2"),
    (LATCHED, "area: 2", "area: 20000", "an area of 2e+04 m2, on a structure of 2 m"),
    (LATCHED, "points: {", "points: {lamp: [900, 0, 0], ", "point lamp is 898", "within 2 m"),
    (STILL, "moment: 0.5", "moment: 1.58", "on a 1.58 N m against 1.571: take less friction"),
    (STILL, "moment: 0.5", "moment: 1.55", ""),
    (STILL, "actions", "supports: {tip: {part: rocker, at: c}}\nactions",
     "nothing can move: no part is elastic, and it is held by support tip, joint a, jo"),
]  # fmt: skip


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("text", "old", "new", "words"), [(*d[:3], d[3:]) for d in DOUBTS])
def test_what_is_hardly_meant_is_warned_of_once(text, old, new, words):
    scene = structures.loads(text.replace(old, new, 1)).build()
    found = warnings(scene)
    assert len(found) == bool(words[0]), found
    assert all(word in found[0] for word in words if word)
    assert np.isfinite(report.centre(scene)).all() and report.mass(scene) >= 3


@pytest.mark.parametrize(
    ("bolt", "words"),
    [
        ("type: release, joint: a, time: 1 s", "allowed: 0 rad/s, to which release bolt holds it"),
        ("type: motor, joint: a, turn: 1 rad, curve: ramp", "0.5 rad/s, to which motor bolt holds"),
        ("type: damper, joint: a, damping: 1", "allowed: a rate that joints, motors, drives, supp"),
    ],
)
def test_a_rate_that_a_joint_cannot_have_is_refused_with_what_holds_it(bolt, words):
    text = "curves: {ramp: {times: [0, 2 s], values: [0, 1]}}\n" * ("ramp" in bolt) + FOUR_BAR
    text += f"  bolt: {{{bolt}}}\nopening_rates:\n"
    text += "".join(f"  go_{joint}: {{joint: {joint}, rate: 1 rad/s}}\n" for joint in "ab")
    with pytest.raises(fpm.SceneError, match=re.escape(words)):
        structures.loads(text).build()


def test_weight_does_not_hide_that_a_run_is_too_short():
    structure = structures.loads(STRUCTURE + "gravity: [0, 0, -9.81]\n")
    assert "6.283 N m of the springs and the weight" in "".join(warnings(structure.build(), 0.02))
    assert warnings(structure.build(), 2.0) == []


def test_a_case_with_a_mistake_is_there_for_the_requirements(tmp_path, capsys, monkeypatch):
    text = "cases: {one: {intervals: {k: 2}}}\nrequirements:\n  r: {t: {at_most: 3}, cases: [one]}"
    said = told(tmp_path, capsys, monkeypatch, "requirements:", text)
    assert "has 1 problem" in said and "cases.one.intervals.k: 2 is not allowed" in said


@pytest.mark.parametrize(
    ("command", "text", "words"),
    [
        ("check", STRUCTURE, "this is a structure's file, not a campaign's: use `structure"),
        ("run", STRUCTURE, "this is a structure's file, not a campaign's: use `structure"),
        ("structure", CAMPAIGN, "this is a campaign's file, not a structure's: use `check"),
    ],
)
def test_the_file_of_the_other_command_is_told_at_once(tmp_path, capsys, command, text, words):
    (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
    assert main([command, str(tmp_path / "a.yaml")]) == 1
    said = capsys.readouterr().err
    assert words in said and len(said.splitlines()) == 2
