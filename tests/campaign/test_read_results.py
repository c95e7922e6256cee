"""Results in netCDF as objects: what these have is what the files have."""

from __future__ import annotations

import copy
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from deployable import campaign
from deployable.campaign.answers.evaluations import ModelEvaluator, runs_at
from deployable.campaign.config.sections import Jobs
from deployable.campaign.files import read_json
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.report import from_results
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.results.response_bounds import ResponseBounds, read_bounds
from deployable.campaign.results.run_samples import (
    describe_events,
    open_samples,
    read_refinement,
)
from evidence.attack import victim
from evidence.attack.victim import silent
from fpm.files.seals import DamagedError


def test_runs_are_those_of_the_plan(finished):
    plan = read_plan(finished.plan)
    with xr.open_dataset(finished.samples) as file:
        file.load()
    with open_samples(finished) as samples:
        assert samples.ids() == [run.id for run in plan.runs]
        assert samples.ids([2, 0]) == [plan.runs[2].id, plan.runs[0].id]
        assert samples.roles == [run.role for run in plan.runs] and samples.nominal == 0
        assert samples.experiment == plan.experiment and samples.time_step == plan.time.step
        np.testing.assert_array_equal(samples.table.values, plan.runs.values)
        np.testing.assert_array_equal(samples.curves(1), file["values"].values[1])
        np.testing.assert_array_equal(
            samples.curves(slice(None), [1]), file["values"].values[:, [1]]
        )
        low, high = samples.extreme_runs(1, 5)
        column = file["values"].values[:, 1, 5]
        assert column[low] == column.min() and column[high] == column.max()
        counts = samples.count()
        assert counts["runs"] == len(plan.unique_runs)


def test_bounds_are_those_of_the_file(finished):
    bounds = read_bounds(finished)
    with xr.open_dataset(finished.bounds) as file, xr.open_dataset(finished.sensitivities) as more:
        assert [row.name for row in bounds.responses] == file["response"].values.tolist()
        for i, row in enumerate(bounds.responses):
            for key in ("lower", "upper", "nominal", "error"):
                np.testing.assert_array_equal(getattr(row, key), file[key].values[i])
            np.testing.assert_array_equal(row.errors["decay"], file["error_decay"].values[i])
            np.testing.assert_array_equal(row.widths, more["width"].values[i])
            assert row.error_shares == {"surrogate": float(file["error_share_of_width"][i])}
            assert row.widest == int((file["upper"] - file["lower"]).values[i].argmax())
        assert bounds.parameters[0]["nominal"] == float(file["box_nominal"][0])
        assert bounds.attributes["campaign"] == file.attrs["campaign"]


def test_the_error_of_a_scan_that_grew_by_nothing_is_not_known():
    zero = np.zeros(3)
    bounds = ResponseBounds("x", "x", "m", zero, zero, zero, "least and largest sample", error=zero)
    assert bounds.known_error is None and bounds.is_unknown(0.0) and not bounds.is_unknown(0.1)
    assert replace(bounds, kind="enclosed range of the polynomial").known_error is zero
    assert replace(bounds, error=np.array([0.0, 1.0, 0.0])).known_error is not None


def test_quantities_have_their_further_runs(rich):
    folder, _ = rich
    results, experiment = QuantityResults.read(folder), read_plan(folder.plan).experiment
    runs = FittedRuns.read(folder)
    with xr.open_dataset(folder.quantities) as file, xr.open_dataset(folder.refinement) as further:
        assert [row["name"] for row in results.rows] == file["quantity"].values.tolist()
        assert [row["lower"] for row in results.rows] == file["lower"].values.tolist()
        assert results.further_runs == runs.refinement_count == further.sizes["run"]
        surrogates = runs.surrogates(experiment)
        errors = [max(s.error, 0.0) for s in surrogates]
        assert all(
            e <= float(told) * (1 + 1e-12) for e, told in zip(errors, file["error"], strict=True)
        )
    before = FittedRuns.read(folder, refinements=False)
    np.testing.assert_array_equal(before.points, runs.points[: len(before.points)])


def test_bounds_of_curves_contain_the_runs_of_all_answers(rich):
    """Those of choices where they are in the box, at the values of the campaign."""
    folder, _ = rich
    plan, choice = read_plan(folder.plan), read_json(folder.choice)["fitted"]
    box, (low, high) = plan.experiment.box, choice["intervals"]["a"]
    values = low + (np.array(choice["points"]) + 1) / 2 * (high - low)
    unit = box.to_unit(values[:, :1])
    unit = [*unit[np.abs(unit[:, 0]) <= 1], *read_refinement(folder)[0].points]
    model = ModelEvaluator.from_folder(folder, Jobs(), silent)
    records = model.records(plan, runs_at(plan, unit))
    for i, bounds in enumerate(read_bounds(folder).responses):
        curves = np.array([record.values[i] for record in records])
        slack = 1e-6 * bounds.width.max()  # of values that are computed in another way
        assert (curves >= bounds.lower - slack).all() and (curves <= bounds.upper + slack).all()


def test_events_are_told_in_the_order_of_time():
    events = np.array([[0.3, 1, 0], [0.1, 0, 1]])
    told = describe_events(events, ["a", "b"])
    assert told == [{"time": 0.1, "contact": "a", "closing": True},
                    {"time": 0.3, "contact": "b", "closing": False}]  # fmt: skip


@pytest.mark.parametrize("name", ["samples.nc", "bounds.nc", "refinement.nc"])
def test_a_page_is_made_of_whole_results_only(rich, tmp_path, name):
    folder = Path(shutil.copytree(rich[0].path, tmp_path / "rich"))
    content = (folder / name).read_bytes()
    half = len(content) // 2
    (folder / name).write_bytes(content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :])
    with pytest.raises(DamagedError, match=name):
        from_results(folder)
    (folder / name).unlink()
    with pytest.raises(FileNotFoundError, match=name):
        from_results(folder)


@pytest.mark.slow
def test_a_choice_whose_goal_has_no_value_is_told(tmp_path):
    raw = copy.deepcopy(victim.RAW) | {
        "campaign": "none",
        "quantities": {"t": {"event": "closes"}},
        "requirements": {"shuts": {"t": {"happens": True}}},
        "choose": {"parameters": {"a": [0.034, 0.036]}, "minimise": ["upper(t)"]},
    }
    campaign.run(raw, tmp_path, figures=False, notify=lambda message: None)
    choice = read_json(tmp_path / "none/choice.json")
    assert not choice["kept"] and choice["goals"][0]["value"] is None
    assert choice["goals"][0]["at"] == {"a": None}
    assert from_results(tmp_path / "none").facts["choice"]["goals"][0]["value"] is None
