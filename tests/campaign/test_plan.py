"""Plans: which runs, under which names, and which time step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fpm
import fpm.reading
from deployable.campaign.config.check import check_config
from deployable.campaign.config.sections import count_runs, scene_type
from deployable.campaign.plan.plan import make_plan, read_plan, split_evenly, write_plan
from deployable.campaign.runs.results import groups_of


def plan_of(raw):
    return make_plan(check_config(raw).experiment)


def names(plan):
    return {run.id for run in plan.runs}


def by_role(plan, role):
    return [run for run in plan.runs if run.role == role]


def test_a_plan_has_the_nominal_run_the_nodes_and_the_held_out_runs(plan):
    assert [len(by_role(plan, role)) for role in ("nominal", "node", "held_out")] == [1, 3, 2]
    assert by_role(plan, "nominal")[0].values == (0.035,)
    roots = 0.035 * (1 + 0.01 * np.cos(np.pi * (np.arange(3) + 0.5) / 3))
    found = sorted(run.values[0] for run in by_role(plan, "node"))
    np.testing.assert_allclose(found, sorted(roots), rtol=1e-14)


def test_a_run_in_two_roles_has_one_name_and_is_simulated_once(plan):
    assert len(plan.runs) == 6  # order 2: the middle root is the nominal value
    assert len(plan.unique_runs) == 5
    nominal = by_role(plan, "nominal")[0]
    assert nominal.id in {run.id for run in by_role(plan, "node")}


def test_the_number_of_runs_is_known_without_a_plan(raw):
    for design in (
        {"method": "tensor_lobatto", "order": 4},
        {"method": "smolyak", "order": 2},
        {"method": "sobol", "samples": 7},
    ):
        config = check_config({**raw, "design": design})
        assert count_runs(config.experiment) == len(make_plan(config.experiment).runs)


@pytest.mark.parametrize(
    "change",
    [
        {"solver": {"duration": 0.005, "instants": 9}},
        {"solver": {"duration": 0.004, "instants": 17}},
        {"solver": {"duration": 0.004, "instants": 9, "energy_tolerance": 0.03}},
        {"solver": {"duration": 0.004, "instants": 9, "step": 1e-5}},
        {"scene": {"name": "bennett", "parameters": {"elements": 3}}},
        {"scene": {"name": "bennett", "parameters": {"elements": 2, "K_F": 5.1}}},
    ],
)
def test_what_changes_a_trajectory_changes_its_name(raw, plan, change):
    after = names(plan_of({**raw, **change}))
    assert not names(plan) & after


@pytest.mark.slow
def test_the_step_is_stable_at_every_corner_and_divides_the_interval(raw):
    raw["intervals"] = {"a": {"relative": 0.2}, "E": {"relative": 0.3}}
    config = check_config(raw)
    plan = make_plan(config.experiment)
    bennett = scene_type("bennett")
    limits = [
        fpm.find_stable_step(bennett.build(elements=2, a=a, E=E)).step
        for a in (0.028, 0.035, 0.042)
        for E in (0.7e9, 1e9, 1.3e9)
    ]
    assert plan.time.step_limit == pytest.approx(min(limits))
    assert plan.time.step <= 0.9 * min(limits)
    assert plan.time.step * plan.time.output_steps == pytest.approx(0.004 / 8, rel=1e-14)
    assert plan.time.step > 0.9 * min(limits) * (1 - 2 / plan.time.output_steps)


def test_a_step_of_ones_own_is_kept(raw):
    raw["solver"]["step"] = 2.5e-5
    assert plan_of(raw).time.step == pytest.approx(2.5e-5, rel=1e-12)


def test_a_plan_of_many_runs_is_packed_to_the_last_bit(raw, tmp_path, monkeypatch):
    raw["intervals"]["E"] = {"relative": 0.05}
    raw["design"] = {"method": "sobol", "samples": 10_000}
    plan = plan_of(raw)
    write_plan(plan, tmp_path / "plan.json")
    found = read_plan(tmp_path / "plan.json")
    assert replace(found, runs=plan.runs) == plan and found.runs.digest == plan.runs.digest
    assert found.digest == plan.digest
    assert [run.id for run in found.runs[:5]] == [run.id for run in plan.runs[:5]]
    assert (tmp_path / "plan.json").stat().st_size < 40 * len(plan.runs)


@pytest.mark.parametrize(("batches", "size"), [(1, 1), (2, 2), (3, 4), (7, 2), (1, 100)])
def test_batches_and_groups_hold_every_run_once(plan, batches, size):
    every = groups_of(plan.unique_runs, size)
    groups = [split_evenly(every, batch, batches) for batch in range(batches)]
    assert len(groups) == batches
    flat = [run.id for mine in groups for group in mine for run in group]
    assert flat == [run.id for run in plan.unique_runs]
    assert all(len(group) <= size for mine in groups for group in mine)
