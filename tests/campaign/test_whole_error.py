"""The whole error of responses: surrogate, step and mesh."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from deployable import campaign
from deployable.campaign.answers import discretization
from deployable.campaign.folder import Folder
from deployable.intervals import Box


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory):
    """Bounds of a campaign, and of the same with half the step and on the finer mesh."""
    results = tmp_path_factory.mktemp("whole")
    raw = {
        "scene": {"name": "bennett", "parameters": {"elements": 2}},
        "solver": {"duration": 0.02, "instants": 41},
        "intervals": {"K_F": {"relative": 0.05}},
        "design": {"method": "tensor_lobatto", "order": 2},
        "held_out": 2,
        "responses": {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}},
    }

    def run(name, **change):
        whole = {**raw, "campaign": name, **change}
        return campaign.run(whole, results, figures=False, notify=lambda text: None)

    found = {"usual": run("usual", verify={"discretization": True})}
    halved = {**raw["solver"], "step": found["usual"].attrs["time_step"] / 2}
    found["step"] = run("step", solver=halved)
    finer = {"name": "bennett", "parameters": {"elements": 4}}
    found["mesh"] = run("mesh", scene=finer, solver=halved)
    return found | {"folder": Folder(results / "usual")}


@pytest.mark.parametrize(("part", "beside"), [("step", "usual"), ("mesh", "step")])
def test_parts_are_what_a_finer_campaign_changes(campaigns, part, beside):
    """By a factor for each response, by the order at which that falls. The finer mesh is put beside
    the finer step, which it has as well: that counts once.

    Bounds of BD are attained at the ends of the interval, where there are runs in both; at a few
    instants those of the velocity are not, which may tell by a twentieth of the largest change.
    """
    before, finer = campaigns[beside], campaigns[part]
    ends = [abs(finer[side] - before[side]) for side in ("lower", "upper")]
    changed = np.maximum(*ends)
    found = campaigns["usual"][f"error_{part}"].values
    assert found.max() > 0
    # Instants are farther apart than the window of the estimate, which thus changes nothing.
    for i, near in enumerate((1e-4, 0.05)):
        most = found[i].max()
        factor = most / changed.values[i].max()
        assert 16 / 15 - 0.05 < factor < 2 + 0.15
        assert found[i] == pytest.approx(factor * changed.values[i], rel=1e-6, abs=near * most)


def test_the_error_of_the_step_is_what_much_finer_steps_change(tmp_path):
    """Of a pendulum, within a twentieth, where what half the step changes is a quarter less."""
    raw = {
        "campaign": "swings",
        "scene": {"name": "pendulum"},
        "solver": {"duration": 1.0, "instants": 41},
        "intervals": {"g": {"relative": 0.05}},
        "design": {"method": "tensor_lobatto", "order": 2},
        "verify": {"discretization": True},
        "responses": {"z": {"position": "T", "component": "z"}},
    }

    def run(**more):
        return campaign.run({**raw, **more}, tmp_path, figures=False, notify=lambda text: None)

    found = run()
    solver = {**raw["solver"], "step": found.attrs["time_step"] / 8}
    finer = run(campaign="finer", solver=solver, verify={})
    changed = max(abs(finer[side] - found[side]).values.max() for side in ("lower", "upper"))
    assert found["error_step"].values.max() == pytest.approx(64 / 63 * changed, rel=0.05)


@pytest.mark.parametrize(("finest", "sizes"), [(True, (1, 0.5, 0.25)), (False, (1, 0.5, 2))])
@pytest.mark.parametrize(("order", "factor"), [(1, 1.0), (2, 1.0), (3, 1.0), (0.5, 0.5858)])
def test_an_error_is_that_of_an_order_from_one_on(monkeypatch, finest, sizes, order, factor):
    """Of quantities and curves, with a third level that is finer or coarser; of an order below one
    as much as of the first."""
    truth = np.array([3.0, 5.0])

    def told(plan, points):
        return np.tile(truth + np.array([0.1, -2.0]) * plan**order, (len(points), 1)), None

    at, side = np.zeros(1), truth + np.array([0.1, -2.0])
    ends = [SimpleNamespace(argmin=at, argmax=at, lower=x, upper=x) for x in side]
    level = discretization.RefinementLevel(sizes[1], sizes[2], finest)
    monkeypatch.setattr(
        discretization, "_levels", lambda _, parts, step: dict.fromkeys(parts, level)
    )
    model = SimpleNamespace(plan=1.0, evaluate=told, finest_step=1.0)
    found = discretization.estimate_discretization_errors(model, ends, ("step",))["step"]
    assert found == pytest.approx(factor * np.array([[0.1] * 2, [2.0] * 2]), rel=1e-4)
    time = np.linspace(0.0, 1.0, 5)
    curves = [
        truth[:, None] + np.outer([0.1, -2.0], time) * size**order for size in (1, *sizes[1:])
    ]
    ratio = level.ratio(*curves)
    assert ratio == pytest.approx(2.0**order, rel=1e-6)


def test_a_change_that_is_small_by_accident_counts_as_the_next_one():
    """Of a hinge that friction stops after a pulse, at steps of 0.1, 0.05 and 0.025 ms; the true
    angle is that of an event-exact solution."""
    runs, truth = np.array([[1.8430013e-3], [1.8407735e-3], [1.8262383e-3]]), 1.8253277e-3
    level, change = discretization.RefinementLevel(None, None, True), np.abs(runs[0] - runs[1])
    (error,) = level.extrapolate(change, level.ratio(*runs))
    assert 1.0 < error / abs(runs[0, 0] - truth) < 2.0
    assert level.extrapolate(change, np.array([4.0])) == pytest.approx(4 / 3 * change)


def test_planned_runs_stand_for_places_beside_them_and_no_others(monkeypatch):
    """Bounds attained at 0.93 and -0.2: there is a run at 0.9, and one at -0.9, but none near."""
    known = np.array([[-0.9], [0.0], [0.9]])
    taken = []

    def curves(model, plan, points):
        taken.append(points)
        return np.zeros((len(points), 1, 4))

    monkeypatch.setattr(discretization, "_curves", curves)
    level = discretization.RefinementLevel(None, None, True)
    monkeypatch.setattr(
        discretization, "_levels", lambda _, parts, step: dict.fromkeys(parts, level)
    )
    box = Box(["a"], [1.0], [3.0])
    plan = SimpleNamespace(runs=SimpleNamespace(normalized=known))
    around = SimpleNamespace(box=box, is_adaptive=False)
    model = SimpleNamespace(experiment=around, plan=plan, finest_step=1.0)
    at = {name: (("response", "time", "parameter"), np.full((1, 4, 1), box.from_unit([value])))
          for name, value in (("argmin", 0.93), ("argmax", -0.2))}  # fmt: skip
    ends = {name: (("response", "time"), np.full((1, 4), value))
            for name, value in (("lower", 0.0), ("upper", 1.0))}  # fmt: skip
    discretization._curve_errors(model, xr.Dataset(at | ends), ("step", "mesh"))
    assert len(taken) == 3
    for points in taken:
        assert sorted(points[:, 0]) == pytest.approx([-0.2, 0.9])
