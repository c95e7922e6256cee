"""Numbers of a config with units are those without: the same campaign, digests and plan."""

from __future__ import annotations

import copy
import json
import re
from decimal import Decimal
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from deployable.campaign.config.check import check_config, load_config
from deployable.campaign.config.loader import read_file
from deployable.campaign.config.measured import measured_warnings
from deployable.campaign.config.plausible import requirement_warnings
from deployable.campaign.config.sections import Campaign, as_json, digest, from_data
from deployable.campaign.config.units import StatedUnits
from deployable.campaign.errors import ConfigError

ROOT = Path(__file__).parents[2]
SHIPPED = [*sorted(ROOT.glob("config/*.yaml")), ROOT / "config/measured/first_test.yaml"]
FINER = {"s": ("ms", 3), "m": ("mm", 3), "1": ("%", 2), "N m": ("N mm", 3), "Pa": ("kPa", -3)}
"""Units in which numbers are stated here, and how many digits their point moves."""

UNITS = {  # of keys: fixed ones, or whose
    r"accuracy(\.tolerance(_by_name\.\w+)?)?": "1",
    r"(cases\.[^.]+\.)?solver\.duration|solver\.step|measured\.\w+\.(window|unknown\.delay)": "s",
    r"solver\.(safety|energy_tolerance)|measured\.\w+\.unknown\.gain\.\w+": "1",
    r"(cases\.[^.]+\.)?intervals\.(\w+)\.relative|responses\.\w+\.at": "1",
    r"(?:cases\.[^.]+\.)?intervals\.(\w+)\.\w+|choose\.parameters\.(\w+)": "parameter",
    r"scene\.parameters\.(\w+)|cases\.[^.]+\.scene\.(\w+)|measured\.\w+\.start\.(\w+)": "parameter",
    r"requirements\.\w+\.(\w+)\.at_(?:least|most)": "quantity",
    r"published\.(\w+)|measured\.\w+\.(?:unknown\.offset|band|model)\.(\w+)": "response",
    r"quantities\.(\w+)\.(?:level|about|within)": "response of",
    r"quantities\.\w+\.at": "s",
    r"jobs\.minutes|accuracy\.max_core_minutes": "min",
}


class Rewriting:
    """States the numbers of a config with units; count: how many by whose unit."""

    def __init__(self, campaign, raw):
        experiment = campaign.experiment
        quantities = {quantity.name: quantity for quantity in experiment.quantity_list}
        self.units = {
            "parameter": {n: p.unit for n, p in experiment.scene_type.parameters.items()},
            "response": {curve.name: curve.unit for curve in experiment.response_list},
            "quantity": {n: quantity.unit for n, quantity in quantities.items()},
            "response of": {n: q.response.unit for n, q in quantities.items() if q.response},
        }
        self.count: dict[str, int] = {}
        self.raw = self.stated(raw, ())

    def stated(self, value, path):
        if isinstance(value, dict):
            return {key: self.stated(item, (*path, key)) for key, item in value.items()}
        if isinstance(value, list):
            return [self.stated(item, path) for item in value]
        if isinstance(value, bool) or not isinstance(value, int | float):
            return value
        for pattern, unit in UNITS.items():
            if match := re.fullmatch(pattern, ".".join(path)):
                names = [name for name in match.groups() if name]
                symbol = self.units[unit][names[-1]] if unit in self.units else unit
                self.count[unit] = self.count.get(unit, 0) + 1
                return self.text(value, symbol)
        return value

    def text(self, value, symbol):
        """A whole number keeps its unit, so that it stays whole."""
        scale = FINER if isinstance(value, float) else {}
        name, digits = scale.get(symbol, (symbol.replace("degree", "deg"), 0))
        return value if name == "1" else f"{Decimal(repr(value)).scaleb(digits)} {name}"


def in_folder(path: Path, monkeypatch) -> dict:
    monkeypatch.chdir(path.parent)
    return read_file(path).data


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_campaigns_stated_with_units_are_the_same(path, monkeypatch):
    """And come back from JSON; nothing in them is warned of."""
    raw = in_folder(path, monkeypatch)
    expected = check_config(raw)
    doubts = [*expected.experiment.warnings, *requirement_warnings(expected)]
    assert [*doubts, *measured_warnings(expected)] == []
    rewriting = Rewriting(expected, copy.deepcopy(raw))
    assert sum(rewriting.count.values()) >= 2
    again = check_config(yaml.safe_load(yaml.safe_dump(rewriting.raw, sort_keys=False)))
    assert again == expected
    assert digest(again.experiment) == digest(expected.experiment)
    sections = [as_json(**{n: getattr(c, n) for n in vars(c) if n != "case_campaigns"})
                for c in (again, expected)]  # fmt: skip
    assert sections[0] == sections[1]
    whole = {name: getattr(expected, name) for name in Campaign.__dataclass_fields__}
    assert from_data(Campaign, json.loads(as_json(**whole))) == expected
    for name, case in expected.case_campaigns.items():
        assert digest(again.case_campaigns[name].experiment) == digest(case.experiment)


PANEL = """
campaign: panel
scene: {file: panel.yaml}
solver: {duration: 0.5, instants: 51}
intervals: {k: {relative: 0.1}}
responses: {hinge: {opening: hinge}, tip: {velocity: tip, component: norm}}
quantities: {t: {crossing: hinge, level: 0.5}, most: {largest: tip}}
requirements: {in_time: {t: {at_most: 0.4}}}
"""


@pytest.fixture
def panel(monkeypatch) -> dict:
    monkeypatch.chdir(ROOT / "config" / "structures")
    return yaml.safe_load(PANEL)


def changed(raw: dict, key: str, value) -> dict:
    *names, last = key.split(".")
    section = raw
    for name in names:
        section = section.setdefault(name, {})
    section[last] = value
    return raw


@pytest.mark.parametrize(("key", "text", "number"), [
    ("solver.duration", "0.7 ms", 0.0007), ("solver.duration", "1.1ms", 0.0011),
    ("solver.duration", "0.01 min", 0.6), ("solver.step", "20 us", 2e-5),
    ("intervals.k.relative", "12.5 %", 0.125),
    ("intervals.side", {"absolute": "1 cm"}, {"absolute": 10.0}),
    ("intervals.rest", {"lower": "1 rad", "upper": "180 deg"},
     {"lower": 57.29577951308232, "upper": 180}),
    ("scene.parameters.E", "70e9 Pa", 70.0), ("scene.parameters.side", "0.1 m", 100.0),
    ("quantities.t.level", "90 deg", 1.5707963267948966),
    ("requirements.in_time.t.at_most", "400ms", 0.4),
    ("choose", {"parameters": {"L": ["900 mm", "1.2 m"]}, "minimise": "upper(t)"},
     {"parameters": {"L": [0.9, 1.2]}, "minimise": "upper(t)"}),
    ("published.tip", "500 mm/s", 0.5),
    ("quantities.s", {"settling": "tip", "within": "3 mm/s", "about": "0 m/s"},
     {"settling": "tip", "within": 0.003, "about": 0}),
    ("margins.m", {"along": "hinge", "to": "90 deg", "standard": "nasa-std-5017b",
                   "specified_acceleration": "180 deg/s2", "output_torque": "3 N mm"},
     {"along": "hinge", "to": "90 deg", "standard": "nasa-std-5017b",
      "specified_acceleration": 3.141592653589793, "output_torque": 0.003}),
    ("accuracy", "5 %", 0.05),
    ("accuracy", {"tolerance_by_name": {"t": "2 %"}, "max_core_minutes": "2 min"},
     {"tolerance_by_name": {"t": 0.02}, "max_core_minutes": 2}),
])  # fmt: skip
def test_a_text_stands_for_its_number(panel, key, text, number):
    stated = check_config(changed(copy.deepcopy(panel), key, text))
    assert stated == check_config(changed(panel, key, number))


@pytest.mark.parametrize(("key", "text", "allowed"), [
    ("solver.duration", "3 m", "a number from 1e-9 to 1e6 (s), with or without a unit that fits"),
    ("solver.duration", "3 %", "(s), with or without"),
    ("solver.instants", "3 s", "a whole number from 2 to 1000000"),
    ("intervals.k", {"absolute": "10 %"}, "(N m rad-1), with or without a unit that fits"),
    ("intervals.rest", {"lower": "3 %", "upper": 3}, "(degree), with or without"),
    ("requirements.in_time.t.at_most", "3 rad", "a number (s), with or without"),
    ("requirements.in_time.most.at_most", "3 m/s2", "a number (m s-1), with or without"),
    ("quantities.t.level", "3 %", "a number (rad), with or without"),
    ("scene.parameters.L", "3 kg", "a number (m), with or without"),
    ("scene.parameters.elements", "3 deg", "a number, or in %"),
    ("choose.parameters.L", [1, "2 s"], "two numbers (m), with or without"),
    ("design.order", "3 s", "a whole number from 1 to 64"),
    ("solver.duration", "80e-3", "(did you mean 0.08?)"),
    ("solver.step", "1e999 s", "`auto` or a number above 0 (s), with or without"),
])  # fmt: skip
def test_a_unit_that_does_not_fit_is_refused_once(panel, key, text, allowed):
    with pytest.raises(ConfigError) as caught:
        check_config(changed(panel, key, text))
    mine = [p for p in caught.value.problems if p.startswith(key)]
    assert len(mine) == 1 and "' is not allowed" in mine[0] and allowed in mine[0]


def test_units_of_a_case_are_of_its_structure(panel, tmp_path):
    text = Path("panel.yaml").read_text(encoding="utf-8")
    assert "L: {value: 1, unit: m, range: [0.01, 100]," in text
    other = text.replace("L: {value: 1, unit: m, range: [0.01, 100],", "L: {value: 1000, unit: mm,")
    (tmp_path / "other.yaml").write_text(other, encoding="utf-8")
    raw = changed(panel, "intervals.L", {"nominal": "0.9 m", "absolute": "10 mm"})
    other = {"file": str(tmp_path / "other.yaml"), "scene": {"side": "1 cm"}}
    raw["cases"] = {"metres": {"intervals": {"k": {"relative": "5 %"}}}, "millimetres": other}
    campaigns = check_config(raw).case_campaigns
    lengths = [case.experiment.intervals["L"] for case in campaigns.values()]
    assert [(i.lower, i.nominal, i.upper) for i in lengths] == [(0.89, 0.9, 0.91), (890, 900, 910)]
    assert campaigns["millimetres"].experiment.scene.parameters == {"side": 10.0}
    raw["cases"]["millimetres"]["scene"]["side"] = "1 s"
    with pytest.raises(ConfigError, match=r"cases.millimetres.scene.side: '1 s' is not .*\(mm\)"):
        check_config(raw)


def test_units_on_slides_are_lengths_and_forces(monkeypatch):
    monkeypatch.chdir(ROOT / "config" / "structures")
    raw = yaml.safe_load(PANEL) | {"scene": {"file": "telescope.yaml"}, "quantities": {}}
    hinges = load_config([ROOT / "config/telescope.yaml"]).experiment.nominal_scene.hinges
    slide = next(hinge.name for hinge in hinges if hinge.slides)
    margin = {"along": slide, "to": "1 m", "standard": "nasa-std-5017b", "output_torque": "2 N m"}
    units = StatedUnits({**raw, "margins": {"m": margin}})
    assert "(N), with or without" in units.misfits["margins.m.output_torque"]
    units = StatedUnits({**raw, "margins": {"m": {**margin, "output_torque": "2 kN"}},
                         "responses": {"x": {"opening": slide}},
                         "quantities": {"t": {"crossing": "x", "level": "3 mm"}},
                         "requirements": {"far": {"m_least": {"at_least": "10 %"}}}})  # fmt: skip
    assert not units.misfits and not units.unknowns
    assert units.raw["margins"]["m"]["output_torque"] == 2000
    assert units.raw["quantities"]["t"]["level"] == 0.003
    assert units.raw["requirements"]["far"]["m_least"]["at_least"] == 0.1


@settings(max_examples=100, deadline=None)
@given(st.decimals("-1e9", "1e9", allow_nan=False, places=7), st.sampled_from(["ms", "us", "s"]))
def test_numbers_are_those_of_their_decimals(number, unit):
    digits = {"ms": -3, "us": -6, "s": 0}[unit]
    raw = StatedUnits({"solver": {"duration": f"{number:f} {unit}"}}).raw
    assert raw["solver"]["duration"] == float(number.scaleb(digits))
