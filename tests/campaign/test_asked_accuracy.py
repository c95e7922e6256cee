"""`accuracy`: what a config with it means, what is decided after each round, and that it is met."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from deployable import campaign
from deployable.campaign.answers.quantity_bounds import QuantityBounds
from deployable.campaign.config.check import check_config
from deployable.campaign.config.sections import Accuracy
from deployable.campaign.folder import Folder
from deployable.campaign.plan.accuracy import (
    add_runs,
)
from deployable.campaign.plan.decide import RefinementState, Resources
from deployable.campaign.plan.plan import Round, Rounds
from deployable.campaign.results.facts import _accuracy
from deployable.campaign.results.templates import sentence
from deployable.intervals.scalars import estimate_bounds, fit_scalar


@pytest.fixture
def asked(raw):
    """A config that asks for an accuracy, and for nothing that it chooses."""
    del raw["design"], raw["held_out"]
    raw["scene"] = {"name": "bennett"}
    return raw | {"accuracy": 0.1}


def test_a_number_is_the_share_of_everything(asked):
    asked["quantities"] = {"top": {"largest": "BD"}}
    found = check_config(asked)
    assert found.experiment.accuracy.tolerances == {"BD": 0.1, "vBz": 0.1, "top": 0.1}
    assert found.experiment.scene.parameters == {"elements": 6}
    assert found.experiment.is_adaptive
    assert (found.bounds.model, found.verify.discretization) == ("auto", True)
    asked["accuracy"] = {"tolerance": 0.2, "tolerance_by_name": {"top": 0.01}, "max_runs": 50}
    found = check_config(asked).experiment.accuracy
    assert found == Accuracy({"BD": 0.2, "vBz": 0.2, "top": 0.01}, 50, 60.0, "elements")


def test_a_mesh_of_the_config_is_kept(asked):
    asked["scene"] = {"name": "bennett", "parameters": {"elements": 5}}
    found = check_config(asked).experiment
    assert found.scene.parameters == {"elements": 5}
    assert found.accuracy.mesh == ""


COST = Resources(
    runs=24, seconds=1.0, nodes=16, next_runs=8, check_runs=8, run_seconds=0.01, elements=6
)
AIM = Accuracy({"x": 0.1}, 1000, 60.0, "n")


def decided(parts, *rounds, check=("mesh",), aim=AIM, cost=COST):
    state = Rounds(rounds, (), check=check)
    return RefinementState(aim, {"x": parts}, state, cost, True).decide()


def done(action, elements=6, **parts):
    return Round(16, 0.0, action, "", {"x": parts}, elements)


def test_an_error_that_is_small_enough_is_checked_before_it_is_believed():
    good = {"surrogate": 0.03, "mesh": 0.04}
    assert decided(good).action == "check"
    found = decided({**good, "step": 0.01}, done("check"), check=("step", "mesh"))
    assert (found.action, found.met) == ("stop", True)
    assert "x 8 % of the width (surrogate 3 %, mesh 4 %, step 1 %), tolerance 10 %" in found.reason


def test_the_part_that_is_too_large_decides_what_comes_next():
    assert decided({"surrogate": 0.2, "mesh": 0.04}).action == "runs"
    assert decided({"surrogate": 0.2, "mesh": 0.06}).action == "mesh"
    # With more runs, a finer mesh would make all of them again.
    late = [done("runs", surrogate=0.2, mesh=0.06)]
    assert decided({"surrogate": 0.06, "mesh": 0.06}, *late).action == "runs"
    assert decided({"surrogate": 0.06, "mesh": 0.08}, *late).action == "mesh"
    assert decided({"surrogate": 0.01, "mesh": 0.03, "step": 0.09}, *late).action == "step"


@pytest.mark.parametrize(
    ("parts", "aim", "told"),
    [
        ({"surrogate": 0.3, "mesh": 0.01}, Accuracy({"x": 0.1}, 30, 60.0, "n"), "30 runs"),
        ({"surrogate": 0.3, "mesh": 0.01}, Accuracy({"x": 0.1}, 99, 0.017, "n"), "0.017 minutes"),
        ({"surrogate": 0.01, "mesh": 0.3}, Accuracy({"x": 0.1}, 99, 60.0, ""), "keeps its mesh"),
    ],
)
def test_what_cannot_be_met_is_told_with_what_it_would_cost(parts, aim, told):
    found = decided({**parts, "step": 0.0}, aim=aim, check=("step", "mesh"))
    assert (found.action, found.met) == ("stop", False)
    assert told in found.reason
    assert "x would take" in found.reason
    assert "of a core" in found.reason


def test_what_the_config_keeps_is_not_changed_and_the_rest_is():
    state = Rounds((done("mesh"),), (), check=("step", "mesh"))
    step, mesh = ({"surrogate": 0.01, "mesh": 0.03, "step": 0.03, name: 0.2} for name in
                  ("step", "mesh"))  # fmt: skip

    def action(parts, mesh_is_free, is_step_free):
        aim = Accuracy({"x": 0.1}, 1000, 60.0, "n" if mesh_is_free else "")
        found = RefinementState(aim, {"x": parts}, state, COST, is_step_free).decide()
        return found.action, "keeps its" in found.reason

    for free in (True, False):
        assert action(step, free, True) == ("step", False)
        assert action(mesh, True, free) == ("mesh", False)
        assert action(step, free, False) == ("stop", True)
        assert action(mesh, False, free) == ("stop", True)


@pytest.mark.parametrize("what", ["runs", "check", "step", "mesh"])
def test_what_a_round_takes_fits_the_budget_or_it_is_not_begun(what):
    """To the run, and to the second."""
    parts = {"runs": {"surrogate": 0.3, "mesh": 0.01}, "check": {"surrogate": 0.3, "mesh": 0.01},
             "step": {"surrogate": 0.01, "mesh": 0.0, "step": 0.3},
             "mesh": {"surrogate": 0.01, "mesh": 0.3}}[what]  # fmt: skip
    runs, seconds = COST.need_of(what)
    # Half the step costs twice, a mesh twice as fine four times; what is checked is run as it is
    # from then on, with half its step, and on a mesh twice as fine. There is room for the last
    # check, of step and mesh.
    n, c, last = COST.nodes, COST.check_runs, (2 + 4) * COST.check_runs
    assert runs == 2 * c + {"runs": COST.next_runs, "check": 0, "step": n, "mesh": n + c}[what]
    worth = {"runs": COST.next_runs + last, "check": last, "step": 2 * (n + last),
             "mesh": 4 * (n + 4 * c + last)}[what]  # fmt: skip
    assert seconds == pytest.approx(worth * COST.run_seconds)
    if what == "check":
        return
    for more_runs, more_seconds in ((0, 1e-6), (-1, 1e-6), (0, -1e-6)):
        minutes = (COST.seconds + seconds + more_seconds) / 60
        aim = Accuracy({"x": 0.1}, COST.runs + runs + more_runs, minutes, "n")
        found = decided(parts, aim=aim, check=("step", "mesh"))
        assert found.action == (what if (more_runs, more_seconds) == (0, 1e-6) else "stop")


def test_what_half_a_step_would_take_is_told_of_the_step_and_what_is_no_number_is_left():
    aim = Accuracy({"x": 0.1, "y": 0.1}, 20, 60.0, "")
    shares = {"x": {"surrogate": 0.01, "step": 0.3}, "y": {"surrogate": float("nan")}}
    found = RefinementState(aim, shares, Rounds((), (), check=("step",)), COST, True).decide()
    assert found.action == "stop"
    assert "x would take a step 8 times as fine" in found.reason


@pytest.mark.parametrize("enough", [False, True])
def test_a_finer_mesh_is_begun_where_the_budget_takes_all_of_it(enough):
    """An error that halves with the mesh, from 0.3 to 0.15, takes two more halvings to half of the
    aim: (16 + 4 · 8) runs of 0.01 s, 4 and then 16 times as long, after 1 s that is spent."""
    coarse, finer = done("mesh", 6, surrogate=0.01, mesh=0.3), vars(COST) | {"elements": 12}
    needs = (1.0 + 48 * 0.01 * (4 + 16)) / 60
    aim = Accuracy({"x": 0.1}, 1000, needs * (1.01 if enough else 0.99), "n")
    parts = {"surrogate": 0.01, "mesh": 0.15, "step": 0.0}
    check = ("step", "mesh")
    found = decided(parts, coarse, check=check, aim=aim, cost=Resources(**finer))
    assert found.action == ("mesh" if enough else "stop")
    assert ("does not get there within the budget" in found.reason) != enough


def runs_of(nodes, **parts):
    """A round after which runs were added to so many nodes."""
    return Round(16, 0.0, "runs", "", {"x": parts}, 6, nodes=nodes)


def test_runs_become_as_many_as_errors_are_expected_to_need():
    def factor(surrogate, *rounds, nodes=32, **parts):
        shares = {"x": {"surrogate": surrogate, **parts}}
        cost = replace(COST, nodes=nodes)
        return RefinementState(AIM, shares, Rounds(rounds, ()), cost, True).growth()

    assert factor(0.101) == 1.25
    assert factor(0.12) == pytest.approx((1.2 / 0.75) ** (1 / 1.5))
    assert factor(5.0) == 4.0
    # From 16 to 32 nodes it fell by four, with their square; where it fell by nothing, more.
    assert factor(0.2, runs_of(16, surrogate=0.8)) == pytest.approx((2 / 0.75) ** (1 / 2))
    assert factor(0.12, runs_of(16, surrogate=0.12)) == pytest.approx((1.2 / 0.75) ** (1 / 0.75))
    # Less is left for the surrogate beside an error of the mesh.
    assert factor(0.07, mesh=0.05) == pytest.approx((0.07 / 0.75 / 0.05) ** (1 / 1.5))
    assert add_runs(32, 1.25, 99) == 8
    assert add_runs(32, 2.0, 99) == 32
    assert add_runs(32, 2.0, 30) == 24
    assert add_runs(32, 2.0, 0) == 8  # which the budget then refuses
    # As many as there are, or four times as many, where that takes no longer than a round.
    assert add_runs(32, 4.0, 99) == 32
    assert [add_runs(32, 1.25, 99, cheap) for cheap in (24, 50)] == [24, 32]
    assert [add_runs(16, 4.0, 99, cheap) for cheap in (24, 32, 99)] == [24, 32, 48]


def test_what_should_be_the_last_runs_are_checked_at_once_where_that_is_cheap():
    cheap = Resources(**{**vars(COST), "run_seconds": 0.001, "next_runs": 16})
    parts = {"surrogate": 0.2, "mesh": 0.02}
    assert decided(parts, cost=cheap).check == ("step", "mesh")
    assert decided(parts, cost=COST).check == ()  # more than half a second
    far = {"surrogate": 0.9, "mesh": 0.02}
    assert decided(far, cost=cheap).check == ()
    few = Accuracy({"x": 0.1}, cheap.runs + cheap.next_runs + 2 * cheap.check_runs - 1, 60.0, "n")
    assert decided(parts, cost=cheap, aim=few).action == "check"  # runs would leave no room for it


OPENING = {
    "campaign": "asked",
    "scene": {"name": "bennett"},
    "solver": {"duration": 0.05, "instants": 51},
    "intervals": {"a": {"nominal": 0.035, "relative": 0.3}},
    "responses": {"BD": {"distance": ["B", "D"]}},
    "quantities": {"last": {"final": "BD"}},
    "accuracy": {"tolerance": 0.003, "tolerance_by_name": {"last": 0.005}, "max_core_minutes": 3},
}


def told(rounds_met, *shares, asked=0.05):
    """What a summary says of an accuracy after rounds that found it met, or not, above a table with
    such shares of the width; "none" for a quantity that happens nowhere."""
    rows = [
        {"name": name, "grade": "small", "errors": {"share": None if share == "none" else share}}
        | ({} if name == "x" else {"lower": None if share == "none" else 1.0})
        | ({"search_end": f"{name} jumps"} if name != "x" and share != "none" else {})
        for name, share in zip("xyz", shares, strict=False)
    ]
    accuracy = Accuracy(dict.fromkeys("xyz", asked), 0, 0.0, "")
    rounds = Rounds((Round(16, 0.0, "stop", "the budget is spent"),), (), met=rounds_met)
    plan = SimpleNamespace(adaptive=rounds, experiment=SimpleNamespace(accuracy=accuracy))
    found = _accuracy(plan, rows)
    facts = {"accuracy": found, "responses": rows, "quantities": []}
    return found, sentence("accuracy", facts)


def test_an_accuracy_is_met_by_what_is_told_last_and_not_by_the_rounds():
    """Further runs at the ends of quantities may show more, or less, than the rounds knew."""
    found, text = told(True, 0.04, 0.16, None)
    assert (found["met"], found["unmet"]) == (False, ["y", "z"])
    assert "is not met by `y` (error 16 %, target 5 %) and `z` (error unknown, target 5 %)" in text
    ends = "The search for the bounds of {0} ended as {0} jumps".format
    assert found["reason"] == f"{ends('y')}. {ends('z')}"
    found, text = told(False, 0.06)
    assert (found["met"], found["reason"]) == (False, "The rounds ended as the budget is spent")
    assert "other" not in text
    found, text = told(False, 0.05004, 0.0506)  # as printed, 5 and 5.06 %
    assert found["unmet"] == ["y"] and "`y` (error 5.06 %, target 5 %); 1 other meets it" in text
    found, text = told(False, 0.02, 0.04, "none")
    assert (found["met"], found["unmet"]) == (True, [])
    assert "is met. It took 16 runs in 1 round" in text
    assert text.endswith("narrower than the distance between runs.")


@pytest.fixture(scope="module")
def met(tmp_path_factory):
    results = tmp_path_factory.mktemp("asked")
    campaign.run(OPENING, results, figures=False, notify=lambda text: None)
    return Folder(results / "asked")


@pytest.mark.slow
def test_rounds_refine_what_is_too_coarse(met):
    summary = json.loads((met / "summary.json").read_text())
    rounds = summary["adaptive"]["rounds"]
    last = met.round(len(rounds) - 1)
    for name in ("samples.nc", "design_bounds.nc"):
        assert (met / name).read_bytes() == (last / name).read_bytes()
    assert list(met.path.glob("rounds/*/trajectories")) == []
    assert {"runs", "stop"} <= {row["action"] for row in rounds}
    assert [row["runs"] for row in rounds] == sorted(row["runs"] for row in rounds)
    assert summary["accuracy"]["met"]
    for row in (*summary["responses"], *summary["quantities"]):
        errors = row["errors"]
        assert errors["share"] <= errors["target"]
        assert errors["whole"] == pytest.approx(
            sum(errors[n] for n in ("surrogate", "step", "mesh"))
        )
    text = (met / "summary.md").read_text()
    assert "The requested accuracy is met" in text
    assert "target |" in text


@pytest.mark.slow
def test_the_true_error_is_what_was_asked_for(met, tmp_path):
    """Against a scan on a mesh twice as fine as the one that was chosen, with half its step."""
    elements = json.loads((met / "summary.json").read_text())["accuracy"]["mesh"]
    raw = {key: value for key, value in OPENING.items() if key not in ("accuracy", "quantities")}
    scene = {"name": "bennett", "parameters": {k: 2 * v for k, v in elements.items()}}
    raw |= {"scene": scene, "design": {"method": "sobol", "samples": 17}, "campaign": "scan"}
    scan = campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    with xr.open_dataset(met.bounds) as bounds:
        off = np.maximum(abs(bounds["lower"] - scan["lower"]), abs(bounds["upper"] - scan["upper"]))
        width = (scan["upper"] - scan["lower"]).mean("time")
        assert (off.mean("time") <= 0.003 * width).all()
        assert (bounds["error"].mean("time") >= off.mean("time")).all()


@pytest.mark.slow
def test_a_campaign_that_was_stopped_goes_on_to_the_same_end(met, tmp_path):
    """Without its last rounds, as a killed one is."""
    shutil.copytree(met.path, tmp_path / "asked")
    folder = Folder(tmp_path / "asked")
    for name in ("bounds.nc", "summary.json", "plan.json", "samples.nc"):
        (folder / name).unlink()
    shutil.rmtree(folder.round(1).path)
    told: list[str] = []
    campaign.run(OPENING, tmp_path, figures=False, notify=told.append)
    with xr.open_dataset(met.bounds) as before, xr.open_dataset(folder.bounds) as after:
        for name in ("lower", "upper", "error", "error_mesh", "error_step"):
            np.testing.assert_array_equal(before[name], after[name])


def test_a_quantity_of_one_run_is_unknown_and_one_of_rounding_is_constant():
    points = np.linspace(-1.0, 1.0, 9)[:, None]

    def share(*values):
        values = np.array(values, dtype=float)
        surrogate = fit_scalar(points, values)
        extremes, ends = surrogate.range(), (np.nanmin(values), np.nanmax(values))
        estimates = estimate_bounds(surrogate, points, values)
        row = QuantityBounds(surrogate, extremes, *ends, points[0], points[0], estimates)
        return row.relative_error

    assert share(*[np.nan] * 8, 2.0) == np.inf
    assert share(*(2.0 + 4e-16 * np.arange(9) ** 2)) == 0.0
    assert 0 < share(*(np.arange(9) > 4)) < np.inf


def test_rounds_add_no_runs_for_quantities_but_make_step_and_mesh_fine_enough_for_them():
    def action(mesh, *rounds):
        shares = {"x": {"surrogate": 0.01, "mesh": 0.0, "step": 0.0}, "y": {"mesh": mesh}}
        aim = Accuracy({"x": 0.1, "y": 0.1}, 1000, 60.0, "n")
        state = Rounds(rounds, (), check=("step", "mesh"))
        return RefinementState(aim, shares, state, COST, True).decide().action

    assert action(0.01) == "stop"
    assert action(0.076) == "mesh"
