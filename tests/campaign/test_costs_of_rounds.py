"""What rounds towards an accuracy cost, by what they plan: told and planned must be the same."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from deployable.campaign.config.check import check_config
from deployable.campaign.plan.accuracy import _refinement_state, extend_plan, start_plan
from deployable.campaign.plan.plan import Round
from deployable.campaign.results.response_bounds import CampaignBounds, ResponseBounds
from deployable.campaign.results.run_samples import RunTable


@pytest.fixture
def experiment(raw):
    """Of a config that asks for an accuracy, with a quantity."""
    del raw["design"], raw["held_out"]
    raw |= {"scene": {"name": "bennett"}, "accuracy": {"tolerance": 0.1, "max_runs": 200}}
    return check_config(raw | {"quantities": {"top": {"largest": "BD"}}}).experiment


SHARES = {name: {"surrogate": 0.2} for name in ("BD", "vBz", "top")}


def after(plan, action, nodes, **more):
    """A plan with one round before it, of 16 runs and 2 s, with so many nodes, that decided for an
    action."""
    done = Round(16, 0.5, action, "", SHARES, 6, 0.5, 2.0, nodes)
    return replace(plan, adaptive=replace(plan.adaptive, rounds=(done,), **more))


@pytest.fixture
def decided(experiment):
    """Function of errors as shares of the width, by part: the plan after the first, and that."""

    def plan_after(check=("mesh",), top=0.0, readings=5001, **shares):
        solver = replace(experiment.solver, peak_instants=readings)
        plan = start_plan(replace(experiment, solver=solver))
        plan = replace(plan, adaptive=replace(plan.adaptive, check=check))
        rng, unit = np.random.default_rng(2), plan.runs.normalized
        time = np.linspace(0.0, 1.0, 9)
        curves = np.sin(3 * unit[:, :1, None] + time) * rng.uniform(0.5, 1, (1, 2, 1))
        samples = SimpleNamespace(
            table=RunTable(unit, unit, 2 + unit[:, :1], unit[:, :1]),
            curves=lambda runs, responses: curves[runs, responses],
        )
        shares = {"surrogate": sum(shares.values())} | shares
        rows = [ResponseBounds(name, name, "m", time, 0 * time, 0 * time + 1, error_shares=shares)
                for name in ("BD", "vBz")]  # fmt: skip
        errors = {part: np.zeros(1) for part in shares if part in check}
        errors["step"] = np.array([top * np.ptp(unit[:, 0])])
        bounds = CampaignBounds(tuple(rows), [], {}, errors)
        return plan, extend_plan(experiment, plan, samples, bounds)

    return plan_after


def test_more_runs_keep_those_that_are_there(decided):
    plan, after = decided(surrogate=0.5, mesh=0.01)
    assert after.adaptive.rounds[-1].action == "runs"
    before, now = (set(map(tuple, p.runs.normalized.tolist())) for p in (plan, after))
    assert before < now
    assert f"; {len(now) - len(before)} runs are added" in after.adaptive.rounds[-1].reason
    assert after.time == plan.time


def test_a_finer_mesh_has_twice_the_elements_and_the_same_runs(decided):
    plan, after = decided(surrogate=0.01, mesh=0.5)
    assert after.adaptive.rounds[-1].action == "mesh"
    meshes = [p.experiment.scene.parameters["elements"] for p in (plan, after)]
    assert meshes[1] == 2 * meshes[0]
    np.testing.assert_array_equal(after.runs.normalized, plan.runs.normalized)
    assert after.adaptive.check == ("mesh",)
    assert after.time.step < 0.6 * plan.time.step


@pytest.mark.parametrize(
    ("previous", "nodes", "stops"), [(0.2, 2, True), (0.3, 2, False), (0.2, 3, False)]
)
def test_an_error_that_does_not_fall_with_runs_ends_the_rounds(experiment, previous, nodes, stops):
    """Four times as many runs, and nine tenths of the error: it jumps, or has an edge."""
    plan = after(start_plan(experiment), "runs", nodes)
    elements = _refinement_state(plan, SHARES).cost.elements
    shares = {name: {"surrogate": previous} for name in SHARES}
    record = replace(plan.adaptive.rounds[0], shares=shares, elements=elements)
    standing = _refinement_state(
        replace(plan, adaptive=replace(plan.adaptive, rounds=(record,))), SHARES
    )
    decision = standing.decide()
    assert ("does not fall with more runs" in decision.reason) == stops
    assert (decision.action == "runs") == (not stops)
