"""Margins of a campaign, with bounds over the opening, and the sheet that a review asks for."""

from __future__ import annotations

import re

import numpy as np
import pytest
import sheets
import xarray
from sheets import ECSS, NASA, find, limit, margin, number, of_margin, quantity, required, sheet

from deployable import campaign
from deployable.campaign.results.review import (
    CLAUSES,
    MET,
    NOT_ANALYSED,
    PARTIAL,
    STATES,
    budgets_of,
)

LATCH, OTHER = ("latch a",), ("latch a", "latch b")
STRESS = {"of": "stress", "subjects": ("bar",)}
MOMENT = {"of": "joint_moment", "subjects": ("h", "stop"), "signed": True}
LATCHED = {"of": "joint_moment", "subjects": ("h", "latch"), "signed": True}
IMPULSE = {"of": "latch_impulse", "subjects": ("a",), "signed": True}
GAP = {"kind": "smallest", "of": "clearance"}
TIME = {"kind": "event", "event": "latches", "places": LATCH}


def least(lower=0.2, upper=0.4, limits=(), error=0.01, **of_it):
    """A margin `m_least` with limits of one requirement each."""
    rows = [required(f"r{i}", x) for i, x in enumerate(limits)]
    return ([quantity("m_least", lower, upper, error=error)], rows, [of_margin("m_least")],
            {"m_least": margin(**of_it)})  # fmt: skip


def one(lower, upper, stated=(), units="1", doubt="", **of_it):
    """A quantity `q`, and optionally a limit: its kind, level, and how it is met."""
    rows = [required("r", limit("q", *stated))] if stated else []
    more = {"doubt": doubt} if doubt else {}
    return [quantity("q", lower, upper, units, **more)], rows, [number("q", **of_it)], {}


MISS = TIME | {"event": "misses"}
ZERO, WEAK = limit("m_least"), limit("m_least", level=-0.9)
STRICT = limit("m_least", level=0.5, met="none")
EVERY, FAILURE, REDUNDANT = "full range", "failure cases", "redundant"
CLEAR, CATCH, BEAR, LOADS = "4.7.5.4.8", "catch over", "stops bear", "shock loads"

ROWS = {
    # a margin: the standard's own limit, by the interval or the requirement of it
    "kept": (
        least(limits=[ZERO]), "4.7.5.3", EVERY, "met in all of the box, by analysis of 9 runs"),
    "required, within its error": (least(0.005, limits=[ZERO]), "4.7.5.3", EVERY, "undecided"),
    "error unknown": (least(error=None), "4.7.5.3", EVERY, "undecided"),
    "somewhere": (least(-0.1, 0.3), "4.7.5.3", EVERY, "not met in at least"),
    "a weaker limit": (least(-0.65, -0.63, [WEAK]), "4.7.5.3", EVERY, "not met anywhere"),
    "what a weaker limit shows": (least(-0.65, -0.63, [WEAK]), "own", "r0", "reported: kept"),
    "two, the second fails": (
        least(-0.65, -0.63, [WEAK, limit("m_least", met="none")]), "4.7.5.3", EVERY,
        "not met anywhere"),
    "a stricter limit fails": (
        least(limits=[ZERO, STRICT]), "4.7.5.3", EVERY, "not met: own requirement r1, at"),
    "a limit from above": (
        least(-0.3, -0.2, [limit("m_least", "at_most", 1.0)]), "own", "r0", "reported: kept"),
    "a broken limit from above": (
        least(limits=[limit("m_least", "at_most", 0.2, met="none")]), "own", "r0",
        "not met anywhere"),
    # where it is by factors, classes or a part of the travel of its own
    "own factors": (
        least(own=["FR 0.1 for 6"]), "own", "factors", "by own factors (FR 0.1 for 6): met in all "
        "of the box, by analysis of 9 runs; by those of the standard: not analysed"),
    "classes of the file": (
        least(weaker=["friction h as TL for FR"]), "4.7.5.3", EVERY, "partly analysed: met from 0 "
        "to 1.5 rad; the structure's file counts friction h as TL for FR"),
    "part of the travel": (
        least(last=0.1), "4.7.5.3", EVERY, "partly analysed: met from 0 to 0.1 rad; the travel is "
        "0 to 1.5 rad"),
    "the other way": (least(first=1.5, last=0.0, travel=[1.5, 0.0]), "4.7.5.3", EVERY, "met in"),
    "no end stated": (
        least(travel=None), "4.7.5.3", EVERY, "partly analysed: met from 0 to 1.5 rad; no latch"),
    "part of it fails": (least(-0.1, 0.2, last=0.1), "4.7.5.3", EVERY, "not met in at least"),
    "just by its error": (least(0.25, 0.5, error=0.25), "4.7.5.3", EVERY, "met in all"),
    "just from the start": (
        least(first=1.5e-6, last=1.5, travel=[0.0, 1.5]), "4.7.5.3", EVERY, "met in all"),
    "another stands": (
        least(locked=["g"]), "4.7.5.3", EVERY,
        "partly analysed: met from 0 to 1.5 rad; g is held and not moved"),
    "two others stand": (
        least(locked=["f", "g"]), "4.7.5.3", EVERY,
        "partly analysed: met from 0 to 1.5 rad; f, g are held and not moved"),
    "another moved that nothing couples": (
        least(openings=["h", "g"], apart=["g"]), "4.7.5.3", EVERY, "partly analysed: met from 0 to "
        "1.5 rad; nothing couples h and g, so that each needs a margin of its own"),
    "all of it but for a rounding": (
        least(first=-1.0 - 1e-7, last=-2.5 + 1e-7, travel=[-1.0, -2.5]), "4.7.5.3", EVERY,
        "met in all of the box, by analysis of 9 runs"),
    "all but a thousandth": (
        least(first=-1.0, last=-2.4985, travel=[-1.0, -2.5]), "4.7.5.3", EVERY,
        "partly analysed"),
    "factors of tests": (
        least(evidence="measurement"), "4.7.5.3", EVERY, "met in all of the box, by analysis "
        "of 9 runs, if tests have confirmed"),
    "the largest margin": (
        ([quantity("q", 0.2, 0.4)], [], [number("q", "largest", "margin", signed=True)], {}),
        "4.7.5.3", EVERY, "not analysed"),
    # parts that are out
    "friction out": (least(without=["friction h"]), "4.8.2.6", FAILURE, "not analysed: friction h"),
    "friction out, redundant": (
        least(without=["friction h"], springs=["s1", "s2"]), "4.7.5.3", REDUNDANT,
        "not analysed: s1, s2"),
    "a single spring": (least(), "4.7.5.3", REDUNDANT, "not analysed: torsion spring h is the"),
    "a spring out": (
        least(without=["torsion spring h"]), "4.8.2.6", FAILURE, "met in all of the box"),
    "a spring out is no margin": (
        least(without=["torsion spring h"]), "4.7.5.3", EVERY, "not analysed"),
    "one of two out": (
        least(without=["s1"], springs=["s1", "s2"], drives=["s1", "s2"]), "4.7.5.3", REDUNDANT,
        "partly analysed: without s1: met in all of the box, by analysis of 9 runs; not analysed: "
        "s2"),
    "both at once out": (
        least(without=["s1", "s2"], springs=["s1", "s2"]), "4.7.5.3", REDUNDANT, "not analysed"),
    # allowables
    "no allowable": (one(1, 2, **STRESS), "4.7.5.2", "", "not analysed: no allowable"),
    "an allowable": (one(1, 2, ("at_most", 3.0), **STRESS), "4.7.5.2", "", "met in all of the box"),
    "beyond it": (one(1, 4, ("at_most", 3.0, "some"), **STRESS), "4.7.5.2", "", "not met"),
    "of the last instant": (
        one(1, 2, ("at_most", 3.0), kind="final", **STRESS), "4.7.5.2", "",
        "not analysed: at most 3 does not bound the largest load here"),
    "a limit from below": (one(1, 2, ("at_least", 0.5), **STRESS), "4.7.5.2", "", "not analysed"),
    "a shock decides": (
        one(1, 2, ("at_most", 3.0), doubt="the step decides", **STRESS), "4.7.5.2", "",
        "undecided: the step decides"),
    "one sign": (one(-5, 2, ("at_most", 3.0), **MOMENT), "4.7.5.4.4", BEAR, "partly analysed: met"),
    "a latch's moment": (one(-5, 2, **LATCHED), "4.7.5.4.3", LOADS, "not analysed: no allowable"),
    "its shock": (one(-5, 2, **LATCHED), "4.8.2.11", "", "reported"),
    # clearance
    "hardly three times": (
        one(3.08, 4.08, units="m", **GAP), CLEAR, "",
        "met in all of the box, by analysis of 9 runs: three times its tolerance is 3.06 m"),
    "within its error of three times": (
        one(3.065, 4.065, units="m", **GAP), CLEAR, "", "not met in at least a part of the box"),
    "a single number": (one(2, 2, ("at_least", 1.0), **GAP), CLEAR, "", "not analysed: it does"),
    "at the end only": (
        one(10, 11, **GAP | {"kind": "final"}), CLEAR, "", "not analysed: the clearance needs"),
    # latches
    "catches": (one(1, 2, ("happens", True), **TIME), "4.7.5.4.3", CATCH, "met in all of the box"),
    "shall not catch": (
        one(None, None, ("happens", False), **TIME), "4.7.5.4.3", CATCH, "not analysed: the "
        "campaign requires that it does not happen"),
    "shall not, it says": (
        one(None, None, ("happens", False), **TIME), "own", "r", "met in all of the box"),
    "nothing required": (one(1, 2, **TIME), "4.7.5.4.3", CATCH, "not analysed"),
    "first of two": (
        one(1, 2, ("happens", True), **TIME | {"places": OTHER}), "4.7.5.4.3", CATCH,
        "partly analysed: met for the first of latch a, latch b that latches"),
    "no run misses": (
        one(None, None, **MISS), "4.7.5.4.3", "first miss", "not analysed: no run misses"),
    "misses": (one(1, 2, **MISS), "4.7.5.4.3", "first miss", "not analysed: no quantity says"),
    # the rest
    "a shock": (one(1, 2, of="acceleration"), "4.8.2.11", "", "reported; no limit"),
    "parameters": (least(), "4.8.2.6", "parametric", "reported"),
    "worst places": (least(limits=[ZERO]), "4.8.2.6", "worst combinations", "met in all"),
    "worst of a part": (
        least(limits=[ZERO], last=0.1), "4.8.2.6", "worst combinations", "partly analysed"),
    "worst, weak limit": (
        least(-0.6, -0.5, [WEAK]), "4.8.2.6", "worst combinations", "not met in at least"),
    "worst without friction": (
        least(limits=[ZERO], without=["friction h"]), "4.8.2.6", "worst combinations", "partly"),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_a_row_says_what_was_shown(name):
    stated, clause, word, verdict = ROWS[name]
    rows = find(sheet(*stated), clause, word)
    assert len(rows) == 1 and rows[0]["verdict"].startswith(verdict), rows
    assert rows[0]["state"] in STATES
    begins = rows[0]["verdict"].startswith(rows[0]["state"])
    assert begins or rows[0]["verdict"].startswith("by own factors")


def test_a_clause_that_nothing_was_stated_for_is_not_analysed():
    rows = sheet(motion=None)
    (balance,) = find(rows, "4.8.2.6", "integrity")
    assert balance["verdict"].startswith("partly analysed") and balance["state"] == PARTIAL
    assert len(rows) == len(CLAUSES[ECSS])
    analysed = {row["asks"]: row["verdict"] for row in rows if row["state"] != NOT_ANALYSED}
    assert list(analysed) == [
        "a parametric study of all mechanical variables",
        "integrity of the model, by a balance of energy or momentum",
    ]


@pytest.mark.parametrize(
    ("exchanged", "off", "verdict"),
    [(1.0, 1e-4, MET), (0.11, 1e-4, "not analysed"), (0.0, 0.0, "not analysed"),
     (4e-8, 1e-16, "not analysed")],
)  # fmt: skip
def test_a_balance_of_energy_takes_a_run_that_moves(exchanged, off, verdict):
    motion = {"exchanged": exchanged, "largest": 2.0, "imbalance": off}
    (row,) = find(sheet(motion=motion), "4.8.2.6", "integrity")
    assert row["verdict"].startswith(verdict) and "9 runs, each of 2 s" in row["analysed"]


@pytest.mark.parametrize(
    ("met", "share", "verdict"),
    [
        ("all", 1.0, "met in all of the box, by analysis of 9 runs"),
        ("none", 0.0, "not met anywhere in the box"),
        ("some", 0.6, "not met in a part of the box; 60 % of the box meets it"),
        (
            "undecided",
            1.0,
            "undecided: no failure found in 9 runs, which does not prove the rest of the box",
        ),
    ],
)
def test_a_requirement_of_two_quantities_gives_each_its_own_verdict(met, share, verdict):
    stated, _, numbers, margins = least()
    both = required("both", limit("m_least", met=met, share=share),
                    limit("q", level=1.0, met="none", share=0.0))  # fmt: skip
    rows = sheet([*stated, quantity("q", 0.0, 0.1)], [both],
                 [*numbers, number("q", of="velocity")], margins)  # fmt: skip
    assert find(rows, "4.7.5.3", EVERY)[0]["verdict"] == verdict
    assert find(rows, "own", "both")[0]["verdict"] == "not met anywhere in the box"
    nearest = "k = 0.1 N m/rad: 0.25, computed there, at an opening of 1.5 rad"
    assert find(rows, "4.7.5.3", EVERY)[0]["nearest"] == nearest


def test_springs_are_redundant_where_the_margin_holds_without_each_single_one():
    springs = {"springs": ["s1", "s2"], "drives": ["s1", "s2"]}
    margins = {name: margin(name, without=out, **springs)
               for name, out in (("m", []), ("a", ["s1"]), ("b", ["s2"]))}  # fmt: skip
    for lower, verdict in ((0.1, "met in all of the box without any one of s1, s2"),
                           (-0.1, "not met: without s1: met"),
                           (0.0, "undecided: without s1: met")):  # fmt: skip
        quantities = [quantity("m", 0.5, 1), quantity("a", 0.2, 1), quantity("b", lower, 1)]
        rows = sheet(quantities, [], [of_margin(name) for name in margins], margins)
        (row,) = find(rows, "4.7.5.3", REDUNDANT)
        assert row["verdict"].startswith(verdict)


def test_a_margin_by_own_factors_stands_beside_that_of_the_standard():
    margins = {"m_least": margin("m", own=["FR 0.1 for 6"]),
               "m_by_standard_least": margin("m_by_standard")}  # fmt: skip
    quantities = [quantity("m_least", 20, 21), quantity("m_by_standard_least", -0.7, -0.6)]
    rows = sheet(quantities, [], [of_margin(name) for name in margins], margins)
    own, by = find(rows, "own")[0], find(rows, "4.7.5.3", EVERY)[0]
    assert own["verdict"].endswith("by those of the standard: not met anywhere in the box")
    assert "own factors: FR 0.1 for 6" in own["analysed"] and own["state"] == "reported"
    assert by["verdict"] == "not met anywhere in the box" and by["of"] == "m_by_standard_least"


def test_latches_and_motors_that_have_no_part_are_said():
    stated = least(latches=["lock"], motors=["g"], added=["output_torque 0.1"], locked=["f"])
    (row,) = find(sheet(*stated), "4.7.5.3", EVERY)
    for words in (
        "without the latch lock, which catches on the way", "without the elastic motor of g",
        "with output_torque 0.1", "f held", "analysed from 0 to 1.5 rad of a travel from 0 to 1.5",
    ):  # fmt: skip
        assert words in row["analysed"]


def test_latches_that_nothing_is_asked_of_are_named():
    stated = one(1, 2, ("happens", True), **TIME)
    rows = find(sheet(*stated, latches=["latch a", "latch b"]), "4.7.5.4.3", CATCH)
    assert [(row["analysed"], row["verdict"]) for row in rows[1:]] == [("latch b", NOT_ANALYSED)]


def test_a_latch_that_misses_and_catches_later():
    numbers = [number("t", **TIME), number("late", **TIME | {"event": "misses"})]
    rows = sheet([quantity("t", 1, 2), quantity("late", 1, 2)],
                 [required("r", limit("t", "happens", True))], numbers)  # fmt: skip
    assert find(rows, "4.7.5.4.3", "first miss")[0]["verdict"].startswith("met in all of the box")


@pytest.mark.parametrize(
    ("kind", "states"),
    [("final", [MET, MET]), ("smallest", [NOT_ANALYSED, PARTIAL]), ("mean", [NOT_ANALYSED] * 2)],
)
def test_the_impulse_of_a_latch_is_bounded_by_its_last_value(kind, states):
    limits = [required("a", limit("q", "at_most", 3.0)), required("b", limit("q", level=-6.0))]
    rows = sheet([quantity("q", -5, 2)], limits, [number("q", kind=kind, **IMPULSE)])
    assert [row["state"] for row in find(rows, "4.7.5.4.3", LOADS)] == states


@pytest.mark.parametrize(
    ("other", "state"),
    [
        ({"openings": ["g"]}, MET),
        ({"openings": ["g"], "standard": NASA, "evidence": "analysis"}, PARTIAL),
        ({"openings": ["f"]}, PARTIAL),
    ],
)
def test_an_opening_that_stands_is_led_by_another_margin_of_the_standard(other, state):
    stated, limits, numbers, margins = least(limits=[ZERO], locked=["g"])
    stated, numbers = [*stated, quantity("n_least", 0.2, 0.4)], [*numbers, of_margin("n_least")]
    rows = sheet(stated, limits, numbers, margins | {"n_least": margin("n", **other)})
    row = next(row for row in find(rows, "4.7.5.3", EVERY) if "m_least" in row["analysed"])
    assert row["state"] == state, row


@pytest.mark.parametrize(
    ("others", "state"),
    [(["h", "g"], MET), (["g"], PARTIAL), ([], PARTIAL)],
)
def test_openings_that_nothing_couples_have_margins_of_their_own(others, state):
    stated, limits, numbers, margins = least(openings=["h", "g"], apart=["g"])
    for name in others:
        stated, numbers = [*stated, quantity(name, 0.2, 0.4)], [*numbers, of_margin(name)]
        margins[name] = margin(name, openings=[name])
    row = find(sheet(stated, limits, numbers, margins), "4.7.5.3", EVERY)[0]
    assert row["state"] == state, row


def test_margins_by_other_standards_stand_below():
    stated, limits, numbers, _ = least(limits=[ZERO])
    margins = {"m_least": margin(standard=NASA, evidence="analysis")}
    rows = sheet(stated, limits, numbers, margins)
    (row,) = find(rows, "NASA-STD-5017B")
    assert row["state"] == MET and find(rows, "4.7.5.3", EVERY)[0]["state"] == NOT_ANALYSED
    out = {"m_least": margin(standard=NASA, evidence="spring out", without=["torsion spring h"])}
    rows = sheet(stated, limits, numbers, out)
    assert "not comparable with" in find(rows, "4.8.2.6", FAILURE)[0]["analysed"]


def test_the_budget_tells_the_tolerance_that_counts():
    rows = sheet([quantity("v", 0.2, 0.3, "m s-1")], [], [number("v", of="velocity")])
    assert find(rows, "4.8.2.5")[0]["value"] == "v: 0.1 m/s, 0.07 m/s with half the tolerance of k"


def test_how_it_ends_and_over_which_box_stands_first():
    stated, limits, numbers, margins = least(-0.2, 0.3, [limit("m_least", met="some", share=0.6)])
    ends, box, how = sheets.head(sheets.facts_of(stated, limits, margins), numbers)
    outcome = "with 12 of 18 clauses not analysed."
    begin = "Of 18 rows: 2 not met (4.7.5.3 m_least, 4.8.2.6); 0 undecided; "
    assert ends.startswith(f"The sheet says “not met”, {outcome} {begin}")
    met, *_ = sheets.head(sheets.facts_of(margins={}))
    assert met.startswith("The sheet says “met”, with 16 of 18 clauses not analysed. Of")
    assert "1 met (4.8.2.6)" in ends and "12 not analysed (4.7.5.2, 4.7.5.3" in ends
    assert sum(map(int, re.findall(r"[:;] (\d+)", ends[ends.index("Of") :]))) == 18
    assert "stiffness (k) from 0.36 to 0.44 N m/rad" in box and "probability" in how
    assert "ECSS-E-ST-33-01C (6 March 2009" in how


def test_parts_at_the_worst_place_add_up_to_the_margin():
    (budget,) = budgets_of(sheets.facts_of(margins={"m_least": margin()}))
    weighted = [float(row[-1].replace("−", "-")) for row in budget["rows"]]
    drives, required_ = (abs(sum(w for w in weighted if w * sign > 0)) for sign in (1, -1))
    assert f"T = {drives:g} N m" in budget["sum"] and f"Tmin = {required_:g} N m" in budget["sum"]
    assert budget["sum"].endswith(f"= {drives / required_ - 1:g}.")
    assert "k = 0.09 N m/rad" in budget["title"] and "6 March 2009" in budget["title"]


def test_of_runs_that_start_apart_the_positions_are_told_to_be_the_nominal_ones():
    for vary in (False, True):
        text = str(sheet(*least(starts_vary=vary)))
        assert ("every other run begins at its own start" in text) == vary


def test_a_margin_at_its_cap_is_no_quotient():
    (budget,) = budgets_of(sheets.facts_of(margins={"m_least": margin(
        budget={"opening": 0.0, "margin": 99.0, "drives": 0.5, "requirement": 0.001, "rows": []}
    )}))  # fmt: skip
    assert budget["sum"].endswith("T/Tmin − 1 is 99 or more and counts as 99.")


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
  wires: {type: tabulated spring, joint: h, angles: [0, 3 rad], moments: [0 N m, -3 rad*harness]}
record:
  b: {part: sheet, at: b}
"""

AROUND = {"rest": 0.05, "dry": 0.3, "heavy": 0.5}


@pytest.mark.slow
def test_bounds_of_a_margin_over_three_parameters(tmp_path):
    """Against ten thousand places of the box by the closed form."""
    (tmp_path / "led.yaml").write_text(PANEL)
    config = {
        "campaign": "led",
        "scene": {"file": str(tmp_path / "led.yaml")},
        "solver": {"duration": 0.1, "instants": 201},
        "intervals": {name: {"relative": width} for name, width in AROUND.items()},
        "design": {"method": "smolyak", "order": 2},
        "verify": {"max_iterations": 1},
        "responses": {"open": {"opening": "h"}},
        "margins": {"m": {"along": "h", "to": "90 deg", "standard": ECSS,
                          "classes": {"wires": "HA"}}},
        "review": ECSS,
    }  # fmt: skip
    campaign.run(config, tmp_path, notify=lambda text: None)
    folder = tmp_path / "led"
    k, harness, nominal = 0.1, 0.005, np.array([np.pi, 0.01, 0.02])
    draw = np.random.default_rng(1).uniform(-1, 1, (10_000, 3))
    corners = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    rest, dry, heavy = (
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
    assert re.search(
        r"\*\*.*The review sheet says “.*”, with \d+ of \d+ clauses not analysed\..*\*\*", text
    )
    page = (folder / "report.html").read_text()
    assert "What was shown of ECSS-E-ST-33-01C" in page
    assert (folder / "review.csv").read_text().count("\n") >= len(CLAUSES[ECSS])
