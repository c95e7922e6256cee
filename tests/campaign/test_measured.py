"""Measured curves: what is refused before any job starts, and what a campaign says of them."""

import copy
import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from deployable import campaign
from deployable.campaign.config.check import check_config
from deployable.campaign.config.measured import measured_warnings, read_test
from deployable.campaign.errors import ConfigError
from deployable.campaign.stages import STAGES
from fpm.structures.curves_file import CurvesFileError

FOLDER = Path(__file__).parents[2] / "config/measured"
CURVES = "t [s],angle [rad]\n0.1,2\n0.2,1.9\n0.3,1.8\n"
BAND = "t [s],angle [rad],angle_band [rad]\n0.1,2,1e-3\n0.2,1.9,1e-3\n0.3,1.8,{}\n"


@pytest.fixture
def raw(tmp_path):
    """The first test's config, with the curves `CURVES`."""
    (tmp_path / "curves.csv").write_text(CURVES)
    content = yaml.safe_load((FOLDER / "first_test.yaml").read_text(encoding="utf-8"))
    content["scene"] = {"file": str(FOLDER / "arm.yaml")}
    content["measured"]["swing"]["file"] = str(tmp_path / "curves.csv")
    return content


def problems(raw, curves=None, **changes):
    """What a config with other curves, or changed keys of its test, is refused for."""
    raw = copy.deepcopy(raw)
    test = raw["measured"]["swing"]
    if curves is not None:
        Path(test["file"]).write_text(curves)
    for key, value in changes.items():
        test[key] = value
    with pytest.raises(ConfigError) as error:
        check_config(raw)
    assert all("allowed: " in problem for problem in error.value.problems)
    return "\n".join(error.value.problems)


@pytest.mark.parametrize(
    ("curves", "words"),
    [
        ("", "line 1: '' is not a line of names with units"),
        ("t [s],angle\n0,1\n", "columns.angle: {}, line 1: angle: it has no unit; allowed"),
        (
            "t [s],angle [mm]\n0,1\n1,1\n2,1\n",
            "csv has m, which does not fit phi; allowed: a unit that fits rad",
        ),
        (
            CURVES.replace("t [s]", "t [ms]"),
            "instants are 0.0001 s apart (are its times in s?); allowed: at least three",
        ),
        ("angle [rad],x [m]\n0,1\n", "line 1: 'angle [rad],x [m]' has no column with a unit of"),
        ("t [s],phi [rad]\n0,1\n1,1\n2,1\n", "there is no such column of "),
        (CURVES + "3.1,1\n", "ends 3.1 s into the run, at the least delay, the run at 3 s"),
        (BAND.format("1e-3"), "phi has two bands"),
    ],
)
def test_curves_that_cannot_be_used_are_told_with_file_and_line(raw, curves, words):
    assert words.format(raw["measured"]["swing"]["file"]) in problems(raw, curves)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"file": "absent.csv"}, "measured.swing.file: absent.csv: No such file"),
        ({"columns": {"angle": "psi"}}, "measured.swing.columns.angle: there is no such response"),
        ({"band": {}}, "measured.swing.band.phi: phi has no band"),
        ({"band": {"angle": 0.1}}, "measured.swing.band.angle: a band is named after its response"),
        ({"band": {"phi": 0.0}}, "measured.swing.band.phi: 0.0 is not allowed; allowed: a number"),
        ({"model": {"psi": 1.0}}, "measured.swing.model.psi: there is no such response"),
        ({"unknown": {"delay": [1, 0]}}, "measured.swing.unknown.delay: [1.0, 0.0] is not allowed"),
        (
            {"unknown": {"delay": [0, 0.15]}, "window": [0.1, 0.3]},
            "two times in s from 0.15 to 0.3",
        ),
        (
            {"window": [100, 300]},
            "[100, 300] s, and the file has 0.1 to 0.3 s (did you mean [0.1, 0.3]?)",
        ),
        ({"window": [0.15, 0.25]}, "1 instants of "),
        ({"start": {"angel": [1, 2]}}, "measured.swing.start.angel: there is no such real para"),
        ({"start": {"rate": [1, 1]}}, "measured.swing.start.rate: [1, 1] is not allowed"),
        ({"scene": {"angle": 2}}, "measured.swing.start.angle: angle is defined twice"),
        ({"scene": {"mass": -1}}, "measured.swing.scene.mass: -1 is not allowed"),
        ({"use": "check"}, "measured: all tests are of use check"),
        ({"use": "verify"}, "measured.swing.use: 'verify' is not allowed"),
    ],
)
def test_tests_that_cannot_be_used_are_told_with_key_and_value(raw, changes, words):
    assert words in problems(raw, **changes)


def test_a_band_larger_than_its_curve_is_warned_of(raw):
    assert not [*measured_warnings(check_config(raw))]
    raw["measured"]["swing"]["band"]["phi"] = 20
    (text,) = measured_warnings(check_config(raw))
    assert "the band of phi, 20 rad, is larger than all of its curve, 1.8 to 2 rad" in text


@pytest.mark.parametrize(
    ("curves", "words"),
    [
        ("t [ms],angle [rad]\n0.1,2\n0.2,1.9\n0.3,1.8\n", "span 0.0002 s, and a run 3 s: check"),
        ("t [s],angle [rad]\n0,2\n0.1,1.9\n0.2,1.8\n400,1.8\n", "span 400 s, and a run 3 s: "),
        ("wait [s],angle [rad]\n0,2\n1,1.9\n2,1.8\n", "csv is the column `wait`: if this is right"),
        ("t [s],angle [rad]\n0.1,116\n0.2,109\n0.3,103\n", "phi reaches 116 rad in"),
        ("t [s],angle [deg]\n0.1,2\n0.2,1.9\n0.3,1.8\n", "phi reaches 0.03491 rad in"),
    ],
)
def test_a_unit_that_makes_times_or_values_improbable_is_questioned(raw, curves, words):
    raw["measured"]["swing"]["unknown"] = {}
    assert not [*measured_warnings(check_config(raw))]
    Path(raw["measured"]["swing"]["file"]).write_text(curves)
    raw["measured"]["swing"] |= {"window": [0, 3]} if "400" in curves else {}
    (text,) = measured_warnings(check_config(raw))
    assert words in text
    raw["measured"]["swing"].pop("window", None)
    ends = ("s", "ms", 2000), ("ms", "us", 2e6), ("s", "us", 2e6), ("min", "s", 2), ("s", "", 2e4)
    for header, true, end in ends:
        late = problems(raw, f"t [{header}],angle [rad]\n0,2\n{end / 2},1.9\n{end},1.8\n")
        hint = f"the run at 3 s (are its times in {true}?)" if true else "the run at 3 s;"
        assert hint in late


SLED = """
parameters: {k: {value: 50, unit: N/m, range: [1, 100]}}
points: {o: [0, 0, 0]}
bodies: {sled: {mass: 1, centre: o, box: [1 m, 1 m, 1 m]}}
joints: {rail: {type: prismatic, parts: [ground, sled], at: o, axis: x, opening: START}}
actions: {spring: {type: spring, joint: rail, stiffness: k, rest: 0.1 m}}
"""


@pytest.mark.parametrize("start", ["0.1 m", "0 m"])
@pytest.mark.parametrize(
    ("unit", "factor", "count"),
    [("m", 1, 0), ("mm", 1e3, 0), ("m", 1e3, 1), ("m", 1e6, 1), ("mm", 1e6, 1), ("um", 1e3, 2)],
)
def test_lengths_in_another_unit_than_stated_are_questioned(tmp_path, start, unit, factor, count):
    """Of a body alone, which has no extent. Too small values are so by the opening at the start;
    their band exceeds them, too."""
    (tmp_path / "sled.yaml").write_text(SLED.replace("START", start))
    rows = "".join(f"{t / 10},{0.1 * factor * np.cos(t / 2):.9g}\n" for t in range(11))
    (tmp_path / "pos.csv").write_text(f"t [s],pos [{unit}]\n{rows}")
    config = check_config({
        "campaign": "sled", "scene": {"file": str(tmp_path / "sled.yaml")},
        "solver": {"duration": 1, "instants": 101}, "intervals": {"k": {"relative": 0.1}},
        "responses": {"x": {"opening": "rail"}}, "measured": {"push": {
            "file": str(tmp_path / "pos.csv"), "columns": {"pos": "x"}, "band": {"x": 0.0005}}},
    })  # fmt: skip
    texts = [*measured_warnings(config)]
    assert len(texts) == (1 if start == "0 m" and count == 2 else count)
    if count == 1:
        assert f"x reaches {factor * {'m': 0.1, 'mm': 1e-4}[unit]:.4g} m in " in texts[0]
        assert "size is 0.4082 m: check the unit in the file" in texts[0]  # sqrt(1/6) m


def test_a_column_may_have_the_name_of_its_response(raw):
    file = Path(raw["measured"]["swing"]["file"])
    file.write_text(file.read_text().replace("angle", "phi"))
    raw["measured"]["swing"]["columns"] = {"phi": "phi"}
    assert check_config(raw).measured["swing"].columns == {"phi": "phi"}


def test_a_file_that_changed_makes_the_answers_stale_and_is_not_taken(raw):
    first = check_config(raw)
    path = Path(first.measured["swing"].file)
    path.write_text(CURVES.replace("1.8", "1.7"))
    second = check_config(raw)
    basis = [[stage.basis(stage.sections_of(c)) for stage in STAGES.values()]
             for c in (first, second)]  # fmt: skip
    names = [n for n, a, b in zip(STAGES, *basis, strict=True) if a != b]
    assert names == ["answers"]
    with pytest.raises(CurvesFileError, match="it changed since it was checked"):
        read_test(first.measured["swing"])


@pytest.mark.slow
def test_a_campaign_tells_what_the_first_test_leaves(raw, tmp_path):
    """With the same test as a check, which must be inside, under a name that comes before."""
    test = {**raw["measured"]["swing"], "file": str(FOLDER / "first_test.csv")}
    tests = {"again": {**test, "use": "check"}, "swing": test}
    raw |= {"measured": tests, "review": "ecss-e-st-33-01c", "verify": {"max_iterations": 2},
            "requirements": {"in_time": {"t_low": {"at_most": 0.215}}}}  # fmt: skip
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    folder = tmp_path / "first_test"
    facts = json.loads((folder / "measured.json").read_text(encoding="utf-8"))
    hidden = {"distance": 0.1479, "viscous": 2.2e-4}
    for p in facts["parameters"]:
        assert p["seen"] == "both" and p["after"][0] < hidden[p["name"]] < p["after"][1]
    assert not facts["refuted"] and facts["attained"] < 1 and facts["checks"][0]["inside"]
    assert facts["limits"][0]["met"] == "all"
    (curve,) = [t["curves"]["phi"] for t in facts["tests"] if t["use"] == "calibrate"]
    lower, upper, (low, high) = (np.array(curve[key]) for key in ("lower", "upper", "left"))
    assert (lower <= low).all() and (high <= upper).all()
    assert 0 < (high - low).max() < 0.2 * (upper - lower).max()
    summary = (folder / "summary.md").read_text(encoding="utf-8")
    assert "A part of the narrowed box explains the tests" in summary
    assert "Check test again agrees: " in summary
    sheet = (folder / "review.csv").read_text(encoding="utf-8")
    assert "the intervals that remain after the tests" in sheet
