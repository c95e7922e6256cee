"""Margins of a campaign, with bounds over the opening, and the sheet that a review asks for."""

from __future__ import annotations

import csv
import io
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

from deployable import campaign
from deployable.campaign.results.review import (
    CLAUSES,
    COLUMNS,
    NOT_ANALYSED,
    as_csv,
    head_of,
    rows_of,
)

ECSS = "ecss-e-st-33-01c"


def quantity(name, lower, upper, units="1"):
    return {"name": name, "long_name": f"the {name}", "units": units, "lower": lower,
            "upper": upper, "error": 0.01, "surrogate_lower": lower, "surrogate_upper": upper,
            "influence": {"k": {"share": 0.7, "halved": 0.07}, "f": {"share": 0.3, "halved": 0.09}},
            "runs_with": 9, "runs_without": 0}  # fmt: skip


def limited(name, met, quantity, kind="at_least", level=0.0, share=1.0):
    limit = {"quantity": quantity, "units": "1", "kind": kind, "level": level, "simulated": 0.25,
             "at": {"k": 0.1, "f": None}}  # fmt: skip
    return {"name": name, "met": met, "share": share, "open": 0.0, "runs": 9, "limits": [limit]}


def number(name, kind="", about=(), event=""):
    response = SimpleNamespace(kind=kind, about=about, along=None) if kind else None
    return SimpleNamespace(name=name, response=response, event=event)


def sheet(quantities=(), requirements=(), numbers=()):
    parameters = [{"name": "k", "units": "N m rad-1"}, {"name": "f", "units": "N m"}]
    facts = {"quantities": list(quantities), "requirements": list(requirements),
             "parameters": parameters, "runs": {"all": 9}}  # fmt: skip
    solver = SimpleNamespace(energy_tolerance=0.005)
    return rows_of(facts, SimpleNamespace(numbers=numbers, solver=solver), ECSS)


def of(rows, clause, word=""):
    return [row for row in rows if row["clause"] == clause and word in row["asks"]]


def test_a_clause_that_nothing_was_stated_for_is_not_analysed():
    rows = sheet()
    assert len(rows) == len(CLAUSES[ECSS])
    analysed = [row for row in rows if row["verdict"] != NOT_ANALYSED]
    assert [row["asks"] for row in analysed] == [of(rows, "4.8.2.6", "integrity")[0]["asks"]]
    assert "0.5 %" in analysed[0]["value"]


@pytest.mark.parametrize(
    ("met", "share", "verdict"),
    [
        ("all", 1.0, "met in all of the box, by analysis"),
        ("none", 0.0, "not met anywhere in the box"),
        ("some", 0.6, "not met: only in 60 % of the box"),
        ("open", 1.0, "no failure found in 9 runs, which proves nothing of the rest"),
    ],
)
def test_a_margin_has_its_verdict_and_the_run_nearest_to_failing(met, share, verdict):
    numbers = [number("m_least", "margin", ("h", ECSS, "theory"))]
    requirements = [limited("m", met, "m_least", share=share)]
    rows = sheet([quantity("m_least", 0.2, 1.2)], requirements, numbers)
    (row,) = of(rows, "4.7.5.3", "every position")
    assert row["verdict"] == verdict
    assert row["nearest"] == "k = 0.1 N m/rad: 0.25, simulated"
    assert of(rows, "4.7.5.3", "redundant")[0]["verdict"] == NOT_ANALYSED


def test_a_broken_spring_is_a_failure_case_and_no_margin():
    numbers = [number("out", "margin", ("h", ECSS, "theory", "torsion spring h"))]
    rows = sheet([quantity("out", -0.2, 0.2)], [limited("m", "none", "out")], numbers)
    assert of(rows, "4.7.5.3", "every position")[0]["verdict"] == NOT_ANALYSED
    for row in (*of(rows, "4.7.5.3", "redundant"), *of(rows, "4.8.2.6", "failure")):
        assert row["verdict"] == "not met anywhere in the box"


def test_margins_by_other_standards_and_own_requirements_stand_below():
    numbers = [
        number("n", "margin", ("h", "nasa-std-5017b", "analysis")),
        number("t", event="latches"),
        number("late", "velocity"),
        number("gap", "clearance"),
    ]
    quantities = [quantity(one.name, 0.1, 0.2) for one in numbers]
    limits = [limited("n", "all", "n"), limited("soft", "all", "late", "at_most", 1.0)]
    rows = sheet(quantities, [*limits, limited("shuts", "all", "t", "happens", True)], numbers)
    assert of(rows, "NASA-STD-5017B")[0]["verdict"].startswith("met in all")
    assert of(rows, "own", "soft")[0]["analysed"] == "late: the late; at most 1"
    assert of(rows, "4.7.5.4.3", "catch over")[0]["analysed"].endswith("; happens")
    assert of(rows, "4.7.5.4.8")[0]["verdict"] == "told; no limit was stated"


def test_what_happens_in_no_run_is_said():
    nothing = quantity("t", None, None) | {"influence": {"k": {"share": 0.0}, "f": {"share": 0.0}}}
    rows = sheet([nothing], [], [number("t", event="latches")])
    assert of(rows, "4.7.5.4.3", "catch over")[0]["value"] == "happens in no run"


def test_the_budget_tells_the_tolerance_that_counts():
    rows = sheet([quantity("late", 0.2, 0.3, "m s-1")], [], [number("late", "velocity")])
    assert of(rows, "4.8.2.5")[0]["value"] == "late: 0.1 m/s, 0.07 m/s with half the tolerance of k"


def test_how_it_ends_and_over_which_box_stands_first():
    numbers = [number("m_least", "margin", ("h", ECSS, "theory"))]
    requirements = [limited("m", "some", "m_least"), limited("t", "open", "m_least")]
    facts = {"requirements": requirements, "parameters": [
        {"name": "k", "description": "stiffness", "lower": 0.36, "upper": 0.44, "units": "N m"},
    ]}  # fmt: skip
    rows = sheet([quantity("m_least", -0.2, 1.2)], requirements, numbers)
    ends, box, how = head_of(facts, rows)
    assert ends.startswith("Not met: m; no failure found, which proves nothing of the rest of the")
    assert "box: t; not analysed, in whole or in part: 4.7.5.2, 4.7.5.3, 4.7.5.4.3" in ends
    assert "met in all" not in ends and "4.7.5.4.8" in ends
    assert "stiffness (k) from 0.36 to 0.44 N m" in box and "probability" in how


def test_the_factors_of_a_failure_case_are_told_apart():
    nasa = "nasa-std-5017b"
    numbers = [number("n", "margin", ("h", nasa, "analysis")),
               number("out", "margin", ("h", nasa, "spring out", "torsion spring h"))]  # fmt: skip
    limits = [limited("n", "some", "n"), limited("o", "some", "out")]
    rows = sheet([quantity("n", -0.2, 0.2), quantity("out", 0.2, 0.4)], limits, numbers)
    assert "not to be compared" in of(rows, "4.8.2.6", "failure")[0]["analysed"]
    assert "not to be compared" not in of(rows, "NASA-STD-5017B")[0]["analysed"]


def test_the_sheet_as_csv():
    found = list(csv.reader(io.StringIO(as_csv(sheet()))))
    assert {len(row) for row in found} == {len(COLUMNS)}
    assert found[0][0] == "clause" and len(found) == 1 + len(CLAUSES[ECSS])


PANEL = """
name: led
parameters:
  k: {value: 0.1, unit: N m/rad}
  rest: {value: 180, unit: deg}
  dry: {value: 0.01, unit: N m}
  harness: {value: 0.005, unit: N m/rad}
  heavy: {value: 0.02, unit: N}
points: {a: [0, 0, 0], b: [1, 0, 0]}
bodies:
  sheet: {mass: 1 kg, centre: b, box: [1, 1, 0.01], points: [a, b]}
joints:
  h: {type: revolute, parts: [ground, sheet], at: a, axis: z}
loads:
  pull: {part: sheet, at: b, force: [0, -heavy, 0]}
actions:
  spring: {type: torsion spring, joint: h, stiffness: k, rest: rest}
  friction: {type: friction, joint: h, moment: dry}
  wires: {type: tape spring, joint: h, angles: [0 rad, 3 rad], moments: [0 N m, -3 rad*harness]}
record:
  b: {part: sheet, at: b}
"""

AROUND = {"k": 0.1, "rest": 0.05, "dry": 0.3, "harness": 0.3, "heavy": 0.5}


@pytest.mark.slow
def test_bounds_of_a_margin_over_five_parameters(tmp_path):
    """Against ten thousand places of the box by the closed form."""
    (tmp_path / "led.yaml").write_text(PANEL)
    config = {
        "campaign": "led",
        "scene": {"file": str(tmp_path / "led.yaml")},
        "solver": {"duration": 0.1, "instants": 201},
        "intervals": {name: {"relative": width} for name, width in AROUND.items()},
        "design": {"method": "smolyak", "order": 2},
        "responses": {"open": {"opening": "h"}},
        "margins": {"m": {"along": "h", "to": "90 deg", "standard": ECSS,
                          "classes": {"spring h": "HA"}}},
        "review": ECSS,
    }  # fmt: skip
    campaign.run(config, tmp_path, tell=lambda text: None)
    folder = tmp_path / "led"
    nominal = np.array([0.1, np.pi, 0.01, 0.005, 0.02])
    draw = np.random.default_rng(1).uniform(-1, 1, (10_000, 5))
    corners = np.array(np.meshgrid(*[[-1, 1]] * 5)).reshape(5, -1).T
    k, rest, dry, harness, heavy = (
        nominal * (1 + np.array(list(AROUND.values())) * np.vstack([draw, corners]))
    ).T[:, :, None]
    angle = np.linspace(0, np.pi / 2, 201)
    spring = k * (rest - angle)
    resists = 6 * (dry + harness * angle) + heavy * np.cos(angle)
    margin = 0.8 * spring / resists - 1
    with xarray.open_dataset(folder / "bounds.nc") as bounds:
        i = bounds["response"].values.tolist().index("m")
        lower, upper, error = (bounds[name].values[i] for name in ("lower", "upper", "error"))
        assert '"first": 0.0' in str(bounds["response_along"].values[i])
        assert str(bounds["response_along"].values[1 - i]) == "null"
    assert np.all(lower <= margin.min(axis=0) + error)
    assert np.all(np.abs(lower - margin.min(axis=0)) <= error + 1e-3)
    assert np.all(np.abs(upper - margin.max(axis=0)) <= error + 1e-2 * margin.max())
    with xarray.open_dataset(folder / "quantities.nc") as found:
        least = margin.min(axis=1)
        off = float(found["error"][0]) + 1e-3
        assert float(found["lower"][0]) == pytest.approx(least.min(), abs=off)
    sheet = (folder / "review.md").read_text()
    met = "met in all of the box" if least.min() > 0 else "not met"
    assert f"| {met}" in sheet and "not analysed" in sheet
    text = (folder / "summary.md").read_text()
    assert "What was shown of ECSS-E-ST-33-01C" in text and " rad |" in text
    page = (folder / "report.html").read_text()
    assert "What was shown of ECSS-E-ST-33-01C" in page
    assert (folder / "review.csv").read_text().count("\n") >= len(CLAUSES[ECSS])
