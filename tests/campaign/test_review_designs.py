"""Designs whose review sheets a reviewer reads: what is asked of a campaign before its runs, what a
sheet knows of the mechanism, and which design fails, where and why, from `review.md` alone."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from deployable import campaign
from deployable.campaign.config.check import load_config
from deployable.campaign.errors import ConfigError
from deployable.campaign.results import mechanism
from fpm import structures
from fpm.reading import margins
from fpm.reading.responses import parse
from fpm.travel.path import Path as Travelled

DESIGNS = Path(__file__).parent / "designs"
ECSS, NASA = "ecss-e-st-33-01c", "nasa-std-5017b"
MARGIN = {"along": "hinge", "to": "90 deg", "standard": ECSS}
LEFT, RIGHT = "left", "right"


def config(tmp_path, **changes):
    """Design z as a file, with other sections."""
    raw = yaml.safe_load((DESIGNS / "z.yaml").read_text())
    raw["scene"]["file"] = str(DESIGNS / "flap.yaml")
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(raw | changes))
    return [tmp_path / "c.yaml"]


def of(response, **changes):
    """A margin's response and its definition on the flap, whose parameters may differ."""
    scene = structures.load(DESIGNS / "flap.yaml").build(**changes)
    definition = {"margin": "hinge", "to": "90 deg", "standard": ECSS} | response
    return scene, definition, parse("m", definition, scene)


def test_beside_a_margin_by_own_factors_is_that_of_the_standard(tmp_path):
    own = {"both": MARGIN | {"uncertainty_factors": {"FR": 1.5}}, "plain": MARGIN}
    known = load_config(config(tmp_path, margins=own))
    assert list(known.experiment.responses) == ["open", "both", "plain", "both_by_standard"]
    assert "uncertainty_factors" not in known.experiment.responses["both_by_standard"]
    assert list(known.requirements) == ["both", "plain"]
    columns = {curve.name: curve.columns for curve in known.experiment.response_list}
    assert columns["both"] == columns["both_by_standard"], "another factor takes no run"


def test_no_margin_takes_the_name_of_that_by_the_standard(tmp_path):
    own = {
        "m": MARGIN | {"uncertainty_factors": {"FR": 1}},
        "m_by_standard": MARGIN | {"to": "20 deg"},
    }
    with pytest.raises(ConfigError, match=r"margins\.m: .*m_by_standard, which is taken"):
        load_config(config(tmp_path, margins=own))


@pytest.mark.parametrize("taken", [["m", "m_margin"], ["m"], []])
def test_a_requirement_of_a_margin_replaces_none(tmp_path, taken):
    own = {name: {"q": {"at_most": 1}} for name in taken}
    path = config(tmp_path, margins={"m": MARGIN}, requirements=own,
                  quantities={"q": {"final": "open"}})  # fmt: skip
    if len(taken) == 2:
        with pytest.raises(ConfigError, match=r"requirements\.m_margin.*allowed: another name"):
            load_config(path)
        return
    found = load_config(path).requirements
    assert all(found[name] == {"q": {"at_most": 1}} for name in taken)
    assert found["m_margin" if taken else "m"] == {"m_least": {"at_least": 0.0}}


@pytest.mark.parametrize("rest", [0, -90])
def test_a_spring_that_only_resists_is_none_of_several_that_drive(tmp_path, rest):
    """So that factors of a spring that is out are not for it, at rest at the start or before."""
    text = (DESIGNS / "flap.yaml").read_text()
    at = text.index("right: {type: torsion spring")
    text = text[:at] + text[at:].replace("rest: 180 deg", f"rest: {rest} deg", 1)
    (tmp_path / "flap.yaml").write_text(text)
    one = MARGIN | {"standard": NASA, "evidence": "spring out", "without": [RIGHT]}
    scene = yaml.safe_load((DESIGNS / "z.yaml").read_text())["scene"]
    path = config(tmp_path, margins={"m": one}, scene=scene | {"file": "flap.yaml"})
    with pytest.raises(ConfigError, match="right is out; allowed: other evidence"):
        load_config(path)


def test_settings_of_ones_own_are_told_with_those_of_the_standard():
    own = {
        "uncertainty_factors": {"FR": 0.1},
        "actuation_factors": {"S": 1},
        "classes": {"rub": "TL"},
    }
    scene, definition, response = of(own)
    assert mechanism.list_deviations(scene, definition, response) == [
        "FR 0.1 for 6", "driving S 1 for 0.8", "rub as TL for FR",
    ]  # fmt: skip
    kinds = {kind.__name__: kind for kind in scene.kinds}
    assert mechanism.weaker_classes(scene, response) == []
    scene.classes |= {(kinds["Friction"], 0): "TL", (kinds["TorsionSpring"], 1): "HM"}
    found = mechanism.weaker_classes(scene, response)
    assert found == ["right as HM for S", "rub as TL for FR"]
    scene.classes = {(kinds["TableSpring"], 0): "S"}  # it says that it is a spring
    assert mechanism.weaker_classes(scene, response) == []
    scene.classes = {(kinds["TableSpring"], 0): "TL"}
    assert mechanism.weaker_classes(scene, response) == ["wires as TL for HA"]


WINGS = """
name: wings
parameters: {}
points: {a: [0, 0, 0], b: [1, 0, 0], c: [0, 3 m, 0], d: [1, 3 m, 0], g: [-0.5, 0, 0]}
bodies:
  one: {mass: 1 kg, centre: b, box: [1, 1, 0.01], points: [a, b]}
  other: {mass: 1 kg, centre: d, box: [1, 1, 0.01], points: [c]}
joints:
  left: {type: revolute, parts: [ground, one], at: a, axis: z}
  right: {type: revolute, parts: [ground, other], at: c, axis: z}
actions:
  spring: {type: torsion spring, joint: left, stiffness: 0.0784 N m/rad, rest: 180 deg}
  rub: {type: friction, joint: left, moment: 0.002}
  weak: {type: torsion spring, joint: right, stiffness: 0.004 N m/rad, rest: 180 deg}
"""
BELT = "  belt: {type: loop, joints: [left, right], radii: [R, R], stiffness: 1e4 N/m}\n"
WIRES = """struts:
  wires: {type: tabulated spring, between: [{part: ground, at: g}, b], lengths: [0.5, 2], forces: [
    0.05, 0.05]}
"""


@pytest.mark.parametrize(
    ("more", "apart"),
    [
        ("", ["right"]),
        (BELT.replace("R", "0.1"), []),
        (BELT.replace("R, R", "0.1, 0.2"), ["right"]),
    ],
)
def test_openings_are_apart_that_no_loop_moves_as_far(more, apart):
    """Alone, by a belt of 1 to 1, and by one that turns the other half as far."""
    scene = structures.loads(WINGS + more).build()
    assert Travelled(scene, ["left"], ()).find_apart(["right"]) == apart
    definition = {"margin": "left", "with": ["right"], "to": 1, "standard": ECSS}
    assert "margin of left and right" in parse("m", definition, scene).long_name


@pytest.mark.parametrize(
    ("stated", "class_"), [("", "HA"), ("class: S, ", "S"), ("class: HY, ", "HY")]
)
def test_the_table_of_a_strut_is_a_harness_unless_its_class_is_stated(stated, class_):
    scene = structures.loads(WINGS + WIRES.replace("type", f"{stated}type")).build()
    definition = {"margin": "left", "to": "90 deg", "standard": ECSS, "locked": ["right"]}
    response = parse("m", definition, scene)
    least, _ = margins.least(response, margins.sweep_travel(scene, [response]))
    # 0.05 N along the wires, whose length is sqrt(1.25 + cos θ) m, at 90 deg
    resists = 6 * 0.002 + {"S": 2.4}.get(class_, 6.0) * 0.05 / (2 * np.sqrt(1.25))
    assert least == pytest.approx(0.8 * 0.0784 * np.pi / 2 / resists - 1, rel=1e-5)
    assert mechanism.weaker_classes(scene, response) == []


def test_springs_that_drive_are_those_that_drive_somewhere():
    """Two that open the flap all the way, one more that drives on the first part of it only, and
    two that resist, one of them at rest at the start, where it drives by a rounding; friction and
    the harness drive nowhere. Parts that are out count, too."""
    scene, definition, _ = of({})
    for rest in (1.0, 0.0, -0.5):
        scene.add_torsion_spring(0, 0.01, rest)
    first = "torsion spring hinge"
    intact = parse("m", definition, scene)
    run = margins.sweep_travel(scene, [intact])
    for out in ([], [LEFT], ["rub"]):
        own = definition | {"without": out}
        experiment = SimpleNamespace(
            responses={"m": own}, intervals=["k"], nominal=(0.1,), nominal_scene=scene
        )
        found = mechanism.margin_of(
            experiment, [scene], parse("m", own, scene), {"argmin": {"k": 0.09}},
            lambda values, response: run,
        )  # fmt: skip
        assert found["springs"] == [LEFT, RIGHT, first]
        assert found["drives"] == sorted([LEFT, RIGHT, first])
        assert found["without"] == out and found["at"] == {"k": 0.09}
        every = {LEFT, RIGHT, "rub", "wires", *(first + n for n in ("", " #2", " #3"))}
        assert {row["part"] for row in found["budget"]["rows"]} == every - set(out)


@pytest.mark.slow
def test_a_peak_in_the_box_that_no_planned_run_meets_is_found(tmp_path):
    """Friction of 0.05 N m at 45 °C only, with the weakest spring."""
    grease = "(0.005 N m) + (0.045 N m)*exp(-((T - 45)/3)**2)"
    structure = WINGS.replace(
        "parameters: {}",
        f"""parameters:
  k: {{value: 0.1, unit: N m/rad}}
  T: {{value: 20}}
let: {{grease: "{grease}"}}""",
    )
    structure = structure.replace("0.0784 N m/rad", "k").replace("0.002", "grease")
    (tmp_path / "s.yaml").write_text(structure)
    margin = {"along": "left", "to": "90 deg", "standard": ECSS, "locked": ["right"]}
    content = {
        "campaign": "c", "scene": {"file": "s.yaml"}, "design": {"method": "smolyak", "order": 3},
        "intervals": {"k": {"relative": 0.02}, "T": {"lower": -100, "upper": 100, "nominal": 20}},
        "margins": {"m": margin}, "review": ECSS,
    }  # fmt: skip
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(content))
    campaign.run(tmp_path / "c.yaml", tmp_path, figures=False, notify=lambda text: None)
    exact = 0.8 * 0.098 * np.pi / 2 / (6 * 0.05) - 1
    text = (tmp_path / "c/review.md").read_text()
    row = next(row for row in rows_of(text) if row[0] == "4.7.5.3")
    assert row[4].startswith("not met") and f"{exact:.4f}".replace("-", "−") in row[5]


def rows_of(text):
    """The rows of a sheet: number, question, how, value, verdict and nearest."""
    lines = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip().replace("\\", "") for cell in line] for line in lines if len(line) > 4]
