"""Cases of a campaign: each is a campaign of its own, and the worst of them decides."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from opening_panel import exact_time, panel
from scipy.integrate import solve_ivp

from deployable import campaign
from deployable.campaign.cli import main
from deployable.campaign.config.loader import read_file
from deployable.campaign.folder import Folder
from deployable.campaign.report.page import render_cases
from deployable.campaign.results.cases import cases_facts, combine_met
from deployable.campaign.results.templates import summary_text

ROOT = Path(__file__).parents[2]
CASES = {
    "as it is": {},
    "heavy": {"scene": {"mass": 2.0}, "solver": {"duration": 4.0}},
    "soft": {"intervals": {"k": {"nominal": 0.05, "relative": 0.1}}},
}
LATE = {"t_open": {"at_most": 2.4}}


def checked(cases=CASES, **changes):
    return campaign.check_config(panel(cases=cases, **changes))


def test_a_case_is_the_campaign_with_what_differs():
    whole = checked(requirements={"in_time": {**LATE, "cases": ["heavy"]}, "early": LATE})
    own = whole.case_campaigns
    alone = campaign.check_config(panel(campaign="as-it-is", requirements={"early": LATE}))
    assert asdict(own["as it is"]) == asdict(alone)
    assert own["heavy"].experiment.parameters({})["mass"] == 2.0
    assert own["heavy"].experiment.solver.duration == 4.0
    assert own["soft"].experiment.intervals["k"].upper == pytest.approx(0.055)
    assert [{*case.requirements} for case in own.values()] == [
        {"early"},
        {"in_time", "early"},
        {"early"},
    ]
    backwards = checked(dict(reversed(CASES.items())), requirements={"early": LATE})
    assert (
        backwards.case_campaigns["soft"]
        == checked(requirements={"early": LATE}).case_campaigns["soft"]
    )
    assert not checked({}).cases


@pytest.mark.parametrize(
    ("cases", "says"),
    [
        ({"a": {"scene": {"mas": 2}}}, r"cases\.a\.scene\.mas: .* no such .*did you mean mass"),
        ({"a": {"scene": {"mass": -1}}}, r"cases\.a\.scene\.mass: -1 is .*allowed: .*0\.001"),
        ({"a b": {}, "A_b": {"scene": {"mass": 2}}}, r"cases\.a b: .*folder.* of A_b; allowed"),
        ({"a": {"scene": {"k": 0.2}}}, r"cases\.a\.scene\.k: .*interval.*intervals: .k: .nominal"),
        ({"a": {"intervals": {"L": {"lower": 2, "upper": 1}}}}, r"a\.intervals\.L\.lower: 2"),
        ({"a": {"solver": {"step": 1}}}, r"cases\.a\.solver\.step: there is no such key"),
        ({"a": {"file": "no.yaml"}}, r"cases\.a\.file: .*no\.yaml"),
        ({"figures": {}}, r"cases\.figures: not a name.*that of a folder of results"),
        ({"../a": {}}, r"cases\.*.*not a name"),
        ({"verification": {}}, r"cases\.verification: campaign: .*not the name of a study"),
    ],
)
def test_cases_that_cannot_be_run_are_refused_with_what_is_allowed(cases, says):
    with pytest.raises(campaign.ConfigError, match=says):
        checked(cases)


@pytest.mark.parametrize("names", ["heavy", [], ["heave"], ["heavy", 3]])
def test_a_requirement_is_of_cases_that_are_there(names):
    limits = {"in_time": {**LATE, "cases": names}}
    with pytest.raises(
        campaign.ConfigError, match=r"requirements\.in_time\.cases: .*allowed: .*soft"
    ):
        checked(requirements=limits)
    with pytest.raises(
        campaign.ConfigError, match=r"requirements\.in_time\.cases: .*without `cases`"
    ):
        checked({}, requirements=limits)


def limit(met, margin, error=0.01, kept=None):
    return {"quantity": "t", "units": "s", "kind": "at_most", "level": 2.0, "met": met, "at": {},
            "margin": margin, "error": error, "share": 1.0 if met == "all" else 0.5, "runs": 9,
            "share_uncertainty": 0.0, "simulated": None,
            "kept": margin is not None and margin >= 0 if kept is None else kept}  # fmt: skip


def facts_of(folder, monkeypatch, limits):
    """Facts of cases with these limits of one requirement."""
    facts = {"parameters": [], "fixed": [], "quantities": [], "responses": [], "duration": 1.0,
             "scene": "x", "runs": {"all": 9}}  # fmt: skip
    box = {"whole": True, "fails": None, "max_interval_scale": 0.5, "halved": {}}

    def summary(path):
        own = limits[path.parent.name]
        row = {"name": "r", **own, "limits": [own]}
        return {**facts, "together": {**own, **box}, "requirements": [row]}

    monkeypatch.setattr("deployable.campaign.results.cases.read_json", summary)
    (folder / "a").mkdir(exist_ok=True)
    (folder / "a/report.html").touch()
    return cases_facts(Folder(folder), {name: {} for name in limits})


@pytest.mark.parametrize(
    ("limits", "met", "worst", "close", "says"),
    [
        ({"a": limit("all", 0.5), "b": limit("all", 0.2)}, "all", "b", [], "Yes: all req"),
        ({"a": limit("all", 0.1), "b": limit("undecided", 0.3)}, "undecided", "b", [], "Undecided"),
        ({"a": limit("undecided", 0.1), "b": limit("some", -0.3)}, "some", "b", [], "No: "),
        (
            {"a": limit("none", -0.1), "b": limit("none", None)},
            "none",
            "b",
            [],
            "not by the end of the runs",
        ),
        ({"a": limit("all", 0.205), "b": limit("all", 0.2)}, "all", "b", ["a"], "the errors"),
        ({"a": limit("all", 9, None), "b": limit("all", 0.2)}, "all", "b", ["a"], "the errors"),
        ({"a": limit("all", 0.1) | {"level": 3.0}, "b": limit("all", 0.09)}, "all", "b", [], "Yes"),
    ],
)
def test_the_worst_case_decides(tmp_path, monkeypatch, limits, met, worst, close, says):
    for given in (limits, dict(reversed(limits.items()))):
        facts = facts_of(tmp_path, monkeypatch, given)
        (row,) = facts["requirements"]
        assert (row["met"], facts["together"]["met"]) == (met, met)
        assert (row["worst"]["case"], row["worst"]["close"]) == (worst, close)
        json.dumps(facts, allow_nan=False)
    text, page = summary_text(facts, "cases.md.jinja"), render_cases(facts)
    assert says in text
    assert f" | “{worst}”" in text
    assert '<a href="a/report.html">a</a>' in page


def test_over_all_cases_is_met_only_where_each_is():
    assert combine_met(["all", "all"]) == "all"
    assert combine_met(["all", "undecided"]) == "undecided"
    assert combine_met(["none", "all"]) == combine_met(["some", "undecided"]) == "some"
    assert combine_met(["none", "none"]) == "none"


RELEASE = np.deg2rad(89)


def wing_time(k, spring, c, g=0.0, level=RELEASE, timer=1000.0, **_):
    """Time (s) at which two rods of 1 m and 2 kg are open to 3.12 rad, from equations of motion by
    hand: folded until the bolt lets go, then two, then the outer one alone, as the root latches."""
    mass, inertia = 2.0, 2.0 / 3.0

    def forces(q, v):
        phi, rate = q[0] + np.pi - q[1], v[0] - v[1]
        middle = 2 * spring * (1.5 * np.pi - phi) - c * rate
        root = k * (np.pi - q[0]) - c * v[0]
        weight = mass * g * np.array([1.5 * np.cos(q[0]), 0.5 * np.cos(q[1])])
        return np.array([root + middle, -middle]) - weight

    def folded(t, y):
        held = y[0] + np.pi
        both = forces((y[0], held), (y[1], y[1])).sum()
        return [y[1], both / (2 * inertia)]

    def free(t, y):
        q, v = y[:2], y[2:]
        cosine, sine = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
        matrix = [[inertia + mass, mass / 2 * cosine], [mass / 2 * cosine, inertia]]
        turn = mass / 2 * sine * np.array([v[1] ** 2, -(v[0] ** 2)])
        return [*v, *np.linalg.solve(matrix, forces(q, v) - turn)]

    def outer(t, y):
        return [y[1], forces((np.pi / 2, y[0]), (0.0, y[1]))[1] / inertia]

    def until(equations, start, state, event, end=100.0):
        event.terminal = True
        found = solve_ivp(equations, (start, end), state, events=event, rtol=1e-10, atol=1e-12)
        return found.t[-1], found.y[:, -1]

    opens = np.pi / 2
    t, y = until(folded, 0.0, [0.0, 0.0], lambda t, y: y[0] - min(level, opens))
    angle, rate = y[0] + np.pi, 0.0  # a latch stops both that are held
    if level < opens:
        t, y = until(free, t, [y[0], angle, y[1], y[1]], lambda t, y: y[0] - opens)
        angle, rate = y[1], y[3] + mass / 2 * np.cos(y[0] - y[1]) / inertia * y[2]
    t = t if level < opens else max(t, timer)
    return until(outer, t, [angle, rate], lambda t, y: 1.5 * np.pi - y[0] - 3.12)[0]


@pytest.mark.slow
def test_a_wing_in_two_cases_is_that_of_equations_by_hand(tmp_path):
    raw = read_file(ROOT / "config/wing.yaml").data
    raw["cases"] = {name: raw["cases"][name] for name in ("on ground", "late release")}
    raw |= {
        "design": {"method": "smolyak", "order": 1},
        "held_out": 1,
        "verify": {"max_iterations": 1},
        **{key: {name: raw[key][name]} for key, name in
           (("responses", "middle"), ("quantities", "t_open"), ("requirements", "in_time"))},
    }  # fmt: skip
    raw["scene"]["file"] = str(ROOT / "config/structures/wing.yaml")
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    facts = json.loads((tmp_path / "wing/cases.json").read_text())
    times = next(row for row in facts["quantities"] if row["name"] == "t_open")
    for case, changes in raw["cases"].items():
        summary = json.loads(
            (tmp_path / "wing" / case.replace(" ", "-") / "summary.json").read_text()
        )
        row = next(row for row in summary["quantities"] if row["name"] == "t_open")
        own = dict(changes.get("scene", {}))
        own |= {"level": np.deg2rad(own["level"])} if "level" in own else {}
        for end, place in (("simulated_lower", "argmin"), ("simulated_upper", "argmax")):
            assert row[end] == pytest.approx(wing_time(**row[place], **own), abs=2e-3), case
    assert times["upper_cases"] == ["late release"]
    assert facts["worst"]["requirement"] == "in_time"
    assert (facts["worst"]["case"], facts["together"]["failing"]) == (
        "late release",
        ["late release"],
    )


@pytest.mark.slow
def test_a_campaign_with_cases_is_run_checked_and_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    raw = panel(cases=CASES, requirements={"in_time": {**LATE, "cases": ["as it is", "heavy"]}})
    Path("c.yaml").write_text(json.dumps(raw))
    assert main(["check", "c.yaml"]) == 0
    assert "panel, 3 cases, at most 21 runs" in capsys.readouterr().out
    assert main(["run", "c.yaml", "--require", "--no-figures"]) == 3
    facts = json.loads(Path("results/panel/cases.json").read_text())
    heavy = facts["requirements"][0]["worst"]
    assert (heavy["case"], facts["together"]["free"]) == ("heavy", ["soft"])
    assert 2.4 - heavy["margin"] == pytest.approx(exact_time(0.095, mass=2.0), abs=1e-3)
    page = Path("results/panel/report.html").read_text()
    assert "in “heavy” (margin" in page
    assert 'href="heavy' not in page  # which has no page without figures
    assert main(["bounds", "results/panel/soft", "--config", "c.yaml"]) == 0
    assert main(["bounds", "results/panel", "--config", "c.yaml"]) == 1
    assert "is not the folder of a case" in capsys.readouterr().err
