"""Numbers of answers in words and budgets."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from deployable import campaign
from deployable.campaign.answers import quantity_bounds
from deployable.campaign.answers.choice import design_points, find_deciding_parameters
from deployable.campaign.answers.limits import why_idle
from deployable.campaign.answers.quantity_bounds import _bounds
from deployable.campaign.cli import main
from deployable.campaign.config import sections
from deployable.campaign.config.check import load_config
from deployable.campaign.report.page import render
from deployable.campaign.report.read import from_results
from deployable.campaign.results.facts import (
    changes as has_clear_effect,
)
from deployable.campaign.results.facts import (
    decisive,
    happens_only,
    mark_constant,
    roomier,
    worst_case,
)
from deployable.campaign.results.quantity_facts import _late_runs
from deployable.campaign.results.quantity_results import add_total_error
from deployable.campaign.results.templates import sentence
from deployable.campaign.text.numbers import interval, number, quantity, share, with_error
from deployable.intervals import Box
from deployable.intervals.scalars.search import BoundEstimate
from deployable.intervals.scalars.surrogate import Extremes


@pytest.mark.parametrize(
    ("lower", "upper", "told"),
    [
        (0.31, 0.34, "0.3100 to 0.3400 s"),
        (-2.5, 1.25, "−2.50 to 1.25 s"),
        (100.0001, 100.0002, "100.000100 to 100.000200 s"),
        (0.0, 0.0, "0 to 0 s"),
        (None, None, ""),
    ],
)
def test_an_interval_is_told_from_its_lower_to_its_upper_end(lower, upper, told):
    assert interval({"lower": lower, "upper": upper, "units": "s"}) == told


@pytest.mark.parametrize("width", [1e-5, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("middle", [3.0, -700.0, 0.002])
def test_digits_tell_ends_apart(middle, width):
    row = {"lower": middle - width / 2, "upper": middle + width / 2, "units": "1"}
    written = [float(end.replace("−", "-")) for end in interval(row).split(" to ")]
    assert written[1] - written[0] == pytest.approx(width, rel=0.01)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"error": 0.6}, "3.8 to 11.8 s"),
        ({"error": 0.0123}, "3.78 to 11.84 s"),
        ({"error": 30.0}, "3.8 to 11.8 s"),
        ({"error": 0.6, "lower": 0.0}, "0 to 11.8 s"),
        ({"error": 0.6, "censored_at": 12.0}, "3.8 to more than 12 s (the end of the runs)"),
    ],
)
def test_an_interval_has_the_digits_that_its_error_leaves(changes, text):
    assert interval({"lower": 3.7787, "upper": 11.8379, "units": "s", **changes}) == text


@pytest.mark.parametrize(
    ("part", "open_", "text"),
    [
        (0.81234, 0.0001, "81.23 %"),
        (0.81234, 0.0213, "81 ± 3 %"),
        (0.81234, 0.0006, "81.23 ± 0.06 %"),
        (0.5, 0.12, "50 ± 12 %"),
        (0.9999, 0.02, "at least 97 %"),
        (0.955, 0.009, "95.5 ± 0.9 %"),
        (0.01, 0.0213, "at most 4 %"),
        (1e-6, 0.0, "less than 0.01 %"),
        (0.7, 0.8, "an unknown share"),
    ],
)
def test_a_share_has_the_digits_that_what_is_open_leaves(part, open_, text):
    assert share(part, open_) == text


def test_a_halved_tolerance_that_lowers_the_share_has_a_clear_effect():
    assert has_clear_effect({"gain": -0.05, "gain_uncertainty": 0.01})
    assert not has_clear_effect({"gain": -0.005, "gain_uncertainty": 0.01})


def test_what_fails_only_where_it_does_not_happen_is_told_apart():
    """A speed at an event that does not happen everywhere breaks no limit where it does."""
    limit = {"quantity": "v", "kind": "at_most", "level": 2.0}
    row = {"met": "some", "share": 0.955, "share_uncertainty": 0.002, "limits": [limit]}
    v = {"name": "v", "happens": 0.955, "censored_at": None, "lower": 1.0, "upper": 1.5}
    v |= {"error": 0.1, "happens_uncertainty": 0.001}
    assert happens_only(row, [v]) == happens_only(row, [{**v, "happens": 0.957}]) == "v"
    assert happens_only(row, [{**v, "happens": 0.96}]) is None
    other = {**row, "limits": [{**limit, "kind": "happens"}]}
    assert happens_only(other, [v]) is None
    # Not where its bounds come to the limit by their error, or a run breaks it.
    for changes in ({"error": 0.6}, {"upper": 2.1}, {"error": None}, {"censored_at": 3.0}):
        assert happens_only(row, [{**v, **changes}]) is None
    low = {**row, "limits": [{**limit, "kind": "at_least", "level": 0.8}]}
    assert happens_only(low, [v]) == "v"
    assert happens_only(low, [{**v, "lower": 0.85}]) is None
    # Summary and page tell the margin where it happens, and the run there.
    places = {"argmin": {"k": 1.0}, "argmax": {"k": 2.0}}
    places |= {"simulated_lower": 1.0, "simulated_upper": 1.5}
    absent = {**limit, "margin": None, "units": "m s-1", "at": {"k": 0.36}, "simulated": None}
    told = worst_case(absent, row, [v | places])
    assert (told["margin"], told["error"], told["at"], told["simulated"]) == (
        0.5,
        0.1,
        {"k": 2},
        1.5,
    )
    assert sentence("margin", told) == "0.5 ± 0.1 m/s where it happens"
    assert worst_case({**absent, "margin": -0.1}, row, [v | places])["at"] == {"k": 0.36}


def test_the_error_of_a_quantity_is_the_sum_of_its_parts_as_a_share_of_its_width():
    parts = {"surrogate": 0.1, "step": 0.2, "mesh": 0.3}
    found = add_total_error(parts, 2.0)
    assert found["whole"] == pytest.approx(0.6)
    assert found["share"] == pytest.approx(0.3)
    assert add_total_error(parts, None)["share"] is None
    unknown = add_total_error(parts | {"mesh": None}, 2.0)
    assert unknown["whole"] is None is unknown["share"]


def test_choices_have_the_order_that_is_asked_for_them_and_others_their_own():
    box = Box(["a", "b", "c"], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0])
    experiment = SimpleNamespace(design=SimpleNamespace(order=2), box=box)
    for chosen in ("a", "b"):
        points = design_points(experiment, SimpleNamespace(parameters={chosen: (0, 1)}, order=8))
        lines = {}
        for j, name in enumerate(box.names):
            alone = np.delete(points, j, axis=1)
            lines[name] = len(np.unique(np.round(points[~alone.any(axis=1), j], 9)))
        assert lines["c"] == 1
        assert lines[chosen] > 2 * lines["b" if chosen == "a" else "a"] > 2


@pytest.mark.parametrize(
    ("low", "high", "unconverged"),
    [(1.0, 2.0, (False, False)), (0.5, 2.0, (True, False)), (1.0, 2.5, (False, True)),
     (0.5, 2.5, (True, True)), (1.2, 1.8, (False, False))],
)  # fmt: skip
def test_a_bound_is_unconverged_where_the_surrogate_exceeds_all_runs(
    low, high, unconverged, monkeypatch
):
    estimates = SimpleNamespace(value=0.0), SimpleNamespace(value=3.0)
    monkeypatch.setattr(quantity_bounds, "estimate_bounds", lambda *arguments: estimates)
    extremes = Extremes(low, high, np.array([-1.0]), np.array([1.0]))
    surrogate = SimpleNamespace(range=lambda: extremes)
    numbers = np.array([[1.5], [2.0], [np.nan], [1.0]])
    model = SimpleNamespace(numbers=numbers, points=np.array([[0.0], [0.3], [0.5], [-0.4]]))
    climbs = SimpleNamespace(model=model, remainders=lambda q: (0.0, 0.0))
    bounds = _bounds(climbs, 0, surrogate, np.zeros(2), is_searched=False)
    assert bounds.unconverged == unconverged
    assert (bounds.lower, bounds.upper) == (1.0, 2.0)
    assert (bounds.argmin[0], bounds.argmax[0]) == (-0.4, 0.3)
    assert bounds.outer == (0.0, 3.0)


@pytest.mark.parametrize(("latest", "upper", "error"), [(np.inf, 2.0, 1.0), (3.0, 3.0, 0.2)])
def test_after_searches_by_runs_bounds_are_those_of_the_runs(latest, upper, error, monkeypatch):
    """What a surrogate adds is part of the error; but a time may come after the runs have ended."""
    estimates = tuple(BoundEstimate(value, 0.2, np.zeros((0, 1))) for value in (1.0, 3.0))
    monkeypatch.setattr(quantity_bounds, "estimate_bounds", lambda *arguments: estimates)
    extremes = Extremes(1.0, 3.0, np.array([-1.0]), np.array([1.0]))
    surrogate = SimpleNamespace(range=lambda: extremes, latest=latest)
    numbers = np.array([[1.0], [2.0]])
    model = SimpleNamespace(numbers=numbers, points=np.array([[0.0], [0.3]]))
    climbs = SimpleNamespace(model=model, remainders=lambda q: (0.0, 0.0))
    bounds = _bounds(climbs, 0, surrogate, np.zeros(2), is_searched=True)
    assert bounds.outer == (1.0, upper)
    assert bounds.error == error


def test_what_mesh_and_step_decide_is_told_beside_its_numbers(raw, tmp_path, monkeypatch, capsys):
    """By check, summary and page; of the response that is in doubt, and the peak of it alone."""
    why = "nothing softens it: state a `stiffness`"
    monkeypatch.setattr(
        sections, "warn", lambda scene, response: why if response.name == "BD" else ""
    )
    raw["quantities"] = {
        name: {kind: "BD"} for name, kind in (("top", "largest"), ("end", "final"))
    }
    raw["responses"] = {
        "BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"},
    }  # fmt: skip
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(raw), encoding="utf-8")
    assert main(["check", str(path)]) == 0
    text = f"The model does not determine BD and top: {why}"
    assert f"{path}: {text}" in capsys.readouterr().out
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    folder = tmp_path / raw["campaign"]
    summary = json.loads((folder / "summary.json").read_text())
    rows = [*summary["responses"], *summary["quantities"]]
    assert {row["name"]: row.get("doubt") for row in rows} == {
        "BD": why, "vBz": None, "top": why, "end": None,
    }  # fmt: skip
    lines = (folder / "summary.md").read_text().splitlines()
    assert f"{text}." in lines
    marked = [line for line in lines if "; not determined |" in line]
    assert len(marked) == 2 and "(`top`) |" in marked[0] and "(`BD`) |" in marked[1]
    data = from_results(folder)
    page = render(data)
    assert page.count("nothing softens it: state a <code>stiffness</code>") == 1
    assert page.count("; not determined</td>") == 2


def test_forces_that_rigid_joints_share_are_not_determined(tmp_path):
    """In whatever way a quantity is of them; an opening is."""
    config = {
        "campaign": "c",
        "scene": {"file": str(Path(__file__).parents[2] / "config/structures/nfourbar.yaml")},
        "solver": {"duration": 0.1, "instants": 11},
        "intervals": {"mass": {"relative": 0.1}},
        "responses": {
            "force": {"constraint_force": "bay1.pin", "component": "z"},
            "opening": {"opening": "bay1.pin"},
        },
        "quantities": {"last": {"final": "force"}, "most": {"largest": "opening"}},
    }
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    doubts = load_config([tmp_path / "c.yaml"]).experiment.doubts
    assert doubts.keys() == {"force", "last"}
    assert "bay1.pin depend on those of other joints" in doubts["force"]


def facts_of_two(**changed):
    """Facts of one response and one quantity over k1 and k2; k1 alone widens both."""
    wide = {"share": 1.0, "alone": 0.1, "fixed": 0.0, "halved": 0.05, "width_error": 0.0}
    idle = {"share": 0.0, "alone": 0.0, "fixed": 0.1, "halved": 0.1, "width_error": 0.0}
    response = {"name": "a", "long_name": "opening", "units": "rad", "lower": 1.0, "upper": 1.1}
    response |= {"size": 1.2, "largest_difference": 0.1, "error_at_largest_difference": 0.0}
    response |= {"grade": "small", "shares": {"k1": 1.0, "k2": 0.0}}
    quantity = {"name": "q", "long_name": "largest opening", "units": "rad", "error": 0.0}
    quantity |= {"lower": 1.0, "upper": 1.1, "surrogate_lower": 1.0, "surrogate_upper": 1.1}
    quantity |= {
        "censored_at": None,
        "may_be_endless": False,
        "runs_with": 9,
        "runs_without": 0,
        "predicted_ends": [],
    }
    quantity |= {"influence": {"k1": wide, "k2": idle}}
    known = {"description": "", "nominal": 1.0, "lower": 0.9, "upper": 1.1, "units": "1"}
    parameters = [{"name": name, **known} for name in ("k1", "k2")]
    facts = {"duration": 4.0, "parameters": parameters, "fixed": []}
    facts |= {"responses": [response | changed], "quantities": [quantity | changed]}
    mark_constant(facts)
    return facts


@pytest.mark.parametrize("unit", ["rad", "m", "rad s-1", "s", "N"])
@pytest.mark.parametrize("count", [1, 2])
def test_widths_of_rounding_are_no_widths(count, unit):
    ends = {"lower": 5.2e-25, "upper": 5.5e-25, "largest_difference": 3e-26}
    facts = facts_of_two(**ends, units=unit, size=1e3 if unit == "N" else 5.5e-25)
    facts["parameters"] = facts["parameters"][:count]
    (response,), (quantity,) = facts["responses"], facts["quantities"]
    assert "constant" in response and "constant" in quantity and response["grade"] == "none"
    assert decisive(quantity) is None and "shares" not in response
    text = sentence("tolerance", facts)
    assert text.startswith("Tightening has no effect: no response or quantity varies with `k1`")
    assert "does not vary" in sentence("ranges", facts)
    assert sentence("differences", facts) == "The opening (`a`) does not vary."


def test_late_and_stuck_runs_are_counted_by_whether_they_would_arrive():
    """Of runs of constant speed v over 1 s, those with v < 0.5 need more than another second."""
    speeds, time = np.array([0.4, 0.9, 0.6, 0.0, 2.0, 0.51]), np.linspace(0.0, 1.0, 101)
    response = SimpleNamespace(name="x")
    samples = SimpleNamespace(
        experiment=SimpleNamespace(response_list=[response], intervals=["v"]),
        table=SimpleNamespace(numbers=np.where(speeds < 1, np.nan, 0.5)[:, None],
                              values=speeds[:, None]),
        curves=lambda run, responses: speeds[run] * time[None],
    )  # fmt: skip
    quantity = SimpleNamespace(kind="crossing", event="crosses", response=response, level=1.0)
    counts = {"late": 3, "stuck": 2, "at": {"v": 0.4}}
    assert _late_runs(0, quantity, samples, time).items() >= counts.items()


def test_the_best_choice_with_room_is_recommended_where_the_best_is_tight():
    """Margins 2 - v and 4 (v - 1) with errors 0.2 and 0.4 are twice these from 1.2 to 1.6."""
    speeds = np.linspace(1.0, 2.0, 31)
    choice = {
        "parameters": [{"name": "v", "value": 1.05}],
        "goals": [{"fit_error": 0.1, "value": 0.0, "sense": "minimise"}],
        "limits": [{"margin": 0.95, "error": 0.1, "fit_error": 0.2},
                   {"margin": 0.2, "error": 0.2, "fit_error": 0.4}],
        "tried": [{"values": [v], "goals": [v], "margins": [2 - v, 4 * (v - 1)], "kept": True}
                  for v in speeds],
    }  # fmt: skip
    found = roomier(choice)
    assert found["parameters"][0]["value"] == found["goals"][0]["value"]
    assert 1.199 < found["goals"][0]["value"] < 1.234
    assert [limit["error"] for limit in found["limits"]] == [0.2, 0.4]
    wide = [{"margin": 1.0, "error": 0.1, "fit_error": 0.2}]
    assert roomier(choice | {"limits": wide, "tried": []}) is None
    assert roomier(choice | {"tried": []}) is None


def choices(worth, kept, places):
    """Tried choices with their worth: a goal where all requirements are kept, else a slack."""
    return [
        SimpleNamespace(values=np.array(at), is_allowed=kept, goals=[value], margin=value)
        for at, value in zip(places, worth, strict=True)
    ]


GRID = [(1.0, 3.0), (1.0, 4.0), (2.0, 3.0), (2.0, 4.0)]


@pytest.mark.parametrize("kept", [True, False])
@pytest.mark.parametrize(
    ("worth", "expected"),
    [
        ([-1.0, -1.0, -1.0, -1.0], [False, False]),
        ([-1.0, -1.05, -1.0, -1.0], [False, False]),
        ([-np.inf] * 4, [False, False]),
        ([-1.0, -1.0, -2.0, -2.0], [True, False]),
        ([-1.0, -2.0, -2.0, -np.inf], [True, True]),
    ],
)
def test_only_what_changes_the_worth_of_a_choice_decides(kept, worth, expected):
    assert find_deciding_parameters(choices(worth, kept, GRID), 0.1) == expected


def test_where_choices_lie_on_no_grid_all_are_compared():
    places = [(1.0, 3.0, 5.0), (1.5, 3.5, 5.5)]
    assert find_deciding_parameters(choices([-1.0, -1.0], False, places), 0.0) == [False] * 3
    assert find_deciding_parameters(choices([-1.0, -2.0], False, places), 0.0) == [True] * 3


def test_no_number_is_minus_zero():
    assert number(-0.0) == "0" and quantity(-0.0, "rad") == "0 rad"
    assert with_error(-1e-9, 0.1, "m") == "0.0 ± 0.1 m"
    assert interval({"lower": -1e-9, "upper": 0.5, "error": 0.1, "units": "m"}) == "0.00 to 0.50 m"


@pytest.mark.parametrize(("kind", "level", "lower", "upper", "least", "words"), [
    ("at_most", 0.001, -0.243, -0.225, None, "is negative in all runs"),
    ("at_least", -0.12, 0.1, 0.2, None, "is positive in all runs"),
    ("at_least", 0.0, 0.1, 0.2, 0.0, "is never below 0"),
    ("at_most", 0.12, 0.1, 0.2, 0.0, None),
    ("at_most", 0.0, -0.2, -0.1, None, None),  # as of a place below the ground
    ("at_most", 0.1, -0.2, 0.01, None, None),
    ("at_least", 0.0, None, None, None, None),
    ("happens", 1.0, -0.2, -0.1, 0.0, None),
])  # fmt: skip
def test_a_limit_that_cannot_fail_is_no_yes(kind, level, lower, upper, least, words):
    limit = {"quantity": "hit", "kind": kind, "level": level, "units": "N m s", "margin": 0.2}
    assert why_idle(limit, {"lower": lower, "upper": upper}, least) == words
    limit |= {"error": 0.0} | ({"idle": words} if words else {})
    row = {"name": "soft", "met": "all", "share": 1.0, "share_uncertainty": 0.0, "runs": 9}
    facts = {"together": row, "requirements": [row | {"limits": [limit]}], "quantities": []}
    text = sentence("headline", facts)
    assert text.startswith("Yes") == (words is None) and (words or "Yes") in text
    assert ("For a limit on its size, state" in text) == bool(words and words.endswith("runs"))
    if level == 0.001:
        assert text.endswith("state at_least −0.001 N m s.")
